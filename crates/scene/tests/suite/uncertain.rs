//! `[uncertain]`: read in every TOML form, stored, and refused if invalid.

use pinwheel_scene::{CheckedScene, Scene};

fn read(lines: &str) -> Result<CheckedScene, String> {
    let text = format!("base = \"paper\"\n{lines}\n");
    Scene::from_toml(&text, "mine.toml", &[]).map_err(|error| error.to_string())
}

#[test]
fn every_form_is_the_same() {
    let dotted = "[uncertain]\ngear.hole_radius_m = { plus_minus = 5e-6 }\ncontact.young_pa.plus_minus = 1e10";
    let tables = "[uncertain.contact.young_pa]\nplus_minus = 10000000000\n[uncertain]\n\"gear.hole_radius_m\" = { plus_minus = 5e-6 }";
    let one = read(dotted).unwrap();
    assert_eq!(one.uncertain.len(), 2);
    assert_eq!(one.uncertain["gear.hole_radius_m"].plus_minus, 5e-6);
    assert_eq!(read(tables).unwrap(), one);
    let set = |text: &str| text.parse().unwrap();
    let sets = [
        set("uncertain.gear.hole_radius_m.plus_minus=5e-6"),
        set("uncertain.contact.young_pa={ plus_minus = 1e10 }"),
    ];
    let by_sets = Scene::load("paper", &sets).unwrap();
    assert_eq!(by_sets.uncertain, one.uncertain);
    let again = Scene::from_toml(&one.to_toml(), "again.toml", &[]).unwrap();
    assert_eq!(again, one);
    let standard = one.uncertain["gear.hole_radius_m"].standard();
    assert!((standard - 5e-6 / 3.0_f64.sqrt()).abs() < 1e-18);
}

#[test]
fn bad_input_what_makes_no_sense_is_refused() {
    for (line, parts) in [
        (
            "gear.wheels = { plus_minus = 1 }",
            &["line 3", "no number"][..],
        ),
        ("contact.law = { plus_minus = 1 }", &["no number"]),
        (
            "solver.step_s = { plus_minus = 1e-6 }",
            &["setting", "leave it out"],
        ),
        (
            "gear.backlash = { plus_minus = 1e-6 }",
            &["did you mean `gear.backlash_m`"],
        ),
        ("gear.backlash_m = 5e-6", &["by how much", "plus_minus"]),
        (
            "gear.backlash_m = { plus = 5e-6 }",
            &["by how much", "plus_minus"],
        ),
        ("gear.hole_radius_m = { plus_minus = 0.0 }", &["above 0"]),
        ("gear.hole_radius_m = { plus_minus = nan }", &["above 0"]),
        (
            "gear.backlash_m = { plus_minus = 5e-6 }",
            &["line 3", "reaches -", "middle of the interval"],
        ),
        ("gear = 1", &["must be a table"]),
        (
            "gear.pin_circle_radius_m = { plus_minus = 1e-6 }",
            &["no number of this scene"],
        ),
    ] {
        let error = read(&format!("[uncertain]\n{line}")).expect_err(line);
        assert!(!error.contains('\n') && error.contains("; "), "{error}");
        for part in parts {
            assert!(error.contains(part), "{line}: {error}");
        }
    }
}

#[test]
fn a_number_is_changed_by_its_key() {
    let scene = read("").unwrap();
    let moved = scene.with_number("mass.wheel.mass_kg", 0.7).unwrap();
    assert_eq!(moved.mass.wheel.mass_kg, 0.7);
    assert_eq!(moved.number("mass.wheel.mass_kg"), Some(0.7));
    // A changed value is exact: its interval does not move with it, out of the key's range.
    let scene =
        read("gear.backlash_m = 5e-6\n[uncertain]\ngear.backlash_m = { plus_minus = 5e-6 }")
            .unwrap();
    let moved = scene.with_number("gear.backlash_m", 1e-6).unwrap();
    assert!(moved.uncertain.is_empty() && moved.gear.backlash_m == 1e-6);
    assert!(scene.with_number("gear.wheels", 3.0).is_err());
    assert!(scene.with_number("gear.backlash_m", -1.0).is_err());
}
