//! Scenes and solvers of the baseline.

use std::collections::BTreeSet;

use pinwheel_mbs::integrators::METHODS;
use pinwheel_studies::baseline::scenes;
use pinwheel_studies::internals::sets;

#[test]
fn the_set_is_sound() {
    let mut names = BTreeSet::new();
    assert!(scenes().len() > 40, "the set can be read");
    for case in scenes() {
        assert!(names.insert(&case.name), "{} twice", case.name);
        let mut choices = BTreeSet::new();
        for choice in &case.choices {
            assert!(choices.insert(choice), "{choice} twice in {}", case.name);
            let scene = case.scene(sets(choice)).unwrap();
            assert!(choice.contains(&scene.solver.integrator), "{choice}");
        }
    }
}

/// Every hard preset is in the baseline, unless listed as left out.
#[test]
fn every_hard_case_that_holds_is_in_the_set() {
    let left_out = [
        "hard-feather-sleeves",
        "hard-long-run",
        "hard-zero-load",
        "hard-zero-load-friction",
    ];
    for preset in pinwheel_scene::PRESETS {
        let hard = preset.name.starts_with("hard-") && !left_out.contains(&preset.name);
        let watched = scenes().iter().any(|case| case.preset() == preset.name);
        assert_eq!(
            hard,
            watched && preset.name.starts_with("hard-"),
            "{}",
            preset.name
        );
    }
}

/// Every integration method is in the baseline.
#[test]
fn every_method_is_in_the_set() {
    let mut used = BTreeSet::new();
    for case in scenes() {
        for choice in &case.choices {
            let scene = case.scene(sets(choice)).unwrap();
            used.insert(scene.solver.integrator.clone());
        }
    }
    for method in METHODS {
        assert!(
            used.contains(method.name),
            "no scene runs by {}; add one",
            method.name
        );
    }
}
