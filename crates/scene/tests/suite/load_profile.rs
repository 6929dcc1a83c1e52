//! Load over time.

use pinwheel_scene::load_profile::*;
use pinwheel_scene::{Drive, LoadChange, Scene};

fn drive(changes: &[(f64, f64, f64)]) -> Drive {
    let change = |&(time_s, output_torque_n_m, ramp_s): &(f64, f64, f64)| LoadChange {
        time_s,
        output_torque_n_m,
        ramp_s,
    };
    Drive {
        load_changes: changes.iter().map(change).collect(),
        ..Scene::paper().drive
    }
}

#[test]
fn a_change_holds_from_its_time_on_and_a_ramp_is_straight() {
    let drive = drive(&[(0.1, 44.0, 0.0), (0.2, -22.0, 0.1)]);
    let at = |t: f64| piece_at(&drive, t).torque(t);
    let below = |t: f64| f64::from_bits(t.to_bits() - 1);
    assert_eq!((at(0.0), at(below(0.1)), at(0.1)), (22.0, 22.0, 44.0));
    assert_eq!((at(0.2), at(0.4), at(9.0)), (44.0, -22.0, -22.0));
    assert!((at(0.25) - 11.0).abs() < 1e-12);
    // The ending segment keeps its load at its end, where the next one has its own.
    assert_eq!(piece_at(&drive, 0.05).torque(0.1), 22.0);
    assert_eq!(breaks(&drive), [0.1, 0.2, 0.2 + 0.1]);
    assert_eq!(largest(&drive), 44.0);
}

/// 0.2 s + 0.1 s exceeds 0.3 s by a rounding.
#[test]
fn a_ramp_that_ends_at_the_next_change_is_one_break() {
    let drive = drive(&[(0.2, 44.0, 0.1), (0.3, 0.0, 0.1), (0.5, 1.0, 0.0)]);
    assert_eq!(breaks(&drive), [0.2, 0.3, 0.4, 0.5]);
    let ramp = Drive {
        load_ramp_s: 0.2,
        ..drive.clone()
    };
    assert_eq!(breaks(&ramp), [0.2, 0.3, 0.4, 0.5]);
    let early = Drive {
        load_ramp_s: 0.1,
        ..drive
    };
    assert_eq!(breaks(&early), [0.1, 0.2, 0.3, 0.4, 0.5]);
}

#[test]
fn without_changes_there_is_no_break() {
    let ramp = Drive {
        load_ramp_s: 0.01,
        ..Scene::paper().drive
    };
    assert!(breaks(&ramp).is_empty());
    assert_eq!(piece_at(&ramp, 0.005).torque(0.005), 11.0);
    assert!((mean(&ramp, 0.002, 0.004) - 6.6).abs() < 1e-12);
}

#[test]
fn the_mean_over_a_jump_weighs_both_sides() {
    let drive = drive(&[(0.1, 44.0, 0.0), (0.2, 0.0, 0.1)]);
    assert!((mean(&drive, 0.09, 0.13) - (0.25 * 22.0 + 0.75 * 44.0)).abs() < 1e-12);
    assert!((mean(&drive, 0.15, 0.35) - (0.25 * 44.0 + 0.5 * 22.0)).abs() < 1e-12);
}
