//! `drive.load_changes`: accepted and refused lists, and unchanged results of scenes without it.

use proptest::prelude::*;

use pinwheel_scene::{CheckedScene, LoadChange, Override, Scene};
use pinwheel_scene::{load_profile, speed_profile};

fn with(changes: &str) -> Result<CheckedScene, String> {
    let set = Override::new("drive.load_changes", changes);
    Scene::load("paper", &[set]).map_err(|error| error.to_string())
}

#[test]
fn every_form_is_understood() {
    let wanted = [
        LoadChange {
            time_s: 0.1,
            output_torque_n_m: -22.0,
            ramp_s: 0.0,
        },
        LoadChange {
            time_s: 0.25,
            output_torque_n_m: 44.0,
            ramp_s: 0.05,
        },
    ];
    let inline = "[{ time_s = 0.1, output_torque_n_m = -22 }, { time_s = 0.25, output_torque_n_m = 44.0, ramp_s = 0.05 }]";
    assert_eq!(with(inline).unwrap().drive.load_changes, wanted);
    let tables = "base = \"paper\"\n[drive]\nload_ramp_s = 0.01\n[[drive.load_changes]]\ntime_s = 0.1\noutput_torque_n_m = -22\n\
                  [[drive.load_changes]]\ntime_s = 0.25\noutput_torque_n_m = 44.0\nramp_s = 0.05\n[solver]\nstep_s = 2e-5\n";
    let scene = Scene::from_toml(tables, "mine.toml", &[]).unwrap();
    assert_eq!(scene.drive.load_changes, wanted);
    let again = Scene::from_toml(&scene.to_toml(), "again.toml", &[]).unwrap();
    assert_eq!(again, scene);
    // A list on the command line replaces the file's, and may be empty.
    let none = [Override::new("drive.load_changes", "[]")];
    let scene = Scene::from_toml(tables, "mine.toml", &none).unwrap();
    assert!(scene.drive.load_changes.is_empty());
    assert!(!scene.to_toml().contains("load_changes"));
}

#[test]
fn what_is_wrong_is_named_with_its_entry() {
    for (changes, key, part) in [
        ("3", "", "a list of tables"),
        ("[1]", "", "a list of tables"),
        ("[{ output_torque_n_m = 1 }]", "[0].time_s", "is missing"),
        ("[{ time_s = 0.1 }]", "[0].output_torque_n_m", "is missing"),
        (
            "[{ time = 0.1, output_torque_n_m = 1 }]",
            "[0].time",
            "did you mean",
        ),
        (
            "[{ time_s = \"0.1\", output_torque_n_m = 1 }]",
            "[0].time_s",
            "must be a number",
        ),
        (
            "[{ time_s = 0, output_torque_n_m = 1 }]",
            "[0].time_s",
            "is 0 s",
        ),
        (
            "[{ time_s = nan, output_torque_n_m = 1 }]",
            "[0].time_s",
            "NaN",
        ),
        (
            "[{ time_s = 0.1, output_torque_n_m = inf }]",
            "[0].output_torque_n_m",
            "inf",
        ),
        (
            "[{ time_s = 0.1, output_torque_n_m = 1, ramp_s = -1 }]",
            "[0].ramp_s",
            "is -1 s",
        ),
        (
            "[{ time_s = 0.1, output_torque_n_m = 1, ramp_s = 1e-12 }]",
            "[0].ramp_s",
            "give 0",
        ),
        (
            "[{ time_s = 0.1, output_torque_n_m = 1 }, { time_s = 0.1, output_torque_n_m = 2 }]",
            "[1].time_s",
            "order",
        ),
        (
            "[{ time_s = 0.1, output_torque_n_m = 1, ramp_s = 0.11 }, { time_s = 0.2, output_torque_n_m = 2 }]",
            "[0].ramp_s",
            "not over when the next begins",
        ),
    ] {
        let line = with(changes).unwrap_err();
        let named = format!("`drive.load_changes{key}` ");
        assert!(line.contains(&named) && line.contains(part), "{line}");
        assert!(line.contains("; ") && !line.contains('\n'), "{line}");
    }
    let text = "base = \"paper\"\n[drive]\nload_ramp_s = 0.2\nload_changes = [\n  { time_s = 0.1, output_torque_n_m = 1 },\n]\n";
    let line = Scene::from_toml(text, "mine.toml", &[])
        .unwrap_err()
        .to_string();
    assert!(
        line.starts_with("mine.toml, line 5: `drive.load_changes[0].time_s`"),
        "{line}"
    );
    let many: Vec<String> = (1..=1001)
        .map(|k| format!("{{ time_s = {k}, output_torque_n_m = 1 }}"))
        .collect();
    let line = with(&format!("[{}]", many.join(","))).unwrap_err();
    assert!(line.contains("1001 changes"), "{line}");
}

/// Ramps of the speed are continuous in angle and speed; a ramp without duration is refused.
#[test]
fn bad_input_changes_of_the_speed() {
    let with = |list: &str| {
        let set = Override::new("drive.speed_changes", list);
        Scene::load("paper", &[set]).map_err(|error| error.to_string())
    };
    let scene = with(
        "[{ time_s = 0.1, input_speed_rad_s = 80, ramp_s = 0.02 }, { time_s = 0.2, input_speed_rad_s = -10, ramp_s = 0.1 }]",
    );
    let drive = &scene.as_ref().unwrap().drive;
    assert_eq!(
        load_profile::breaks(drive),
        [0.1, 0.12000000000000001, 0.2, 0.30000000000000004]
    );
    assert_eq!(speed_profile::fastest_rad_s(drive), 80.0);
    assert_eq!(speed_profile::final_rad_s(scene.as_ref().unwrap()), -10.0);
    for pair in speed_profile::motions(drive).windows(2) {
        let (before, after) = (pair[0].at(pair[1].from_s), pair[1]);
        assert!((before.0 - after.angle).abs() < 1e-12 && (before.1 - after.rate).abs() < 1e-12);
    }
    for (list, key, part) in [
        (
            "[{ time_s = 0.1, input_speed_rad_s = 80 }]",
            "[0].ramp_s",
            "is missing",
        ),
        (
            "[{ time_s = 0.1, input_speed_rad_s = 80, ramp_s = 0 }]",
            "[0].ramp_s",
            "infinite torque",
        ),
        (
            "[{ time_s = 0.1, input_speed_rad_s = 80, ramp_s = 0.2 }, { time_s = 0.2, input_speed_rad_s = 1, ramp_s = 0.1 }]",
            "[0].ramp_s",
            "give at most",
        ),
    ] {
        let line = with(list).unwrap_err();
        assert!(
            line.contains(&format!("`drive.speed_changes{key}` ")) && line.contains(part),
            "{line}"
        );
    }
}

#[test]
fn bad_input_own_profiles() {
    for (sets, part) in [
        (&["points_m=[0.0, 1e-6]"][..], "3 to 1000 points"),
        (
            &["points_m=[0.0, 1e-6, 0.0]", "cos_m=[1e-6]"],
            "give one of both",
        ),
        (&["cos_m=[2.0]"], "from -1 to 1"),
        (&["cos_m=[2e-3]"], "another gear"),
        (&["sin_m=[0, 0, 0, 0, 1.2e-4]"], "gentler"),
    ] {
        let set = |text: &&str| {
            format!("gear.modification.normal_m.{text}")
                .parse()
                .unwrap()
        };
        let sets: Vec<Override> = sets.iter().map(set).collect();
        let line = Scene::load("paper", &sets)
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(
            line.contains("gear.modification.normal_m") && line.contains(part),
            "{line}"
        );
    }
}

/// A key of a gear beyond the model gives a line with the available alternative.
#[test]
fn bad_input_gears_beyond_the_model() {
    for (set, part) in [
        ("gear.lobes=14", "give these as gear.external_sleeves"),
        ("gear.ring_lobes=17", "two lobes less are not modelled"),
        ("gear.hypotrochoid=true", "not a ring with a hypotrochoid"),
        ("gear.stages=2", "a scene of its own"),
        ("gear.second_stage_ratio=8", "a scene of its own"),
        ("gear.involute=true", "no involute stage"),
        ("cranks.ring_teeth=40", "cranks.planet_teeth"),
        ("cranks.sun_tooth=12", "did you mean `cranks.sun_teeth`"),
    ] {
        let line = Scene::load("paper", &[set.parse().unwrap()])
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(line.contains(part) && !line.contains('\n'), "{line}");
    }
}

/// A shorter run of a scene is no fault; the scene names the changes after its end.
#[test]
fn changes_after_the_end_are_reported() {
    let scene =
        with("[{ time_s = 0.1, output_torque_n_m = 1 }, { time_s = 0.7, output_torque_n_m = 2 }]")
            .unwrap();
    let message = load_profile::unreached(&scene).unwrap();
    assert!(
        message.starts_with("1 of 2 changes") && message.contains("0.7 s"),
        "{message}"
    );
    assert_eq!(load_profile::final_load(&scene), 1.0);
    assert_eq!(load_profile::last_change_s(&scene), Some(0.1));
    assert_eq!(load_profile::unreached(&Scene::paper()), None);
}

#[test]
fn a_scene_without_changes_is_written_as_it_was() {
    assert!(!Scene::paper().to_toml().contains("load_changes"));
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), 0.0..0.7_f64, Just(0.1), Just(0.3)]
}

proptest! {
    /// Any list is refused in one line, or gives a valid load.
    #[test]
    fn any_list_is_refused_or_can_be_followed(
        list in prop::collection::vec((number(), number(), number()), 0..6),
        load_ramp_s in prop_oneof![Just(0.0), 0.0..0.2_f64],
    ) {
        let mut scene = Scene::paper();
        scene.drive.load_ramp_s = load_ramp_s;
        scene.drive.load_changes = list
            .into_iter()
            .map(|(time_s, output_torque_n_m, ramp_s)| LoadChange { time_s, output_torque_n_m, ramp_s })
            .collect();
        match scene.check() {
            Err(fault) => prop_assert!(fault.to_string().contains("drive.load_changes")),
            Ok(scene) => {
                let breaks = load_profile::breaks(&scene.drive);
                prop_assert!(breaks.windows(2).all(|pair| pair[1] - pair[0] > 0.4e-9), "{breaks:?}");
                for t in breaks.into_iter().chain([0.0, 0.2, 1.0]) {
                    prop_assert!(load_profile::piece_at(&scene.drive, t).torque(t).is_finite());
                    prop_assert!(load_profile::mean(&scene.drive, t, t + 1e-5).is_finite());
                }
                let again = Scene::from_toml(&scene.to_toml(), "again.toml", &[]).unwrap();
                prop_assert_eq!(&again.drive, &scene.drive);
            }
        }
    }

    #[test]
    fn garbage_for_the_list_never_panics(text in "[\\[\\]{}a-z_=, 0-9.\\-\"]{0,80}") {
        let _ = with(&text);
        let _ = Scene::from_toml(&format!("[drive]\nload_changes = {text}\n"), "mine.toml", &[]);
    }
}
