//! Derivatives in Newton's method for an equilibrium.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::Scene;

/// Differences of moments against the contacts' own derivatives, both per rotation of the output.
#[test]
fn stiffness_by_differences_is_that_of_the_slopes() {
    for (preset, share) in [
        ("paper", 1.0),
        ("steel", 1.0),
        ("steel", 1e-4),
        ("backlash-0.6", 1.0),
    ] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let at = statics
            .solve(0.3, share * gearbox.load_torque(0.1))
            .unwrap();
        let load = share * gearbox.load_torque(0.1);
        let (closed, wanted) = statics.jacobians(&at, load);
        let [wanted, _] = wanted.unwrap();
        let worst = (closed - &wanted).amax() / wanted[(0, 0)].abs();
        println!("{preset}, {share} of the load: {worst:.1e}");
        assert!(worst < 1e-4, "{preset}: {worst:e}");
    }
}

/// The compliance equals finite differences of K + s D with the discs eliminated, at small s.
#[test]
fn damping_is_the_slope_of_what_the_wheels_leave() {
    for preset in ["paper", "toleranced"] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let at = statics.solve(0.3, 22.0).unwrap();
        let computed = statics.compliance(&at).unwrap();
        let (_, derivatives) = statics.jacobians(&at, 22.0);
        let [k, d] = derivatives.unwrap();
        let left = |s: f64| {
            let of = |i, j| k[(i, j)] + s * d[(i, j)];
            (1..=at.wheels.len()).fold(of(0, 0), |left, hub| {
                left - of(0, hub) * of(hub, 0) / of(hub, hub)
            })
        };
        let s = 1e-4 * k[(0, 0)] / d[(0, 0)];
        let wanted = [-left(0.0), (left(-s) - left(s)) / (2.0 * s)];
        for (computed, wanted) in computed.iter().zip(wanted) {
            assert!(
                (computed / wanted - 1.0).abs() < 1e-6,
                "{preset}: {computed} {wanted}"
            );
        }
    }
}
