//! Presets are valid, described, complete and equal to the paper's data.

use pinwheel_scene::{Detection, PRESETS, Scene, derived};

fn load(name: &str) -> Scene {
    let scene = Scene::load(name, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene.into_scene()
}

#[test]
fn every_preset_loads_under_its_own_name_and_says_why_it_exists() {
    for preset in PRESETS {
        let scene = load(preset.name);
        assert_eq!(scene.name, preset.name);
        assert!(scene.description.ends_with('.'), "{}", preset.name);
    }
}

#[test]
fn every_scene_file_is_embedded() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../reference/scenes");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    let mut embedded: Vec<String> = PRESETS.iter().map(|p| p.name.to_owned()).collect();
    files.sort();
    embedded.sort();
    assert_eq!(files, embedded);
}

#[test]
fn the_paper_is_its_preset() {
    assert_eq!(load("paper"), Scene::paper());
}

/// paper.toml, often copied, has every key.
#[test]
fn paper_shows_every_key() {
    let paper: toml::Table = pinwheel_scene::preset("paper").unwrap().parse().unwrap();
    let full: toml::Table = load("paper").to_toml().parse().unwrap();
    assert_eq!(paper, full);
}

#[test]
fn to_toml_round_trips_to_the_last_bit() {
    for preset in PRESETS {
        let mut scene = load(preset.name);
        scene.drive.input_speed_rad_s = 1.0 / 3.0 * 157.079_632_679_489_67;
        let text = scene.to_toml();
        let again = Scene::from_toml(&text, "again.toml", &[]).unwrap();
        assert_eq!(*again, scene);
        assert_eq!(*Scene::from_complete(&text).unwrap(), scene);
    }
    let text = Scene::paper().to_toml();
    for (from, to, key) in [
        ("wheels = 2", "wheels = 0", "gear.wheels"),
        ("wheels = 2", "weels = 2", "line"),
        ("backlash_m = 0.0", "backlash_m = 0.1", "gear.backlash_m"),
    ] {
        let error = Scene::from_complete(&text.replace(from, to)).unwrap_err();
        assert!(error.to_string().contains(key), "{error}");
    }
}

#[test]
fn presets_differ_as_they_say() {
    let gear = load("paper-2019").gear;
    assert_eq!(
        (
            gear.internal_sleeve_radius_m,
            gear.hole_radius_m,
            gear.internal_circle_radius_m
        ),
        (0.005, 0.0078, 0.030)
    );
    assert_eq!(load("paper-friction").contact.friction_coefficient, 0.1);
    for (name, wheel, hole) in [("paper-rough", 600, 20), ("paper-refined", 4000, 100)] {
        let contact = load(name).contact;
        assert_eq!(contact.detection, Detection::Points);
        assert_eq!((contact.wheel_points, contact.hole_points), (wheel, hole));
    }
    assert_eq!(load("backlash-0.6").gear.backlash_m, 0.6e-3);
    assert_eq!(load("steel").contact.stiffness_multiplier, 1.0);
    assert_eq!(load("one-wheel").gear.wheels, 1);
    let mass = load("paper-geometric").mass;
    // The radius of gyration stated in its comments.
    let gyration = (mass.wheel.moment_kg_m2 / mass.wheel.mass_kg).sqrt();
    assert!((gyration - 0.044_45).abs() < 5e-6, "{gyration}");
}

/// Loads of the other gears: a third of the paper's force on a ring pin, as stated in their comments.
#[test]
fn other_gears_are_lightly_loaded() {
    let paper = derived(&load("paper")).external_force_estimate_n;
    for name in ["eleven-pins", "forty-pins"] {
        let share = derived(&load(name)).external_force_estimate_n / paper;
        assert!((0.3..0.36).contains(&share), "{name}: {share}");
    }
}
