//! Settings that a method is tried with.

use pinwheel_engines::AccuracySetting;
use pinwheel_scene::Scene;
use pinwheel_studies::internals::settings;

#[test]
fn steps_halve_and_divide_the_samples() {
    let scene = Scene::paper();
    let steps = settings(AccuracySetting::Step, &scene);
    assert!(steps.contains(&scene.solver.step_s), "{steps:?}");
    for pair in steps.windows(2) {
        assert!((1.5..2.6).contains(&(pair[0] / pair[1])), "{pair:?}");
    }
    for step in steps {
        let parts = scene.solver.sample_s / step;
        assert!((parts - parts.round()).abs() < 1e-9, "{step}");
    }
}

#[test]
fn tolerances_fall_by_half_decades() {
    let tolerances = settings(AccuracySetting::Tolerance, &Scene::paper());
    assert_eq!(tolerances[0], 1e-2);
    assert_eq!((tolerances[1], tolerances[16]), (3.2e-3, 1e-10));
}
