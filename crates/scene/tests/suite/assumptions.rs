//! Assumptions of a scene.

use pinwheel_scene::{Override, PRESETS, Scene, assumptions, doubts};

fn keys(scene: Scene) -> Vec<String> {
    let scene = scene.check().unwrap();
    let list = assumptions(&scene).into_iter();
    list.map(|assumption| assumption.key).collect()
}

#[test]
fn the_papers_gear_names_fig_3_mu_and_tab_2() {
    let keys = keys(Scene::paper());
    for key in [
        "gear.internal_sleeve_radius_m",
        "gear.hole_radius_m",
        "gear.internal_circle_radius_m",
        "contact.friction_coefficient",
        "mass",
    ] {
        assert!(keys.iter().any(|k| k == key), "{key} missing in {keys:?}");
    }
}

#[test]
fn a_base_is_one_entry() {
    let scene = Scene::from_toml("base = \"forty-pins\"", "mine.toml", &[]).unwrap();
    let list = assumptions(&scene);
    assert_eq!(list.len(), 1);
    assert_eq!(
        (list[0].key.as_str(), list[0].value.as_str()),
        ("base", "forty-pins")
    );
    assert!(list[0].reason.contains("gear.wheels"));
}

/// Likely mistakes in one key of a gear from `init`.
#[test]
fn bad_input_that_is_hard_to_believe() {
    let gear = crate::catalogue::catalogue(39, 104.0).draft().unwrap();
    let doubts_of = |sets: &[(&str, &str)]| {
        let sets: Vec<String> = sets
            .iter()
            .map(|(key, value)| format!("{key}={value}"))
            .collect();
        let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
        let scene = Scene::from_toml(&gear.text, "mine.toml", &sets).unwrap();
        let each = doubts(&scene).into_iter();
        each.map(|one| format!("{}: {}", one.key, one.reason))
            .collect::<Vec<_>>()
    };
    assert_eq!(doubts_of(&[]), [""; 0]);
    for (key, value, meant) in [
        ("gear.face_width_m", "7.8", "typed in mm? that is 0.0078 m"),
        (
            "drive.input_speed_rad_s",
            "15000",
            "typed in rpm? that is 1570.8 rad/s",
        ),
        (
            "mass.density_kg_m3",
            "7.85",
            "typed in g/cm^3? that is 7850 kg/m^3",
        ),
        (
            "drive.output_torque_n_m",
            "200e3",
            "typed in N mm? that is 200 N m",
        ),
        (
            "contact.material",
            "\"pla\"",
            "more than pla has, half to twice",
        ),
        (
            "solver.step_s",
            "1e-6",
            "chooses its steps by solver.tolerance",
        ),
    ] {
        let one = doubts_of(&[(key, value)]);
        assert_eq!(one.len(), 1, "{one:?}");
        assert!(one[0].contains(meant), "{one:?}");
    }
    // At the largest permitted values.
    let near = [
        ("gear.face_width_m", "0.2"),
        ("drive.input_speed_rad_s", "3000"),
        ("mass.density_kg_m3", "19300"),
    ];
    assert_eq!(doubts_of(&near), [""; 0]);
    assert_eq!(
        doubts_of(&[("solver.integrator", "\"rk4\""), ("solver.step_s", "1e-6")]),
        [""; 0]
    );
}

#[test]
fn every_preset_is_believed() {
    for preset in PRESETS {
        let scene = Scene::load(preset.name, &[]).unwrap();
        assert_eq!(doubts(&scene), [], "{}", preset.name);
    }
}
