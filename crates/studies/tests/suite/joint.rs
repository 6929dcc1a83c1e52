//! Springs of a joint that represents a gear.

use pinwheel_studies::design::Spring;
use pinwheel_studies::internals::{LEVELS, springs};

/// Returns the torque of the springs at a twist.
fn torque(springs: &[Spring], twist: f64) -> f64 {
    let one = |s: &Spring| s.stiffness_n_m_per_rad * (twist - s.dead_band_rad).max(0.0);
    springs.iter().map(one).sum()
}

#[test]
fn springs_pass_through_a_steepening_curve() {
    let twists = [1.0, 1.5, 2.0, 2.6, 3.2, 4.0];
    let chain = springs(&twists, 10.0);
    for (twist, share) in twists.into_iter().zip(LEVELS) {
        assert!(
            (torque(&chain, twist) - 10.0 * share).abs() < 1e-12,
            "{chain:?}"
        );
    }
    assert!(chain.iter().all(|s| s.stiffness_n_m_per_rad > 0.0));
    assert!(torque(&chain, 0.99) == 0.0);
}

#[test]
fn springs_never_pull() {
    // This curve is softer between 25 and 50 %, so that the fit passes below it.
    let twists = [1.0, 1.5, 2.0, 2.6, 4.0, 4.1];
    let chain = springs(&twists, 10.0);
    assert!(
        chain.iter().all(|s| s.stiffness_n_m_per_rad > 0.0),
        "{chain:?}"
    );
    assert!((torque(&chain, 4.1) - 10.0).abs() < 1e-12);
    for (twist, share) in twists.into_iter().zip(LEVELS) {
        assert!(torque(&chain, twist) <= 10.0 * share + 1e-12, "{chain:?}");
    }
}
