//! Verdicts on an accepted and a new run.

use pinwheel_studies::baseline::{
    Converged, CostCheck, Quantity, QuantityCheck, QuantitySnapshot, Statistics, Verdict,
};
use pinwheel_studies::internals::{case, cost, quantity};

/// Returns the statistics of two oscillating forces, the second scaled.
fn course(shift: f64, second: f64) -> Statistics {
    let wave = |k: i32| 100.0 + shift + 30.0 * (f64::from(k) * 0.3).sin();
    let first: Vec<f64> = (0..200).map(wave).collect();
    let other: Vec<f64> = first.iter().map(|x| second * x).collect();
    Statistics::of_course(&[&first, &other])
}

/// Judges a run against an accepted one with an error of 1e-3.
fn judged(after: &Statistics) -> QuantityCheck {
    let (converged, ours) = (course(0.0, 1.0), course(0.1, 1.0));
    let scale = converged.whole_rms();
    let accepted = QuantitySnapshot {
        error: ours.distance(&converged).unwrap() / scale,
        rounding: 1e-14,
        statistics: ours,
    };
    let converged = Converged {
        scale,
        own_error: 1e-7,
        statistics: converged,
    };
    quantity(Quantity::ExternalForce, after, &accepted, &converged).unwrap()
}

#[test]
fn verdicts() {
    let verdict = |shift| judged(&course(shift, 1.0)).verdict;
    assert_eq!(verdict(0.1), Verdict::Same);
    assert_eq!(verdict(0.1 + 1e-12), Verdict::Same);
    assert_eq!(verdict(0.105), Verdict::Changed);
    assert_eq!(verdict(0.12), Verdict::Worse);
    assert_eq!(verdict(0.08), Verdict::Better);
    // An equal error of the opposite sign changes by twice the error.
    assert_eq!(verdict(-0.1), Verdict::Changed);
    assert_eq!(verdict(f64::NAN), Verdict::Worse);
    let other = Statistics {
        mean: vec![1.0],
        ..Statistics::default()
    };
    let same = QuantitySnapshot {
        error: 0.0,
        rounding: 0.0,
        statistics: course(0.0, 1.0),
    };
    let converged = Converged {
        scale: 1.0,
        own_error: 0.0,
        statistics: course(0.0, 1.0),
    };
    assert!(quantity(Quantity::ExternalForce, &other, &same, &converged).is_none());
}

/// A relative change of 1e-9 in one of two forces is no rounding; a change of the last digits is.
#[test]
fn a_change_of_one_force_by_1e_9_is_no_rounding() {
    let scaled = |factor: f64| judged(&course(0.1, factor));
    assert_eq!(scaled(1.0 + 1e-9).verdict, Verdict::Changed);
    let change = scaled(1.0 + 1e-9).change / 1e-9;
    assert!((0.2..2.0).contains(&change), "{change}");
    assert_eq!(scaled(1.0 + 1e-15).verdict, Verdict::Same);
}

/// Half the error at twice the steps is a trade. A slightly smaller error is not, and a larger error never is.
#[test]
fn accuracy_may_be_bought() {
    let costs = |after: f64| {
        vec![CostCheck {
            label: "steps",
            before: 2000.0,
            after,
            limit: 0.0,
            verdict: cost(2000.0, after, 0.0),
        }]
    };
    let verdict = |shift, after| case(&[judged(&course(shift, 1.0))], &costs(after));
    assert_eq!(verdict(0.05, 4000.0), Verdict::Traded);
    assert_eq!(verdict(0.05, 1000.0), Verdict::Better);
    assert_eq!(verdict(0.08, 4000.0), Verdict::Worse);
    assert_eq!(verdict(0.1, 4000.0), Verdict::Worse);
    assert_eq!(verdict(0.2, 1000.0), Verdict::Worse);
    assert_eq!(case(&[], &costs(2000.0)), Verdict::New);
}

#[test]
fn costs_have_room_only_where_rounding_moves_them() {
    assert_eq!(cost(2000.0, 2001.0, 0.0), Verdict::Worse);
    assert_eq!(cost(2000.0, 1999.0, 0.0), Verdict::Better);
    assert_eq!(cost(2000.0, 2010.0, 60.0), Verdict::Same);
}
