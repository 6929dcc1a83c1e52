//! Steps and samples of rapier.

use pinwheel_engines::rapier::march::*;
use pinwheel_scene::Scene;

fn scene(step_s: f64, sample_s: f64, duration_s: f64) -> Scene {
    let mut scene = Scene::paper();
    (
        scene.solver.step_s,
        scene.solver.sample_s,
        scene.solver.duration_s,
    ) = (step_s, sample_s, duration_s);
    scene
}

#[test]
fn every_sample_is_a_node() {
    let grid = Grid::new(&scene(1e-5, 1e-4, 1.05e-3), 1e-5).unwrap();
    let nodes: Vec<u64> = grid.samples.iter().map(|sample| sample.0).collect();
    assert_eq!(nodes, [0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 105]);
    assert_eq!(grid.samples.last().unwrap().1, 1.05e-3);
}

#[test]
fn uneven_steps_are_refused_with_the_key() {
    let sampling = Grid::new(&scene(3e-5, 1e-4, 0.1), 3e-5)
        .unwrap_err()
        .to_string();
    assert!(sampling.contains("solver.sample_s"), "{sampling}");
    let duration = Grid::new(&scene(1e-5, 1e-4, 1.234e-3 + 3e-6), 1e-5)
        .unwrap_err()
        .to_string();
    assert!(duration.contains("solver.duration_s"), "{duration}");
    let long = Grid::new(&scene(1e-3, 1e-4, 0.1), 1e-3)
        .unwrap_err()
        .to_string();
    assert!(long.contains("solver.sample_s"), "{long}");
}
