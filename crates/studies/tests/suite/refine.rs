//! Levels of a refinement study.

use pinwheel_engines::Native;
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::preset;
use pinwheel_studies::internals::Refiner;

/// No level exceeds the sample spacing, because engines end a step at every sample. Longer steps once gave three identical runs,
/// which passed for agreement to rounding.
#[test]
fn regress_no_level_is_longer_than_the_samples_are_apart() {
    let scene = preset("paper").expect("a preset");
    let scene = pinwheel_scene::Scene::from_toml(scene, "paper", &[]).expect("a scene");
    let gearbox = Gearbox::new(&scene).expect("a gear");
    assert_eq!(gearbox.scene.solver.sample_s, 1e-4);
    let mut engines = Refiner::of(&Native::REDUCED, gearbox).expect("a way to refine it");
    for (step, longer) in [
        (1e-4, &[][..]),
        (5e-5, &[1e-4]),
        (4e-5, &[8e-5]),
        (2.5e-5, &[5e-5, 1e-4]),
        (1e-5, &[2e-5, 1e-4 / 3.0]),
    ] {
        let levels = engines.coarser(step);
        assert_eq!(levels.len(), longer.len(), "{step}: {levels:?}");
        let near = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-12;
        assert!(levels.iter().zip(longer).all(near), "{step}: {levels:?}");
    }
    engines.value = 1e-4;
    engines.leave_room();
    assert_eq!(engines.value, 2.5e-5);
}
