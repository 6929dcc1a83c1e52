//! Discs with rotated flanks.

use std::f64::consts::PI;

use pinwheel_contact::Complex;
use pinwheel_gearbox::Geometry;
use pinwheel_gearbox::internals::{Flanks, Seat, Touch};
use pinwheel_scene::Scene;

/// In the middle of a pit a pin may touch both flanks: the deeper one counts.
#[test]
fn of_two_flanks_the_nearer_is_touched() {
    let mut scene = Scene::paper();
    scene.gear.modification.rotational_rad = 1e-4;
    let flanks = Flanks::of(&Geometry::new(&scene).unwrap()).unwrap();
    let pit = PI / scene.gear.lobes() as f64;
    let at = |angle: f64, penetration: f64| {
        let point = Complex::unit(angle).scale(0.05);
        let mut touch = Touch::at_point(Complex::new(0.0, 0.0), point, 0.006, 1e9);
        touch.penetration = penetration;
        let (unit, turn) = (Complex::unit(angle), Complex::ONE);
        (touch, Seat::Foot { unit, turn })
    };
    for (ccw, cw) in [(1e-6, 2e-6), (2e-6, 1e-6)] {
        let feet = [at(pit + 1e-3, ccw), at(pit - 1e-3, cw)];
        let p = Complex::unit(pit).scale(0.056);
        let (touch, _) = flanks.touch(p, 0.006, feet, |_| 1e9);
        assert_eq!(touch.penetration, 2e-6);
    }
}
