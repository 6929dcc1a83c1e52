//! Derivatives by which Newton's method finds a balance.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{Layout, Scene};

/// Number of the output among the free bodies; the discs follow.
const OUTPUT: usize = Layout::OUTPUT - 1;

/// Differences of moments against the contacts' own derivatives, each over what turns the output.
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
        let mut left = vec![0.0; at.wheels.len()];
        let mut all = |by_differences: bool| {
            let (phi, wheels, psi) = (at.input, &at.wheels, at.output);
            if by_differences {
                let here = statics
                    .frictionless_moments(phi, wheels, psi, &mut left)
                    .unwrap();
                statics.differ(phi, wheels, psi, &left, here).unwrap();
            } else {
                statics
                    .moments_with_slopes(phi, wheels, psi, &mut left)
                    .unwrap();
            }
            statics.derivatives.position.clone().unwrap()
        };
        let (found, wanted) = (all(true), all(false));
        let mut worst: f64 = 0.0;
        for row in OUTPUT..=OUTPUT + at.wheels.len() {
            for column in OUTPUT..=OUTPUT + at.wheels.len() {
                let off = found.entry(row, column) - wanted.entry(row, column);
                worst = worst.max((off / wanted.entry(OUTPUT, OUTPUT)).abs());
            }
        }
        println!("{preset}, {share} of the load: {worst:.1e}");
        assert!(worst < 1e-4, "{preset}: {worst:e}");
    }
}

/// The compliance equals the finite differences of K + s D with the discs eliminated, at small s.
#[test]
fn damping_is_the_slope_of_what_the_wheels_leave() {
    for preset in ["paper", "toleranced"] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let mut statics = Statics::new(&gearbox).unwrap();
        let at = statics.solve(0.3, 22.0).unwrap();
        let found = statics.compliance(&at).unwrap();
        let (k, d) = (
            statics.derivatives.position.as_ref().unwrap(),
            &statics.derivatives.rate,
        );
        let left = |s: f64| {
            let of = |i, j| k.entry(i, j) + s * d.entry(i, j);
            let hubs = OUTPUT + 1..=OUTPUT + at.wheels.len();
            hubs.fold(of(OUTPUT, OUTPUT), |left, hub| {
                left - of(OUTPUT, hub) * of(hub, OUTPUT) / of(hub, hub)
            })
        };
        let s = 1e-4 * k.entry(OUTPUT, OUTPUT) / d.entry(OUTPUT, OUTPUT);
        let wanted = [-left(0.0), (left(-s) - left(s)) / (2.0 * s)];
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(
                (found / wanted - 1.0).abs() < 1e-6,
                "{preset}: {found} {wanted}"
            );
        }
    }
}
