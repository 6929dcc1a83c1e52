//! Windows of a run.

use pinwheel_compare::windows::*;
use pinwheel_timeseries::TimeSeries;

fn times(count: u32) -> TimeSeries {
    TimeSeries::new((0..=count).map(|k| f64::from(k) * 1e-4).collect()).unwrap()
}

#[test]
fn the_papers_run() {
    let (present, absent) = windows(&times(6000), SETTLING_S, &[]);
    let kinds: Vec<_> = present.iter().map(|w| (w.kind, w.samples)).collect();
    assert_eq!(
        kinds,
        [(WindowKind::Steady, 3001), (WindowKind::Transient, 501)]
    );
    assert!((present[0].from_s - 0.3).abs() < 1e-12 && absent.is_empty());
}

#[test]
fn short_runs_say_what_is_missing() {
    let (present, absent) = windows(&times(500), SETTLING_S, &[]);
    assert_eq!(
        present.iter().map(|w| w.kind).collect::<Vec<_>>(),
        [WindowKind::Transient]
    );
    assert_eq!(
        absent[0].reason,
        "the run lasts 0.05 s; the start-up transient takes 0.25 s, so a steady window needs \
         0.5 s"
    );
    let (present, _) = windows(&times(1500), SETTLING_S, &[]);
    let kinds: Vec<_> = present.iter().map(|w| w.kind).collect();
    assert_eq!(kinds, [WindowKind::Transient, WindowKind::Whole]);
}

#[test]
fn a_run_from_equilibrium_is_steady_at_once() {
    let (present, _) = windows(&times(500), 0.0, &[]);
    assert_eq!(
        (present[0].kind, present[0].from_s),
        (WindowKind::Steady, 0.025)
    );
}

/// A steady window contains neither a load change nor its transient.
#[test]
fn a_change_of_the_load_moves_the_steady_window() {
    let steady = |changes: &[f64]| {
        let (present, absent) = windows(&times(6000), SETTLING_S, changes);
        let steady = present.into_iter().find(|w| w.kind == WindowKind::Steady);
        assert!(steady.is_none_or(|w| w.load_changes == 0 && w.remark().is_none()));
        (steady.map(|w| w.from_s), absent)
    };
    assert_eq!(steady(&[0.01, 0.05]).0, Some(0.3), "long over");
    assert_eq!(steady(&[0.01]).0, Some(0.3), "no earlier than half");
    assert_eq!(steady(&[0.1, 0.2]).0, Some(0.45));
    assert_eq!(
        steady(&[0.1, 0.6, 0.7]).0,
        Some(0.35),
        "at or after the end"
    );
    let (none, absent) = steady(&[0.4]);
    assert_eq!(none, None);
    assert_eq!(
        absent[0].reason,
        "load or speed still changes at 0.4 s and the transient of that takes 0.25 s, so a steady \
         window needs a run of 0.7 s"
    );
    // A start in equilibrium, too: the load change has its own transient.
    let (present, _) = windows(&times(500), 0.0, &[0.01, 0.02]);
    assert_eq!(
        present
            .iter()
            .map(|w| (w.kind, w.load_changes))
            .collect::<Vec<_>>(),
        [(WindowKind::Transient, 2)]
    );
    assert_eq!(
        present[0].remark().unwrap(),
        "Load or speed changes 2 times in the transient window."
    );
}

/// A window that just fits exists, also in a run that begins late.
#[test]
fn what_just_fits_is_a_window() {
    let late = |count: u32| {
        let times = (0..=count).map(|k| 1.0 + f64::from(k) * 1e-4);
        TimeSeries::new(times.collect()).unwrap()
    };
    let places = |list: Vec<Window>| -> Vec<(WindowKind, f64, f64)> {
        let place = |w: Window| (w.kind, rounded(w.from_s), rounded(w.to_s));
        list.into_iter().map(place).collect()
    };
    // Twice the decay time, then one sample less.
    let (present, absent) = windows(&late(5000), SETTLING_S, &[]);
    let expected = [
        (WindowKind::Steady, 1.25, 1.5),
        (WindowKind::Transient, 1.0, 1.05),
    ];
    assert_eq!(places(present), expected);
    assert!(absent.is_empty());
    let (present, absent) = windows(&late(4999), SETTLING_S, &[]);
    let expected = [
        (WindowKind::Transient, 1.0, 1.05),
        (WindowKind::Whole, 1.0, 1.4999),
    ];
    assert_eq!(places(present), expected);
    assert_eq!(absent[0].kind, WindowKind::Steady);
    // Room for the transient of the last change and a fifth of it, then one sample less.
    let (present, _) = windows(&late(6000), SETTLING_S, &[1.3]);
    assert_eq!(places(present)[0], (WindowKind::Steady, 1.55, 1.6));
    let (present, _) = windows(&late(6000), SETTLING_S, &[1.3001]);
    assert_eq!(present[0].kind, WindowKind::Transient);
    // A load change at either end of a window does not count.
    let (present, _) = windows(&late(6000), SETTLING_S, &[1.0, 1.02, 1.05]);
    assert_eq!(present[1].load_changes, 1);
    // A gear that settles sooner has a shorter transient.
    let (present, _) = windows(&late(5000), 0.1, &[]);
    assert_eq!(places(present)[1], (WindowKind::Transient, 1.0, 1.02));
    // Ten samples are enough, nine are not.
    let few = |count: u32| {
        let times = (0..count).map(|k| f64::from(k) * 5e-3);
        windows(&TimeSeries::new(times.collect()).unwrap(), SETTLING_S, &[]).0
    };
    assert_eq!((few(10).len(), few(9).len()), (1, 0));
}

#[test]
fn too_few_samples() {
    for time in [vec![], vec![0.0], vec![0.0, 0.3, 0.6]] {
        let (present, absent) = windows(&TimeSeries::new(time.clone()).unwrap(), SETTLING_S, &[]);
        assert!(present.is_empty() && !absent.is_empty(), "{time:?}");
    }
}
