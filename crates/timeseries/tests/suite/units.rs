//! Units of columns.

use std::f64::consts::PI;

use pinwheel_timeseries::internals::{factor, turn};

#[test]
fn units_of_a_kind_only() {
    assert_eq!(factor("input_torque_n_m", "N mm"), Ok(1e-3));
    assert_eq!(factor("input_torque_n_m", "N\u{b7}m"), Ok(1.0));
    assert_eq!(factor("external_sleeve_force_n_3", "kN"), Ok(1e3));
    assert_eq!(factor("external_sleeve_force_n_*", "kN"), Ok(1e3));
    assert_eq!(
        factor("wheel_0_external_stiffness_n_m15_3", "N/m^1.5"),
        Ok(1.0)
    );
    assert!((factor("output_angle_rad", "deg").unwrap() * 180.0 - PI).abs() < 1e-15);
    assert!((factor("wheel_speed_rad_s", "rpm").unwrap() * 30.0 - PI).abs() < 1e-15);
    assert_eq!(factor("time_s", "ms"), Ok(1e-3));
    assert!(
        factor("output_angle_rad", "N")
            .unwrap_err()
            .contains(&"deg")
    );
    assert!(factor("efficiency", "%").unwrap_err().is_empty());
    assert_eq!(turn("transmission_error_arcmin"), Some(21_600.0));
    assert_eq!(
        (turn("wheel_speed_rad_s"), turn("input_torque_n_m")),
        (None, None)
    );
}

/// Torques in data sheets: force times arm, in any order, with any sign between them. Pound-force and inch are those of NIST SP
/// 811, appendix B.
#[test]
fn published_torques_are_products() {
    for (unit, value) in [
        ("kgf*cm", 0.098_066_5),
        ("ozf*in", 0.007_061_552),
        ("oz-in", 0.007_061_552),
        ("N-m", 1.0),
        ("N\u{22c5}cm", 0.01),
        ("newton-mm", 1e-3),
        ("newton-meter", 1.0),
        ("lb-ft", 1.355_818),
        ("ft lbf", 1.355_818),
        ("ft-lb", 1.355_818),
        ("in*lbf", 0.112_984_8),
        ("kN mm", 1.0),
        ("kp*m", 9.806_65),
        ("m", f64::NAN),
        ("N*s", f64::NAN),
    ] {
        let ratio = factor("output_torque_n_m", unit).unwrap_or(f64::NAN);
        let same = (ratio / value - 1.0).abs() < 1e-6;
        assert!(same || ratio.is_nan() && value.is_nan(), "{unit}: {ratio}");
    }
}
