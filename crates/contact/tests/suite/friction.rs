//! Friction as a function of the sliding speed.

use pinwheel_contact::{AdamsFriction, Friction, RegularisedCoulomb};

#[test]
fn opposes_sliding_both_ways_and_saturates() {
    let friction = RegularisedCoulomb {
        coefficient: 0.1,
        ramp: 5e-5,
    };
    assert_eq!(friction.force(10.0, 1.0), -1.0);
    assert_eq!(friction.force(10.0, -1.0), 1.0);
    assert!((friction.force(10.0, 2.5e-5) + 0.5).abs() < 1e-15);
    assert_eq!(Friction::Regularised(friction).force(10.0, 1.0), -1.0);
}

#[test]
fn adams_friction_peaks_and_falls() {
    let friction = AdamsFriction {
        static_coefficient: 0.3,
        dynamic_coefficient: 0.1,
        static_speed: 0.1,
        dynamic_speed: 1.0,
    };
    for (speed, mu) in [(0.0, 0.0), (0.1, 0.3), (1.0, 0.1), (20.0, 0.1), (0.55, 0.2)] {
        assert!(
            (friction.force(10.0, speed) + 10.0 * mu).abs() < 1e-12,
            "{speed}"
        );
        assert!(
            (friction.force(10.0, -speed) - 10.0 * mu).abs() < 1e-12,
            "{speed}"
        );
    }
    // Continuous at the stiction velocity.
    let jump = friction.force(1.0, 0.1 - 1e-9) - friction.force(1.0, 0.1 + 1e-9);
    assert!(jump.abs() < 1e-7);
}
