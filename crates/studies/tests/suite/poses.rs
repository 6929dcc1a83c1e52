//! Poses at which equilibria are computed.

use std::f64::consts::TAU;

use pinwheel_scene::Scene;
use pinwheel_studies::internals::{MOST, MOST_OF_ALL, Poses, resampled, resolves};

/// The number of poses is bounded for any number of mesh passages until parts with errors meet again. Too few poses give no
/// harmonics.
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

/// A walk visits every pose once. With 40 ring pins and 8 output pins both meshes move by at most a twentieth between poses.
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

/// For 39 and 8 passages in a period, 49 poses give every harmonic up to the fourth order, where two per cycle would be 312. With 55
/// poses the ring's first harmonic is an alias of the output pins' second.
#[test]
fn few_poses_give_the_harmonics_of_both_meshes() {
    let base = [39, 8];
    let harmonics = [
        (39.0, 1.0),
        (8.0, 0.7),
        (16.0, -0.4),
        (31.0, 0.2),
        (156.0, 0.1),
    ];
    let at = |share: f64| -> f64 {
        let waves = harmonics.iter().enumerate();
        waves
            .map(|(k, (f, a))| a * (TAU * f * share + k as f64).cos())
            .sum()
    };
    let places = |count: usize| (0..count).map(move |k| at(k as f64 / count as f64));
    assert!(resolves(49, base, 4) && !resolves(55, base, 2));
    let dense = resampled(places(49).collect(), base);
    for (own, right) in dense.iter().zip(places(dense.len())) {
        assert!((own - right).abs() < 1e-12, "{own} {right}");
    }
    let sampled = places(55).collect::<Vec<_>>();
    let wrong = resampled(sampled, base);
    assert!(
        wrong
            .iter()
            .zip(places(wrong.len()))
            .any(|(own, right)| (own - right).abs() > 0.1)
    );
}
