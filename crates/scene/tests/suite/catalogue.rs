//! Gears from catalogue data, and refusals.

use proptest::prelude::*;

use pinwheel_scene::as_built::tolerance_m;
use pinwheel_scene::catalogue::*;
use pinwheel_scene::{Scene, derived};

/// Catalogue of a steel gear, with a load that scales with its size; all else is omitted.
pub(crate) fn catalogue(ratio: impl Into<f64>, diameter_mm: f64) -> Catalogue {
    Catalogue {
        name: "mine".to_owned(),
        ratio: ratio.into(),
        cranks: None,
        pin_circle_diameter_m: 1e-3 * diameter_mm,
        outer_diameter_m: None,
        torque_n_m: 100.0 * (diameter_mm / 130.0).powi(3),
        speed_rad_s: 157.0,
        material: MATERIALS[0],
        pin_material: None,
        process: None,
        ideal: true,
        pin_diameter_m: None,
        eccentricity_m: None,
        wheels: None,
        output_pins: None,
        output_pin_diameter_m: None,
        output_circle_diameter_m: None,
        face_width_m: None,
        backlash_m: None,
        friction_coefficient: None,
    }
}

/// Outer diameters of gears whose authors state both, and of the RV presets in their catalogue sizes: the suggestion is off by less than
/// the spread that the file states.
#[test]
fn published_pin_circles_by_outer_diameters() {
    for (outer_mm, circle_mm, is_rv) in [
        (65.0, 50.0, false),
        (115.0, 90.0, false),
        (100.0, 80.0, false),
        (190.0, 128.0, true),
        (222.0, 155.0, true),
        (325.0, 239.0, true),
    ] {
        let circle = 1e3 * pin_circle_of_m(1e-3 * outer_mm, is_rv);
        assert!(
            (circle / circle_mm - 1.0).abs() < 0.06,
            "{outer_mm} {circle}"
        );
        let draft = Catalogue {
            outer_diameter_m: Some(1e-3 * outer_mm),
            cranks: is_rv.then_some(2),
            ..catalogue(if is_rv { 121.0 } else { 15.0 }, circle)
        };
        let text = draft.draft().unwrap().text;
        let line = text.lines().find(|line| line.starts_with("pin_circle"));
        let line = line.unwrap();
        let (_, to) = line.rsplit_once(": ").unwrap();
        let ends: Vec<f64> = (to.trim_end_matches(" mm").split(" to "))
            .map(|end| end.parse().unwrap())
            .collect();
        let known = 0.5 * circle_mm;
        assert!(line.contains("# suggested: "), "{line}");
        assert!(ends[0] <= known && known <= ends[1], "{line}");
    }
}

#[test]
fn what_is_given_is_kept() {
    let draft = Catalogue {
        pin_diameter_m: Some(0.004),
        eccentricity_m: Some(0.000_75),
        wheels: Some(3),
        output_pins: Some(10),
        output_pin_diameter_m: Some(0.008),
        output_circle_diameter_m: Some(0.064),
        face_width_m: Some(0.012),
        backlash_m: Some(2e-5),
        friction_coefficient: Some(0.05),
        ..catalogue(39, 104.0)
    }
    .draft()
    .unwrap();
    assert_eq!(draft.suggested, [""; 0]);
    assert!(!draft.text.contains("# suggested"), "{}", draft.text);
    let gear = &draft.scene.gear;
    assert_eq!((gear.external_sleeves, gear.wheels), (40, 3));
    assert_eq!(gear.eccentricity_m, 0.000_75);
    assert_eq!(gear.external_sleeve_radius_m, 0.002);
    assert_eq!(gear.hole_radius_m, 0.004_75);
    assert!((gear.pitch_radius_m() - 0.052).abs() < 1e-12);
    assert_eq!(draft.scene.contact.friction_coefficient, 0.05);
}

#[test]
fn bad_input_of_a_catalogue() {
    let crossing = Catalogue {
        eccentricity_m: Some(0.002),
        ..catalogue(39, 104.0)
    };
    let message = crossing.draft().unwrap_err().to_string();
    assert!(message.contains("less than 1.3 mm"), "{message}");
    let full = Catalogue {
        output_pin_diameter_m: Some(0.08),
        ..catalogue(39, 104.0)
    };
    let message = full.draft().unwrap_err().to_string();
    assert!(message.contains("finds no place"), "{message}");
    // A fault of the scene has its key's name and unit, not those of a diameter.
    let overlapping = Catalogue {
        pin_diameter_m: Some(0.012),
        ..catalogue(39, 100.0)
    };
    let message = overlapping.draft().unwrap_err().to_string();
    assert!(
        message.contains("gives a scene whose gear.external_sleeve_radius_m is 0.006 m"),
        "{message}"
    );
    let message = catalogue(118.5, 128.0).draft().unwrap_err().to_string();
    assert!(message.contains("give 118 or 119"), "{message}");
    let with_pins = Catalogue {
        cranks: Some(2),
        output_pins: Some(6),
        ..catalogue(81, 128.0)
    };
    let message = with_pins.draft().unwrap_err().to_string();
    assert!(message.contains("one eccentric"), "{message}");
}

#[test]
fn lengths_are_rounded_as_on_a_drawing() {
    for (from, to) in [
        (0.006_51, 0.0065),
        (0.0065, 0.0065),
        (0.01, 0.01),
        (0.123, 0.12),
    ] {
        assert_eq!(rounded_down(from), to);
    }
}

/// Ratios from catalogues of RV gears, rounded or cut there, and one without a first stage.
#[test]
fn an_rv_gear_from_its_ratio() {
    for (ratio, cranks, off) in [
        (57.0, 2, 1e-9),
        (81.0, 2, 1e-9),
        (105.0, 2, 1e-9),
        (121.0, 3, 1e-9),
        (153.0, 3, 1e-9),
        (31.43, 2, 1e-2),
        (53.5, 2, 1e-9),
        (118.5, 3, 1e-9),
        (127.7, 3, 5e-2),
        (192.42, 3, 1e-2),
    ] {
        let catalogue = Catalogue {
            cranks: Some(cranks),
            ..catalogue(ratio, 128.0)
        };
        let draft = catalogue.draft().unwrap();
        let again = Scene::from_toml(&draft.text, "mine.toml", &[]).unwrap();
        assert_eq!(&*again, &*draft.scene);
        assert!(
            (again.ratio() - ratio).abs() < off,
            "{ratio} {}: {}",
            again.ratio(),
            draft.text
        );
        assert!(again.output_per_input() > 0.0 && again.drive.output_torque_n_m < 0.0);
        assert_eq!(again.gear.internal_sleeves, cranks);
        assert!(again.gear.external_sleeves.is_multiple_of(2));
        // Suggested values are in the file, marked.
        for key in &draft.suggested {
            let name = format!("{} = ", key.rsplit('.').next().unwrap());
            let mut lines = draft.text.lines();
            let line = lines.find(|line| line.starts_with(&name)).unwrap();
            assert!(line.contains("suggested"), "{key}: {line}");
        }
    }
    let prime = Catalogue {
        cranks: Some(2),
        ..catalogue(998, 128.0)
    };
    let error = prime.draft().unwrap_err();
    let tried: f64 = error.remedy.rsplit(' ').next().unwrap().parse().unwrap();
    assert!(first_stage(tried).is_some(), "{error}");
}

/// Standard tolerances of IT6, IT7, IT8 and IT12, um, as printed (rounded) in tables of ISO 286-1.
#[test]
fn published_standard_tolerances() {
    for (size_mm, table) in [
        (3.0, [6.0, 10.0, 14.0, 100.0]),
        (5.0, [8.0, 12.0, 18.0, 120.0]),
        (10.0, [9.0, 15.0, 22.0, 150.0]),
        (18.0, [11.0, 18.0, 27.0, 180.0]),
        (20.0, [13.0, 21.0, 33.0, 210.0]),
        (50.0, [16.0, 25.0, 39.0, 250.0]),
        (100.0, [22.0, 35.0, 54.0, 350.0]),
        (223.0, [29.0, 46.0, 72.0, 460.0]),
    ] {
        for (grade, printed) in [6, 7, 8, 12].into_iter().zip(table) {
            let um = 1e6 * tolerance_m(1e-3 * size_mm, grade);
            assert!(
                (um - printed).abs() <= 0.6 + 0.08 * printed,
                "IT{grade} of {size_mm}: {um}"
            );
        }
    }
}

/// A gear as built: suggested values are in the file, marked; every clearance is an interval from 0 or above, and the study
/// of the tolerances draws the same.
#[test]
fn a_gear_as_built() {
    let steel = |cranks| Catalogue {
        ideal: false,
        cranks,
        ..catalogue(39, 104.0)
    };
    let printed = Catalogue {
        material: MATERIALS[6],
        process: None,
        ..steel(None)
    };
    let rv = Catalogue {
        ratio: 118.5,
        ..steel(Some(2))
    };
    let mut plays = Vec::new();
    for (catalogue, tolerances) in [(steel(None), 3), (printed, 3), (rv, 2)] {
        let draft = catalogue.draft().unwrap();
        let scene = &draft.scene;
        for key in &draft.suggested {
            let name = format!("{} = ", key.rsplit('.').next().unwrap());
            let mut lines = draft.text.lines().filter(|line| line.starts_with(&name));
            assert!(
                lines.any(|line| line.contains("suggested")),
                "{key}: {}",
                draft.text
            );
        }
        assert_eq!(scene.uncertain.len(), tolerances);
        let study = draft.study("mine.toml").unwrap();
        for (key, half) in &scene.uncertain {
            assert!(
                scene
                    .with_number(key, scene.number(key).unwrap() - half.plus_minus)
                    .is_ok(),
                "{key}"
            );
            assert!(
                study.contains(&format!("{key} = {{ plus_minus = {:?} }}", half.plus_minus)),
                "{study}"
            );
        }
        let gear = &scene.gear;
        // Pins that are printed in or pressed in do not turn; their friction stands in the file.
        let is_printed = catalogue.material == MATERIALS[6];
        assert_eq!(gear.external_sleeves_turn, !is_printed, "{}", draft.text);
        assert_eq!(scene.sliding()[0], if is_printed { 0.2 } else { 0.0 });
        let bearing = scene.bearings.eccentric.unwrap();
        assert!(bearing.rollers.unwrap() > 3 && bearing.clearance_m.unwrap() > 0.0);
        assert!(scene.bearings.sleeve_friction_coefficient.is_some());
        plays.push(gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m);
        match catalogue.cranks {
            None => assert!(scene.bearings.internal_sleeve_stiffness_n_m.is_some()),
            Some(_) => assert!(scene.cranks.unwrap().support_stiffness_n_m.is_some()),
        }
    }
    // H6/g5 of 22 mm: 7.2 to 29.2 um across; H12/g11.
    assert!(
        (plays[0] - 9.1e-6).abs() < 1e-6 && plays[1] > 8e-5,
        "{plays:?}"
    );
    // Plastic discs run on steel pins unless stated otherwise.
    let plastic = |pin_material, ideal| Catalogue {
        material: MATERIALS[6],
        pin_material,
        ideal,
        ..catalogue(39, 104.0)
    };
    let pins = |catalogue: Catalogue| catalogue.draft().unwrap().scene.contact.pin_young_pa;
    assert_eq!(pins(plastic(None, false)), Some(2.1e11));
    assert_eq!(pins(plastic(Some(MATERIALS[6]), false)), None);
    assert_eq!(pins(plastic(None, true)), None);
    let one_stage = |ratio: f64| catalogue(ratio, 104.0).draft().unwrap().text;
    assert!(one_stage(64.0).contains("in one stage") && !one_stage(39.0).contains("in one stage"));
    // Given backlash is the clearance of the ring; the load of an RV gear may be given with either sign.
    let given = Catalogue {
        backlash_m: Some(2e-5),
        ..steel(None)
    }
    .draft()
    .unwrap();
    assert_eq!(given.scene.gear.modification.equidistant_m, 0.0);
    let against = Catalogue {
        torque_n_m: -100.0,
        ..steel(Some(2))
    };
    let against = Catalogue {
        ratio: 81.0,
        ..against
    }
    .draft()
    .unwrap();
    assert_eq!(against.scene.drive.output_torque_n_m, -100.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Ratio, size, torque and speed determine a gear; the suggested one can be built and has walls.
    #[test]
    fn four_numbers_make_a_gear(ratio in 5..120_usize, size in 0.5..3.0_f64, ideal in proptest::bool::ANY) {
        let draft = Catalogue { ideal, ..catalogue(ratio as f64, 10_f64.powf(size)) }.draft();
        prop_assert!(draft.is_ok(), "{}", draft.unwrap_err());
        let draft = draft.unwrap();
        let again = Scene::from_toml(&draft.text, "mine.toml", &[]).unwrap();
        prop_assert_eq!(&*again, &*draft.scene);
        let walls = pinwheel_scene::derived(&draft.scene).walls;
        let hole = draft.scene.gear.hole_radius_m;
        prop_assert!(walls.hole_to_profile_m > 0.09 * hole && walls.hole_to_hole_m > 0.09 * hole);
    }
}

/// Holes have walls of 3 % of the pin circle's diameter between them, for any number of pins.
#[test]
fn walls_between_holes_are_sound() {
    for (ratio, diameter_mm) in [(19, 60.0), (39, 104.0), (87, 250.0)] {
        let scene = catalogue(ratio, diameter_mm).draft().unwrap().scene;
        let wall = derived(&scene).walls.hole_to_hole_m;
        assert!(wall >= 0.03 * 1e-3 * diameter_mm, "{ratio}: {wall}");
    }
}
