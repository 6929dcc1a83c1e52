//! Gears with crankshafts.

use pinwheel_scene::{Override, Scene};

fn refusal(key: &str, value: &str) -> String {
    let set = Override::new(key, value);
    Scene::load("rv-40e-like", &[set]).unwrap_err().to_string()
}

#[test]
fn bad_input_of_cranks_names_the_key() {
    for (key, value, wanted) in [
        ("gear.internal_sleeves", "8", "gear.internal_sleeves"),
        ("gear.hole_radius_m", "0.02", "gear.hole_radius_m"),
        ("cranks.bore_radius_m", "0.001", "cranks.bore_radius_m"),
        ("cranks.count", "1", "cranks.count"),
        ("gear.errors.hole_radius_m", "[-1e-6,0,0,0]", "clearance"),
        ("contact.internal_spring_n_m", "1e8", "output pins"),
        (
            "bearings.internal_sleeve_stiffness_n_m",
            "1e8",
            "output pins",
        ),
    ] {
        let line = refusal(key, value);
        assert!(line.contains(wanted), "{key}: {line}");
    }
    // Cranks with half of their keys, then with rigid bearings.
    let text = "[gear]\neccentricity_m = 0.0013\nexternal_sleeves = 40\npin_circle_radius_m = 0.064\nwheels = 2\n\
        external_sleeve_radius_m = 0.003\n[drive]\ninput_speed_rad_s = 190.0\noutput_torque_n_m = -412.0\n[cranks]\ncount = 2\n";
    let rest =
        "circle_radius_m = 0.036\nbore_radius_m = 0.011\nsun_teeth = 12\nplanet_teeth = 36\n";
    let fails = |text: &str| {
        Scene::from_toml(text, "mine.toml", &[])
            .unwrap_err()
            .to_string()
    };
    assert!(fails(text).contains("cranks.sun_teeth"), "{}", fails(text));
    let rigid = fails(&format!("{text}{rest}"));
    assert!(
        rigid.contains("bearings.eccentric.stiffness_n_m"),
        "{rigid}"
    );
}

/// At the ideal mesh both shafts together have all of the cranks' kinetic energy.
#[test]
fn both_shafts_carry_the_cranks_turning() {
    let scene = Scene::load("rv-40e-like", &[]).unwrap();
    let [input, output] = [
        (scene.input_shaft(), scene.mass.input_shaft),
        (scene.output_shaft(), scene.mass.output_shaft),
    ]
    .map(|(with, without)| with.moment_kg_m2 - without.moment_kg_m2);
    // Speed of the cranks for an input at 1 rad/s, by hand: (1 + 1/3)/121 - 1/3.
    let turning: f64 = (4.0 / 3.0) / 121.0 - 1.0 / 3.0;
    let cranks = 2.0 * scene.mass.internal_sleeve.moment_kg_m2 * turning * turning;
    let inertia = input + output / (121.0 * 121.0);
    assert!((inertia / cranks - 1.0).abs() < 1e-12, "{inertia} {cranks}");
    // With a fixed carrier the input has all of the inertia.
    let held = Scene::load("rv-40e-like", &["drive.output=ring".parse().unwrap()]).unwrap();
    let of_input = held.input_shaft().moment_kg_m2 - held.mass.input_shaft.moment_kg_m2;
    let cranks = 2.0 * held.mass.internal_sleeve.moment_kg_m2 / 9.0;
    assert!((of_input / cranks - 1.0).abs() < 1e-12);
    assert_eq!(held.output_shaft(), held.mass.output_shaft);
}

/// 1 + 40 x 36/12 from the teeth; for other gears the number of lobes.
#[test]
fn published_ratio_of_a_catalogue() {
    let scene = Scene::load("rv-40e-like", &[]).unwrap();
    assert_eq!(scene.ratio(), 121.0);
    assert!((scene.output_per_input() * 121.0 - 1.0).abs() < 1e-14);
    let again = Scene::from_complete(&scene.to_toml()).unwrap();
    assert_eq!(again, scene);
    assert_eq!(Scene::paper().ratio(), 15.0);
}
