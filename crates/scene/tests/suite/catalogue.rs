//! Gears of a catalogue, and what is refused.

use proptest::prelude::*;

use pinwheel_scene::catalogue::*;
use pinwheel_scene::{Scene, derived};

/// Catalogue of a gear of steel, with a load that goes with its size; all else is left out.
pub(crate) fn catalogue(ratio: impl Into<f64>, diameter_mm: f64) -> Catalogue {
    Catalogue {
        name: "mine".to_owned(),
        ratio: ratio.into(),
        cranks: None,
        pin_circle_diameter_m: 1e-3 * diameter_mm,
        torque_n_m: 100.0 * (diameter_mm / 130.0).powi(3),
        speed_rad_s: 157.0,
        material: MATERIALS[0],
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
    let said = crossing.draft().unwrap_err().to_string();
    assert!(said.contains("less than 1.3 mm"), "{said}");
    let full = Catalogue {
        output_pin_diameter_m: Some(0.08),
        ..catalogue(39, 104.0)
    };
    let said = full.draft().unwrap_err().to_string();
    assert!(said.contains("finds no place"), "{said}");
    // A fault of the scene is in its key's name and unit, not under a diameter's.
    let overlapping = Catalogue {
        pin_diameter_m: Some(0.012),
        ..catalogue(39, 100.0)
    };
    let said = overlapping.draft().unwrap_err().to_string();
    assert!(
        said.contains("gives a scene whose gear.external_sleeve_radius_m is 0.006 m"),
        "{said}"
    );
    let said = catalogue(118.5, 128.0).draft().unwrap_err().to_string();
    assert!(said.contains("give 118 or 119"), "{said}");
    let with_pins = Catalogue {
        cranks: Some(2),
        output_pins: Some(6),
        ..catalogue(81, 128.0)
    };
    let said = with_pins.draft().unwrap_err().to_string();
    assert!(said.contains("one eccentric"), "{said}");
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

/// Ratios of catalogues of RV gears, and one that no first stage makes. Those with decimals are rounded or cut there.
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
        // What is said to be suggested stands in the file, marked.
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
    let said = prime.draft().unwrap_err();
    let tried: f64 = said.remedy.rsplit(' ').next().unwrap().parse().unwrap();
    assert!(first_stage(tried).is_some(), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Ratio, size, torque and speed are enough for any gear; the suggested one can be built and has walls.
    #[test]
    fn four_numbers_make_a_gear(ratio in 5..120_usize, size in 0.5..3.0_f64) {
        let draft = catalogue(ratio as f64, 10_f64.powf(size)).draft();
        prop_assert!(draft.is_ok(), "{}", draft.unwrap_err());
        let draft = draft.unwrap();
        let again = Scene::from_toml(&draft.text, "mine.toml", &[]).unwrap();
        prop_assert_eq!(&*again, &*draft.scene);
        let walls = pinwheel_scene::derived(&draft.scene).walls;
        let hole = draft.scene.gear.hole_radius_m;
        prop_assert!(walls.hole_to_profile_m > 0.09 * hole && walls.hole_to_hole_m > 0.09 * hole);
    }
}

/// Holes leave 3 % of the pin circle's diameter between them, whatever the number of pins.
#[test]
fn walls_between_holes_are_sound() {
    for (ratio, diameter_mm) in [(19, 60.0), (39, 104.0), (87, 250.0)] {
        let scene = catalogue(ratio, diameter_mm).draft().unwrap().scene;
        let wall = derived(&scene).walls.hole_to_hole_m;
        assert!(wall >= 0.03 * 1e-3 * diameter_mm, "{ratio}: {wall}");
    }
}
