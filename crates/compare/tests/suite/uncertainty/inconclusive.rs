//! Refinement studies without a conclusion: chaos, error floors of iterations, bounces that coarser runs miss.

use super::common::time_series;
use super::{FORCE, anywhere, compared, engine, entry, native, off};
use pinwheel_compare::uncertainty::{Basis, Source};
use pinwheel_compare::{Context, Divergence, SharedModel, Verdict};
use pinwheel_timeseries::TimeSeries;

/// A scene that amplifies rounding limits the accuracy of its own figures: inconclusive, without an action.
#[test]
fn hard_chaos_leaves_nothing_to_act_on() {
    let chaotic = Context {
        divergence: Some(Divergence {
            horizon_s: Some(0.0),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..anywhere()
    };
    let peer = || {
        engine(
            "native-lagrange",
            SharedModel::Native,
            &time_series(1.0),
            0.3,
            2.0,
            &[2.0, 4.0],
        )
    };
    let comparison = compared(&chaotic, vec![native(0.3), peer()]);
    assert!(
        comparison.counts.inconclusive > 0 && comparison.counts.inconclusive_actionable == 0,
        "{:?}",
        comparison.counts
    );
    assert_eq!(comparison.counts.exit_status(), 0);
    // A wide difference before the horizon is a failure.
    let comparison = compared(&anywhere(), vec![native(0.3), peer()]);
    assert!(
        comparison.counts.inconclusive_actionable == comparison.counts.inconclusive
            && comparison.counts.exit_status() == 4,
        "{:?}",
        comparison.counts
    );
}

/// The error of an engine's own iterations does not fall with the step, so it bounds the accuracy.
#[test]
fn regress_iterations_leave_a_floor() {
    let offset = |floor: f64| {
        let base = off(&time_series(1.0), 1e-9);
        let steps = [2.0, 4.0];
        let (peer, evidence) = engine("implicit", SharedModel::Native, &base, 1e-12, 2.0, &steps);
        compared(
            &anywhere(),
            vec![native(1e-12), (peer, evidence.with_floor(floor))],
        )
    };
    let at = |floor: f64| entry(&offset(floor), FORCE).result.verdict;
    assert_eq!((at(0.0), at(1e-8)), (Verdict::Differ, Verdict::Agree));
}

/// A bounce in one run of the study and not in another. Two levels that both miss it cannot detect it.
#[test]
fn hard_a_bounce_that_coarser_runs_miss() {
    let bounce = |base: TimeSeries| {
        let mut time_series = TimeSeries::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let mut values = channel.values.clone();
            if channel.name.starts_with(FORCE) {
                values[450] = 0.0;
                values[451] = 300.0;
            }
            time_series.push(channel.name.clone(), values).unwrap();
        }
        time_series
    };
    let exact = engine(
        "exact",
        SharedModel::Native,
        &bounce(time_series(1.0)),
        1e-6,
        2.0,
        &[2.0, 4.0],
    );
    let (mut seeing, mut study) = native(1e-6);
    seeing.time_series = bounce(seeing.time_series);
    let comparison = compared(
        &anywhere(),
        vec![exact.clone(), (seeing.clone(), study.clone())],
    );
    let result = &entry(&comparison, FORCE).result;
    let named = (result.verdict, result.participant.as_deref());
    assert_eq!(
        named,
        (Verdict::Inconclusive, Some("native")),
        "only the finest has it"
    );
    if let Source::Refinement(study) = &mut study.source {
        let fine = study.coarser[0].run.clone().unwrap();
        study.coarser[0].run = Ok(bounce(fine));
    }
    let comparison = compared(&anywhere(), vec![exact, (seeing, study)]);
    // The coarsest run misses it: accidental super-convergence, which costs accuracy and nothing else.
    let estimate = *comparison.engines[1]
        .uncertainty
        .iter()
        .find(|u| u.quantity == FORCE)
        .unwrap()
        .l2
        .estimate()
        .unwrap();
    assert_eq!(estimate.basis, Basis::Unconfirmed);
    assert_ne!(entry(&comparison, FORCE).result.verdict, Verdict::Differ);
}
