//! Runs of a sweep.

use std::path::Path;

use pinwheel_studies::internals::in_words;
use pinwheel_studies::sweep::{Plan, Sweep};

fn plan(text: &str) -> Result<Plan, String> {
    let scene = if text.contains("scene") {
        ""
    } else {
        "scene = \"paper\"\n"
    };
    let text = format!("{scene}{text}");
    let sweep = Sweep::from_toml(&text, Path::new("mine.toml")).unwrap();
    Plan::new(sweep, &[]).map_err(|error| error.to_string())
}

#[test]
fn every_combination_in_order() {
    let plan = plan(
        "engines = [\"native-reduced\", \"native-lagrange\"]\n[vary]\ngear.backlash_m = [0.0, 1e-4]\n\
         contact.law = [\"paper\", \"constant\"]\n[[together]]\ngear.wheels = [1, 2]\ndrive.output_torque_n_m = [11.0, 22.0]\n",
    )
    .unwrap();
    assert_eq!(plan.len(), 16);
    let run = |k: usize| plan.run(k).unwrap();
    assert!((0..16).all(|k| run(k).number == k + 1));
    let third = run(2);
    assert_eq!(third.engine.name(), "native-reduced");
    assert_eq!(
        (third.scene.gear.wheels, third.scene.drive.output_torque_n_m),
        (2, 22.0)
    );
    assert_eq!(
        in_words(&third.values),
        "gear.backlash_m = 0, contact.law = paper, gear.wheels = 2, drive.output_torque_n_m = 22"
    );
    assert_eq!(run(4).scene.contact.law, "constant");
    assert_eq!(run(8).scene.gear.backlash_m, 1e-4);
    assert_eq!(plan.keys().count(), 4);
}

#[test]
fn faults_name_the_run() {
    for (text, part) in [
        ("[vary]\ngear.wheels = [1, 0]", "run 2 (gear.wheels = 0): "),
        (
            "[vary]\ngear.bcklash_m = [0.0]",
            "did you mean `gear.backlash_m`?",
        ),
        (
            "engines = [\"native-reducd\"]",
            "did you mean `native-reduced`?",
        ),
        (
            "window_s = [0.1, 0.7]",
            "run 1 (the scene as it is): window_s ends at 0.7 s",
        ),
        ("scene = \"papr\"", "did you mean the preset `paper`?"),
        (
            "[vary]\ngear.backlash_m = { from = 0.0, to = 1e-3, points = 1000 }\ncontact.damping_n_s_m = { from = 1.0, to = 9.0, points = 1000 }",
            "1000 x 1000 x 1 runs, more than 100000",
        ),
    ] {
        let line = plan(text).unwrap_err();
        assert!(
            line.contains(part) && !line.contains('\n'),
            "{text}: {line}"
        );
    }
}
