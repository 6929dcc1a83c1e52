//! A user's gear takes no values from the published one unless the scene requests them.

use pinwheel_scene::{Scene, Source, Start};

/// Forty pins, e = 0.75 mm, a pin circle of 52 mm, real steel, 200 N m.
const OWN: &str = "\
[gear]
eccentricity_m = 0.00075
external_sleeves = 40
pin_circle_radius_m = 0.052
external_sleeve_radius_m = 0.002
internal_sleeves = 10
internal_sleeve_radius_m = 0.004
internal_circle_radius_m = 0.032
wheels = 2
[drive]
input_speed_rad_s = 100.0
output_torque_n_m = 200.0
";

fn refused(text: &str) -> String {
    Scene::from_toml(text, "mine.toml", &[])
        .unwrap_err()
        .to_string()
}

#[test]
fn omitted_keys_are_derived_and_reported() {
    let scene = Scene::from_toml(OWN, "mine.toml", &[]).unwrap();
    assert!((scene.gear.shortening - 0.75 * 40.0 / 52.0).abs() < 1e-15);
    assert!((scene.gear.hole_radius_m - 0.00475).abs() < 1e-18);
    assert_eq!(scene.contact.law, "line-hertz");
    assert_eq!(scene.contact.stiffness_multiplier, 1.0);
    assert_eq!(scene.solver.integrator, "auto");
    assert_eq!(scene.drive.start, Start::Kinematic);
    // A disc of steel 7.8 mm thick and about 100 mm across weighs some hundred grams.
    assert!(
        (0.2..0.6).contains(&scene.mass.wheel.mass_kg),
        "{:?}",
        scene.mass.wheel
    );
    let origins = scene.origins();
    let of = |key: &str| origins.iter().find(|origin| origin.key == key);
    assert!(
        matches!(of("gear.hole_radius_m").unwrap().source, Source::Formula(text) if text.contains("eccentricity"))
    );
    assert!(matches!(
        of("contact.young_pa").unwrap().source,
        Source::Constant("steel")
    ));
    assert!(of("gear.wheels").is_none(), "it is written");
    // Every key is written or listed with its origin.
    let written = Scene::from_toml(&scene.to_toml(), "again.toml", &[]).unwrap();
    assert_eq!(*written, *scene);
    assert!(written.origins().is_empty());
    // Samples are on steps and end with the run.
    let solver = &scene.solver;
    for ratio in [
        solver.sample_s / solver.step_s,
        solver.duration_s / solver.sample_s,
    ] {
        assert!((ratio - ratio.round()).abs() < 1e-9 * ratio, "{ratio}");
    }
}

#[test]
fn an_empty_file_names_what_it_lacks() {
    let line = refused("");
    for part in [
        "gear.eccentricity_m",
        "gear.wheels",
        "drive.output_torque_n_m",
        "base = \"paper\"",
    ] {
        assert!(line.contains(part), "{line}");
    }
    assert!(!line.contains("gear.backlash_m"), "{line}");
    let line = refused(&OWN.replace("wheels = 2\n", ""));
    assert!(line.contains("gives no `gear.wheels`;"), "{line}");
}

#[test]
fn a_base_gives_what_is_left_out() {
    let scene =
        Scene::from_toml("base = \"steel\"\n[gear]\nwheels = 1\n", "mine.toml", &[]).unwrap();
    assert_eq!(
        (scene.name.as_str(), scene.description.as_str()),
        ("mine", "")
    );
    let mut wanted = Scene::load("steel", &[]).unwrap().into_scene();
    wanted.gear.wheels = 1;
    wanted.name = "mine".to_owned();
    wanted.description.clear();
    assert_eq!(*scene, wanted);
    let origins = scene.origins();
    let hole = origins
        .iter()
        .find(|origin| origin.key == "gear.hole_radius_m");
    assert_eq!(hole.unwrap().source, Source::Base("steel".to_owned()));
    assert!(origins.iter().all(|origin| origin.key != "gear.wheels"));
    for (text, part) in [
        ("base = 3", "must be text"),
        ("base = \"papr\"", "did you mean the preset `paper`?"),
    ] {
        let line = refused(text);
        assert!(line.contains(part), "{line}");
    }
}

#[test]
fn a_base_beside_the_file_may_have_one_itself_but_not_in_a_circle() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    write(
        "first.toml",
        "base = \"paper\"\n[gear]\nbacklash_m = 1e-4\n",
    );
    let second = write("second.toml", "base = \"first.toml\"\n[gear]\nwheels = 1\n");
    let scene = Scene::load(&second, &[]).unwrap();
    assert_eq!((scene.gear.backlash_m, scene.gear.wheels), (1e-4, 1));
    let circle = write("circle.toml", "base = \"circle.toml\"\n");
    let line = Scene::load(&circle, &[]).unwrap_err().to_string();
    assert!(line.contains("bases deep"), "{line}");
    // A fault of the base is placed there.
    write("bad.toml", "base = \"paper\"\n[gear]\nwheels = 0\n");
    let bad = write("worse.toml", "base = \"bad.toml\"\n");
    let line = Scene::load(&bad, &[]).unwrap_err().to_string();
    assert!(line.contains("bad.toml, line 3"), "{line}");
}

#[test]
fn millimetres_are_detected() {
    for (typed, meant) in [
        ("eccentricity_m = 0.00075", "0.75"),
        ("internal_sleeve_radius_m = 0.004", "4"),
        ("internal_circle_radius_m = 0.032", "32"),
        ("external_sleeve_radius_m = 0.002", "2"),
    ] {
        let (key, value) = typed.split_once(" = ").unwrap();
        let line = refused(&OWN.replace(typed, &format!("{key} = {meant}")));
        assert!(
            line.contains(&format!("`gear.{key}`"))
                && line.contains(&format!("did you mean {value}?")),
            "{line}"
        );
    }
    let line = refused(&OWN.replace("pin_circle_radius_m", "ring_radius_m"));
    assert!(
        line.contains("gear.pin_circle_radius_m") && line.contains("0.030000"),
        "{line}"
    );
    let line = refused(&OWN.replace("wheels = 2", "wheels = 2\nshortening = 0.6"));
    assert!(line.contains("both given"), "{line}");
}

/// A stated circle of the pins replaces the shortening coefficient of the base, and vice versa.
#[test]
fn what_follows_from_a_stated_key_is_not_inherited() {
    let circle =
        "[gear]\nexternal_sleeves = 7\npin_circle_radius_m = 0.06\neccentricity_m = 0.001\n";
    let text = format!("base = \"paper\"\n{circle}");
    let scene = Scene::from_toml(&text, "mine.toml", &[]).unwrap();
    assert_eq!(scene.gear.shortening, 0.001 * 7.0 / 0.06);
    let dir = tempfile::tempdir().unwrap();
    let base = dir.path().join("base.toml").display().to_string();
    std::fs::write(&base, OWN).unwrap();
    let text = format!("base = {base:?}\n[gear]\nshortening = 0.6\n");
    assert_eq!(
        Scene::from_toml(&text, "mine.toml", &[])
            .unwrap()
            .gear
            .shortening,
        0.6
    );
}

/// The parameters of a law are filled in before ramp and damping, which depend on the law: a scene that states the
/// filled-in value is equal.
#[test]
fn regress_ramps_follow_from_the_law_as_filled_in() {
    for law in ["constant", "adams-impact", "line-contact", "line-hertz"] {
        let text = format!("{OWN}[contact]\nlaw = \"{law}\"\n");
        let filled = Scene::from_toml(&text, "mine.toml", &[])
            .unwrap()
            .contact
            .clone();
        let stated = format!(
            "{text}constant_stiffness_n_m15 = {:e}\nline_length_m = {:e}\n",
            filled.constant_stiffness_n_m15, filled.line_length_m
        );
        let stated = Scene::from_toml(&stated, "mine.toml", &[])
            .unwrap()
            .contact
            .clone();
        assert_eq!(stated, filled, "{law}");
        assert!(filled.ramp_m < 2e-6, "{law}: {}", filled.ramp_m);
    }
}
