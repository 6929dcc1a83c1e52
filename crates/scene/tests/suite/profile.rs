//! Curve C and its offset.

use pinwheel_scene::internals::Profile;
use pinwheel_scene::{Gear, Scene};

#[test]
fn the_papers_smallest_convex_radius() {
    // From an independent program: 13.12258 mm on C, 7.1226 mm on the profile.
    let profile = Profile::of(&Scene::paper().gear);
    assert!((profile.smallest_convex_radius() - 0.013_122_58).abs() < 5e-9);
    assert!((1.0 / profile.curvature(1.0) - 0.006 - 0.009_160_7).abs() < 5e-8);
    assert!((1.0 / profile.curvature(-1.0) - 0.006 + 0.006_564_7).abs() < 5e-8);
}

#[test]
fn curvature_agrees_with_differences_of_the_curve() {
    let gear = Gear {
        external_sleeves: 7,
        shortening: 0.45,
        ..Scene::paper().gear
    };
    let profile = Profile::of(&gear);
    let h = 1e-4;
    for i in 0..50 {
        let a = f64::from(i) * 0.13;
        let [p, q, r] = [a - h, a, a + h].map(|a| profile.point(a));
        let d = [(r[0] - p[0]) / (2.0 * h), (r[1] - p[1]) / (2.0 * h)];
        let dd = [0, 1].map(|k| (r[k] - 2.0 * q[k] + p[k]) / (h * h));
        let kappa = (d[0] * dd[1] - d[1] * dd[0]) / d[0].hypot(d[1]).powi(3);
        let exact = profile.curvature((profile.lobes() * a).cos());
        // Central differences err by h^2 times a fourth derivative of about zk^4 e/R.
        assert!(
            (kappa - exact).abs() < 1e-4 * exact.abs().max(1.0),
            "{kappa} {exact}"
        );
    }
}

#[test]
fn the_offset_keeps_its_distance() {
    let profile = Profile::of(&Scene::paper().gear);
    for i in 0..200 {
        let a = f64::from(i) * 0.031;
        let distance = profile.distance(profile.offset_point(a), a, 0.4, 400);
        assert!((distance - 0.006).abs() < 1e-9, "{distance}");
    }
}
