//! Areas and moments of inertia.

use pinwheel_scene::Scene;
use pinwheel_scene::internals::Shape;

/// From an independent program: 8710.1 mm^2 inside the paper's profile without its eight holes of 8.8 mm, radius of
/// gyration 41.88 mm without and 44.45 mm with a bore of 18.45 mm.
#[test]
fn the_papers_wheel() {
    let gear = Scene::paper().gear;
    let profile = Shape::profile(&gear);
    let hole = Shape::disc(gear.hole_radius_m);
    let circle = gear.internal_circle_radius_m;
    let area = profile.area_m2 - 8.0 * hole.area_m2;
    let polar = profile.polar_m4 - 8.0 * (hole.polar_m4 + hole.area_m2 * circle * circle);
    assert!((area - 8710.1e-6).abs() < 0.05e-6, "{area}");
    assert!(((polar / area).sqrt() - 41.88e-3).abs() < 5e-6);
    let bore = Shape::disc(18.45e-3);
    let with = (polar - bore.polar_m4) / (area - bore.area_m2);
    assert!((with.sqrt() - 44.45e-3).abs() < 5e-6, "{}", with.sqrt());
}
