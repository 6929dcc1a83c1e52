//! The contact law across the boundary: against a second implementation, and with every key.

use pinwheel_engines::python::law_agreement;

use super::*;

/// The law in Rust and the one in numpy, an independent implementation of the paper's equations, at 300 random states.
///
/// A penetration is a difference of lengths of 64 mm, accurate to 1.4e-17 m, so a force is accurate to its slope times
/// that. Measured over that bound: at most 1.45; over the largest force: 1.2e-12, and 1.2e-11 for steel, whose penetrations
/// are a twentieth and below the ramp; 1.3e-12 for eleven pins. With 12 000 points stiffness comes from a circle through
/// three that are 36 um apart, which costs a digit: 7.6e-12. Rollers on a line, with the force along the profile: 6.5e-13,
/// and 7.7e-12 for steel with a modified profile. Over the largest force of the *same* state the worst is 2e-9, in states
/// with nearly no contact.
#[test]
fn crossval_python_law_in_numpy() {
    let friction = ("contact.friction_coefficient", "0.1");
    let play = ("gear.backlash_m", "0.0006");
    let paper = ("contact.law", "paper");
    let rollers = ("contact.law", "line-hertz");
    let points = ("contact.detection", "points");
    let coarse = ("contact.wheel_points", "600");
    let pin = ("bearings.internal_sleeve_stiffness_n_m", "1e7");
    let flanks = ("gear.modification.rotational_rad", "2e-4");
    for (preset, settings, largest) in [
        ("paper", vec![], 1e-12),
        ("paper-friction", vec![], 1e-12),
        ("backlash-0.6", vec![], 1e-12),
        ("backlash-0.6", vec![friction], 1e-12),
        ("steel", vec![], 3e-11),
        ("one-wheel", vec![], 1e-12),
        ("eleven-pins", vec![], 1e-11),
        ("forty-pins", vec![friction], 1e-11),
        ("paper-rough", vec![], 2e-12),
        ("paper-rough", vec![friction, play], 1e-12),
        ("paper-refined", vec![], 1e-11),
        ("modified", vec![paper, friction], 3e-11),
        ("toleranced", vec![paper, friction], 3e-11),
        ("toleranced", vec![paper, points, coarse, flanks], 3e-11),
        ("paper", vec![rollers], 1e-11),
        ("paper-friction", vec![pin], 1e-12),
        ("paper", vec![rollers, pin], 1e-11),
        ("modified", vec![rollers], 2e-11),
    ] {
        let scene = scene(preset, &settings);
        let agreement = law_agreement(&scene.clone().check().unwrap(), 300, 1).unwrap();
        println!("{preset} {settings:?}: {agreement:?}");
        assert!(agreement.loaded > 150, "states that say nothing");
        assert!(agreement.ambiguous < 2, "{agreement:?}");
        assert_within(preset, agreement.worst_n / agreement.largest_n, largest);
        assert_within("roundings", agreement.worst_over_rounding, 3.0);
    }
    // A wrong law is detected.
    let mut off = scene("paper", &[]);
    off.contact.law = "constant".to_owned();
    assert!(matches!(
        law_agreement(&off.clone().check().unwrap(), 10, 1),
        Err(Halt::Ended(Ending::Unsupported { .. }))
    ));
}

/// Runge-Kutta 4 in other coordinates and another program differs by rounding only. Every law, every friction, both
/// detections and other gears pass the boundary to the engines. Measured 4.5e-13 at most.
#[test]
fn crossval_python_every_law_same_method() {
    let base = [("solver.duration_s", "0.002"), ("solver.step_s", "1e-5")];
    let soft = ("contact.stiffness_multiplier", "0.01");
    let cases: [(&str, &[(&str, &str)]); 15] = [
        ("paper", &[]),
        ("paper", &[("contact.law", "\"paper-printed\"")]),
        ("paper", &[("contact.law", "\"paper-conservative\"")]),
        ("paper", &[("contact.law", "\"constant\"")]),
        ("paper", &[("contact.law", "\"adams-impact\"")]),
        ("paper", &[("contact.law", "\"line-contact\"")]),
        ("paper", &[("contact.law", "\"line-hertz\"")]),
        ("paper", &[("contact.law", "\"lankarani-nikravesh\"")]),
        ("paper-rough", &[]),
        ("one-wheel", &[("drive.load_ramp_s", "0.001")]),
        ("eleven-pins", &[("drive.start", "\"equilibrium\"")]),
        ("forty-pins", &[]),
        ("modified", &[soft]),
        ("toleranced", &[soft]),
        (
            "paper",
            &[
                ("contact.friction_coefficient", "0.05"),
                ("contact.friction_law", "\"adams\""),
                ("contact.friction_ramp_m_s", "0.05"),
                ("contact.friction_dynamic_speed_m_s", "0.1"),
                ("contact.friction_dynamic_coefficient", "0.03"),
            ],
        ),
    ];
    for (preset, settings) in cases {
        let scene = scene(preset, &[&base, settings].concat());
        let reference = native(&scene, "rk4", 1e-5);
        for engine in [MUJOCO, EXPLICIT] {
            let error = worst(&run(engine, &scene), &reference, 0.0);
            assert_within(&format!("{preset} {settings:?} {engine}"), error, 5e-12);
        }
    }
}
