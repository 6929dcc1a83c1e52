//! Outlines of colliders.

use pinwheel_engines::rapier::colliders::*;
use pinwheel_scene::Scene;

/// A gear without load has contacts of zero depth: its outlines have the usual corners, and nothing is refused.
#[test]
fn hard_outlines_without_a_load() {
    let mut scene = Scene::paper();
    let loaded = Corners::of(&scene, [1e6; 2]).unwrap();
    scene.drive.output_torque_n_m = 0.0;
    let unloaded = Corners::of(&scene, [1e6; 2]).unwrap();
    assert_eq!((unloaded.wheel, unloaded.hole), (EDGE_POINTS, HOLE_POINTS));
    assert!(loaded.wheel >= unloaded.wheel);
    // Under a load with a tiny penetration the polygon limits the accuracy.
    scene.drive.output_torque_n_m = 22.0;
    let refused = Corners::of(&scene, [1e11; 2]).unwrap_err();
    assert!(refused.contains("limited by its polygon"), "{refused}");
}
