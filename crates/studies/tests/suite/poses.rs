//! Poses at which a gear is balanced.

use pinwheel_scene::Scene;
use pinwheel_studies::internals::{MOST, MOST_OF_ALL, Poses};

/// However many passages there are until parts with errors meet again, poses are bounded; too few for the harmonics of a mesh
/// they tell none.
#[test]
fn regress_poses_are_bounded() {
    let mut scene = Scene::paper();
    let plain = Poses::of(&scene);
    assert!(plain.has_harmonics() && plain.angles.len() < 2 * MOST);
    scene.gear.external_sleeves = 400;
    assert!(Poses::of(&scene).has_harmonics());
    scene.gear.errors.external_sleeve_radial_m = vec![1e-6; 400];
    let large = Poses::of(&scene);
    let count = large.angles.len();
    assert!(count < MOST_OF_ALL + MOST, "{count}: there were 640 000");
    assert!(!large.has_harmonics());
}

/// Every pose once, and of a gear of 40 pins and 8 output pins both meshes move by a twentieth at most from one to the next.
#[test]
fn a_walk_meets_every_pose_and_moves_little() {
    let mut scene = Scene::paper();
    (scene.gear.external_sleeves, scene.gear.internal_sleeves) = (40, 8);
    let poses = Poses::of(&scene).few(24);
    let (walk, count) = (poses.walk().collect::<Vec<_>>(), poses.angles.len());
    let mut all = walk.clone();
    all.sort_unstable();
    assert!(all.into_iter().eq(0..count));
    for pair in walk.windows(2) {
        for mesh in poses.meshes {
            let moved = (pair[1] + count - pair[0]) * mesh % count;
            assert!(
                moved.min(count - moved) * 20 <= count,
                "{pair:?} of {count}"
            );
        }
    }
}
