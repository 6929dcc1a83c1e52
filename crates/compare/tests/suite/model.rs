//! Stated tolerances of models.

use pinwheel_compare::internals::{account, predicted};
use pinwheel_compare::limits::Friction;
use pinwheel_compare::model::*;
use pinwheel_compare::*;
use pinwheel_timeseries::TimeSeries;

use super::common;

/// Returns a participant with an account for each part: from, to, remainder as a share.
fn participant(parts: &[(f64, f64, Option<f64>)]) -> Participant {
    let energy = parts.iter().map(|&(from_s, to_s, share)| Energy {
        from_s,
        to_s,
        driver_j: 1.0,
        load_j: -1.0,
        remainder_j: share.unwrap_or(0.0),
        remainder_share: share,
        ..Energy::default()
    });
    let mut native = common::participant("a", SharedModel::Native, TimeSeries::default());
    native.cost.energy = energy.collect();
    native
}

/// Second half of a run of 0.6 s.
const WINDOW: Window = Window {
    kind: WindowKind::Steady,
    from_s: 0.3,
    to_s: 0.6,
    samples: 100,
    load_changes: 0,
};

/// Chooses among several accounts the one that shares most of the window, and none that shares half of both or less.
#[test]
fn the_account_is_of_the_window() {
    let of = |parts: &[(f64, f64, Option<f64>)]| {
        account(&participant(parts), &WINDOW).map(|energy| (energy.from_s, energy.to_s))
    };
    let best = [
        (0.28, 0.6, Some(0.1)),
        (0.31, 0.6, Some(0.2)),
        (0.3, 0.56, Some(0.3)),
    ];
    assert_eq!(of(&best), Some((0.31, 0.6)));
    assert_eq!(of(&[best[1], best[0]]), Some((0.31, 0.6)));
    // 0.3 s in an account of 0.58 s, then of 0.62 s.
    assert_eq!(of(&[(0.02, 0.6, Some(0.1))]), Some((0.02, 0.6)));
    assert_eq!(of(&[(0.3, 0.92, Some(0.1))]), None);
    // 0.16 s of 0.3 s, then 0.14 s, then no overlap.
    assert_eq!(of(&[(0.44, 0.6, Some(0.1))]), Some((0.44, 0.6)));
    assert_eq!(of(&[(0.46, 0.6, Some(0.1))]), None);
    assert_eq!(of(&[(0.0, 0.3, Some(0.1))]), None);
    // An account without a share does not count.
    let unknown = [(0.3, 0.6, None), (0.3, 0.6, Some(f64::NAN))];
    assert_eq!(of(&unknown), None);
    assert_eq!(of(&[unknown[0], best[0]]), Some((0.28, 0.6)));
}

/// The engine whose law creates more energy needs less drive.
#[test]
fn predicted_is_what_the_second_creates_beyond_the_first() {
    let with = |share: f64| participant(&[(0.3, 0.6, Some(share))]);
    let none = participant(&[]);
    let close = |actual: Option<f64>, expected: f64| {
        assert!((actual.unwrap() - expected).abs() < 1e-15, "{actual:?}");
    };
    close(predicted(&with(0.01), &with(0.03), &WINDOW), 0.02);
    close(predicted(&with(0.01), &none, &WINDOW), -0.01);
    close(predicted(&none, &with(0.03), &WINDOW), 0.03);
    assert_eq!(predicted(&none, &none, &WINDOW), None);
}

/// Friction, window and quantity must all match.
#[test]
fn a_statement_is_about_its_friction_window_and_quantity() {
    let statement = ModelTolerance {
        friction: Friction::Without,
        window: Some(WindowKind::Steady),
        quantity: "input_torque_n_m",
        metric: Metric::Mean,
        predicted: Prediction::Same,
        tolerance: 1.0,
        reason: "",
    };
    let (steady, input) = (WindowKind::Steady, "input_torque_n_m");
    let transient = WindowKind::Transient;
    assert!(statement.applies(false, steady, input));
    assert!(!statement.applies(true, steady, input));
    assert!(!statement.applies(false, transient, input));
    assert!(!statement.applies(false, steady, "x"));
    let with = ModelTolerance {
        friction: Friction::With,
        window: None,
        ..statement
    };
    assert!(with.applies(true, transient, input));
    assert!(!with.applies(false, steady, input));
}
