//! Table of keys.

use pinwheel_scene::KEYS;

/// Errors with one entry in every list, by the keys' names.
fn every_error() -> pinwheel_scene::Errors {
    let lists = KEYS.iter().filter_map(|key| {
        let name = key.name.strip_prefix("gear.errors.")?;
        Some((name.to_owned(), toml::Value::from(vec![1e-6])))
    });
    toml::Table::from_iter(lists).try_into().unwrap()
}

#[test]
fn names_differ_and_say_what_they_are() {
    for (k, key) in KEYS.iter().enumerate() {
        assert!(KEYS[..k].iter().all(|other| other.name != key.name));
        assert!(!key.about.is_empty(), "{}", key.name);
    }
}

/// Every field of the model has a row, and every row a field except those that only serve reading.
#[test]
fn rows_are_the_model() {
    fn leaves(prefix: &str, table: &toml::Table, all: &mut Vec<String>) {
        for (name, value) in table {
            match value.as_table() {
                Some(inner) => leaves(&format!("{prefix}{name}."), inner, all),
                None => all.push(format!("{prefix}{name}")),
            }
        }
    }
    let mut scene = pinwheel_scene::Scene::paper();
    scene.gear.face_width_m = Some(0.01);
    scene.gear.external_sleeves_turn = false;
    scene.gear.internal_sleeves_turn = false;
    scene.gear.eccentric_bore_radius_m = Some(0.01);
    scene.contact.material = Some("steel".to_owned());
    scene.contact.pin_material = Some("bronze".to_owned());
    scene.limits = toml::from_str(
        "pressure_pa = 1e9\nbending_pa = 3e8\npressure_sliding_w_m2 = 1e6\nstatic_safety = 1.5\nlife_h = 6e3\nwall_m = 1e-3",
    )
    .unwrap();
    scene.mass.density_kg_m3 = Some(7850.0);
    scene.contact.pin_young_pa = Some(2e11);
    scene.contact.pin_poisson = Some(0.3);
    scene.contact.band_laws = Some(vec!["kunert".to_owned()]);
    scene.contact.disc_depth_m = Some(0.01);
    scene.contact.internal_stiffness_multiplier = Some(0.01);
    scene.contact.external_spring_n_m = Some(1e8);
    scene.contact.internal_spring_n_m = Some(1e8);
    scene.bearings = toml::from_str(
        "output_torsion_n_m_rad = 1e5\ninternal_sleeve_stiffness_n_m = 5e7\n\
         internal_sleeves_held = \"one-end\"\ninternal_sleeve_gap_m = 1e-3\n\
         sleeve_friction_coefficient = 0.002\nsleeve_bore_m = 0.01\ninput_seal_n_m = 0.1\noutput_seal_n_m = 0.1\n\
         [eccentric]\nstiffness_n_m = 1e8\nexponent = 1.0\nrollers = 9\n\
         roller_length_m = 0.01\nclearance_m = 0.0\ndamping_n_s_m = 1.0\ndynamic_rating_n = 2e4\n\
         roller_diameter_m = 3e-3\n\
         friction_coefficient = 0.002\nbore_m = 0.02",
    )
    .unwrap();
    scene.structure = toml::from_str(
        "output_pin_diameter_m = 6e-3\noutput_seat_length_m = 1e-2\nring_seat_length_m = 1e-2\n\
         ring_slot_clearance_m = 1e-6\nhousing_material = \"steel\"\nplate_thickness_m = 5e-3\n\
         plate_radius_m = 2e-2\ninput_torsion_n_m_rad = 1e4",
    )
    .unwrap();
    scene.temperature = toml::from_str("housing_k = 1.0\ndisc_k = 2.0\npins_k = 3.0").ok();
    scene.cranks = toml::from_str(
        "count = 2\ncircle_radius_m = 0.03\nbore_radius_m = 0.01\nsun_teeth = 12\nplanet_teeth = 36\n\
         support_stiffness_n_m = 1e8\nmesh_stiffness_n_m = 1e8",
    )
    .ok();
    scene.gear.modification.radial_m = -1e-5;
    scene.gear.modification.normal_m = pinwheel_scene::NormalOffset {
        points_m: vec![0.0],
        cos_m: vec![0.0],
        sin_m: vec![0.0],
    };
    scene.gear.errors = every_error();
    scene.drive.load_changes.push(pinwheel_scene::LoadChange {
        time_s: 0.1,
        output_torque_n_m: 1.0,
        ramp_s: 0.0,
    });
    scene.drive.speed_changes.push(pinwheel_scene::SpeedChange {
        time_s: 0.1,
        input_speed_rad_s: 1.0,
        ramp_s: 0.1,
    });
    scene.drive.output = pinwheel_scene::OutputPart::Ring;
    scene.output.channels.push("efficiency".to_owned());
    let mut fields = Vec::new();
    leaves("", &toml::Table::try_from(&scene).unwrap(), &mut fields);
    let mut rows: Vec<String> = KEYS.iter().map(|key| key.name.to_owned()).collect();
    rows.retain(|name| name != "gear.pin_circle_radius_m");
    fields.sort();
    rows.sort();
    assert_eq!(fields, rows);
}
