//! Windows: the parts of a run that are compared apart from each other.
//!
//! The start-up transient is a hard test of integration and a poor one of geometry, the steady
//! part the other way round; one figure over both would hide either.

use pinwheel_timeseries::TimeSeries;
use serde::{Deserialize, Serialize};

/// Time in which the paper gearbox's start-up transient decays, s (measured: about 0.25 s, with
/// 1.2 kHz at 2 % of critical damping). A steady window starts no earlier.
pub const SETTLING_S: f64 = 0.25;
/// Length of the transient window of a gear that settles in [`SETTLING_S`], s; others have the same share of their own.
pub const TRANSIENT_S: f64 = 0.05;
/// Samples a window must hold: with fewer a mean square says nothing.
pub const FEWEST_SAMPLES: usize = 10;

/// Which part of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowKind {
    /// After the start-up transient: the second half of the run, or what is left of it when the load has changed
    /// for the last time and the transient of that has decayed.
    Steady,
    /// The first fifth of the time in which the gear settles ([`TRANSIENT_S`] of [`SETTLING_S`]).
    Transient,
    /// The whole run; only where it has no steady window.
    Whole,
}

impl WindowKind {
    /// The word used in files and tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Transient => "transient",
            Self::Whole => "whole",
        }
    }
}

/// A window that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Window {
    /// Which part.
    pub kind: WindowKind,
    /// Start, s, included.
    pub from_s: f64,
    /// End, s, included.
    pub to_s: f64,
    /// Samples in it.
    pub samples: usize,
    /// Changes of the load in it; never any in a steady one.
    #[serde(skip_serializing_if = "is_none")]
    pub load_changes: usize,
}

fn is_none(changes: &usize) -> bool {
    *changes == 0
}

impl Window {
    /// One sentence about the window that a reader must know beside its times; `None`: nothing.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        let word = self.kind.word();
        match self.load_changes {
            0 => None,
            1 => Some(format!("The load changes in the {word} window.")),
            n => Some(format!("The load changes {n} times in the {word} window.")),
        }
    }
}

/// A window that cannot be compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbsentWindow {
    /// Which part.
    pub kind: WindowKind,
    /// Why it is not there.
    pub reason: String,
}

/// The windows of a run with the sample times of `time_series`, and those it is too short for.
/// `settling_s`: time in which the start-up transient has decayed. `load_changes_s`: times at which the load
/// changes or comes to the end of a change, increasing; after the last one within the run a transient decays in
/// `settling_s` (of a start in equilibrium, where that is 0, [`SETTLING_S`]), and a steady window has at least a fifth of that
/// after it.
#[must_use]
pub fn windows(
    time_series: &TimeSeries,
    settling_s: f64,
    load_changes_s: &[f64],
) -> (Vec<Window>, Vec<AbsentWindow>) {
    let (mut present, mut absent) = (Vec::new(), Vec::new());
    let time_s = time_series.time_s();
    let (start, end) = match (time_s.first(), time_s.last()) {
        (Some(&start), Some(&end)) => (start, end),
        _ => (0.0, 0.0),
    };
    let duration = end - start;
    let decays_s = if settling_s > 0.0 {
        settling_s
    } else {
        SETTLING_S
    };
    let transient_s = TRANSIENT_S / SETTLING_S * decays_s;
    let mut offer = |kind: WindowKind, from_s: f64, to_s: f64| {
        let samples = time_series.window(from_s, to_s).len();
        if samples < FEWEST_SAMPLES {
            let reason = format!("it would hold {samples} samples, fewer than {FEWEST_SAMPLES}");
            absent.push(AbsentWindow { kind, reason });
            return false;
        }
        let changes = load_changes_s.iter();
        present.push(Window {
            kind,
            from_s,
            to_s,
            samples,
            load_changes: changes.filter(|&&t| from_s < t && t < to_s).count(),
        });
        true
    };
    // A rounding's breadth, as the duration is a sum of many steps.
    let settled = duration / 2.0 * (1.0 + 1e-9) >= settling_s;
    let half = start + duration / 2.0;
    let changed = load_changes_s.iter().rev().find(|&&t| t < end);
    let (from, reached) = match changed {
        Some(last) if last + decays_s > half => {
            let from = last + decays_s;
            (from, from + transient_s <= end * (1.0 + 1e-9))
        }
        _ => (half, true),
    };
    let steady = settled && reached && offer(WindowKind::Steady, from, end);
    offer(WindowKind::Transient, start, end.min(start + transient_s));
    if !steady && duration > transient_s * (1.0 + 1e-9) {
        offer(WindowKind::Whole, start, end);
    }
    let reason = match changed {
        _ if !settled => Some(format!(
            "the run lasts {} s; the start-up transient takes {settling_s} s, so a steady window \
             needs {} s",
            rounded(duration),
            2.0 * settling_s
        )),
        Some(last) if !reached => Some(format!(
            "the load still changes at {} s and the transient of that takes {decays_s} s, so a steady window \
             needs a run of {} s",
            rounded(*last),
            rounded(last + decays_s + transient_s)
        )),
        _ => None,
    };
    let kind = WindowKind::Steady;
    absent.extend(reason.map(|reason| AbsentWindow { kind, reason }));
    (present, absent)
}

/// A time without the digits that only rounding has put there.
fn rounded(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

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

    /// No steady window holds a change of the load or what it leaves behind.
    #[test]
    fn a_change_of_the_load_moves_the_steady_window() {
        let steady = |changes: &[f64]| {
            let (present, absent) = windows(&times(6000), SETTLING_S, changes);
            let found = present.into_iter().find(|w| w.kind == WindowKind::Steady);
            assert!(found.is_none_or(|w| w.load_changes == 0 && w.remark().is_none()));
            (found.map(|w| w.from_s), absent)
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
            "the load still changes at 0.4 s and the transient of that takes 0.25 s, so a steady \
             window needs a run of 0.7 s"
        );
        // From equilibrium too: the change has a transient of its own.
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
            "The load changes 2 times in the transient window."
        );
    }

    /// A window that just fits is there, also in a run that begins late.
    #[test]
    fn what_just_fits_is_a_window() {
        let late = |count: u32| {
            let times = (0..=count).map(|k| 1.0 + f64::from(k) * 1e-4);
            TimeSeries::new(times.collect()).unwrap()
        };
        let places = |found: Vec<Window>| -> Vec<(WindowKind, f64, f64)> {
            let place = |w: Window| (w.kind, rounded(w.from_s), rounded(w.to_s));
            found.into_iter().map(place).collect()
        };
        // Twice what it takes to settle, and a sample less.
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
        // Room for what the last change leaves behind and a fifth of that, and a sample less.
        let (present, _) = windows(&late(6000), SETTLING_S, &[1.3]);
        assert_eq!(places(present)[0], (WindowKind::Steady, 1.55, 1.6));
        let (present, _) = windows(&late(6000), SETTLING_S, &[1.3001]);
        assert_eq!(present[0].kind, WindowKind::Transient);
        // A change at either end of a window is none in it.
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
            let (present, absent) =
                windows(&TimeSeries::new(time.clone()).unwrap(), SETTLING_S, &[]);
            assert!(present.is_empty() && !absent.is_empty(), "{time:?}");
        }
    }
}
