//! Derivatives by dual numbers against differences.

use pinwheel_contact::laws::LAWS;
use pinwheel_contact::{
    AdamsFriction, Complex, Dual, Epitrochoid, Friction, Law, LawParameters, Material, NormalLaw,
    PinLaw, Real, RegularisedCoulomb, Scalar,
};

/// Compares the derivatives of `f` at `x` with differences of order 4 at these steps.
fn check<const N: usize>(
    x: [f64; N],
    h: [f64; N],
    exact: Dual<N>,
    f: impl Fn([f64; N]) -> f64,
    what: &str,
) {
    assert!((exact.value - f(x)).abs() <= 1e-13 * f(x).abs(), "{what}");
    for k in 0..N {
        let at = |share: f64| {
            let mut moved = x;
            moved[k] += share * h[k];
            f(moved)
        };
        let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h[k]);
        // Measured: at most 3e-8, rounding of the differences.
        let scale = exact.by[k]
            .abs()
            .max(1e-3 * (exact.value / h[k] * 1e-3).abs());
        assert!(
            (exact.by[k] - slope).abs() <= 3e-7 * scale,
            "{what}, variable {k}: {:e}, by differences {slope:e}",
            exact.by[k]
        );
    }
}

#[test]
fn operations_have_their_derivatives() {
    fn all<S: Scalar>([x, y]: [S; 2]) -> S {
        let (sin, cos) = (x * y).sin_cos();
        let root = (x / y).sqrt() - y.powf(1.7);
        let bent = x.max(y).min(x + y).ln();
        let kinked = x.below(y, x * x, y * y);
        (sin - cos * root).mul_add(bent, -kinked) + x.like(3.0)
    }
    for x in [[1.3, 0.7], [0.4, 2.1]] {
        check(x, [1e-3; 2], all(Dual::variables(x)), all, "operations");
    }
}

/// Every law, on rigid and on bending pins, within its ramp and beyond.
#[test]
fn laws_have_their_derivatives() {
    let steel = Material {
        young: 2e11,
        poisson: 0.3,
    };
    let parameters = LawParameters {
        pin: steel,
        disc: steel,
        stiffness_multiplier: 1.0,
        damping: 8.0,
        ramp: 1e-5,
        sleeve_radius: 0.006,
        line_length: 0.01,
        disc_depth: 0.02,
        ..LawParameters::default()
    };
    for info in LAWS {
        let law = Law::named(info.name, &parameters).unwrap();
        for (pin_n_m, depth) in [(None, 4e-6), (None, 2e-5), (Some(2e7), 2e-5)] {
            let law = PinLaw {
                law,
                pin_n_m,
                ring_n_m: None,
            };
            let x = [8e8, depth, 0.02];
            let exact = |[k, depth, rate]: [Dual<3>; 3]| law.force(k, depth, rate);
            let force = |[k, depth, rate]: [f64; 3]| law.force(k, depth, rate);
            let steps = [1e-3 * x[0], 1e-3 * depth, 1e-4];
            let exact = exact(Dual::variables(x));
            if force(x) > 0.0 {
                check(x, steps, exact, force, info.name);
            }
        }
        let x = [8e8, 2e-5];
        let [k, depth] = Dual::variables(x);
        if let Some(along) = law.along(k, depth) {
            let steps = [1e-3 * x[0], 1e-3 * x[1]];
            let force = |[k, depth]: [f64; 2]| law.along(k, depth).unwrap();
            check(x, steps, along, force, info.name);
        }
    }
}

#[test]
fn friction_has_its_derivatives() {
    let regularised = Friction::Regularised(RegularisedCoulomb {
        coefficient: 0.1,
        ramp: 1e-3,
    });
    let adams = Friction::Adams(AdamsFriction {
        static_coefficient: 0.2,
        dynamic_coefficient: 0.1,
        static_speed: 1e-3,
        dynamic_speed: 2e-3,
    });
    for (friction, sliding) in [
        (regularised, -0.4e-3),
        (regularised, 3e-3),
        (adams, 0.4e-3),
        (adams, -1.4e-3),
        (adams, 3e-3),
    ] {
        let x = [50.0, sliding];
        let [normal, speed] = Dual::variables(x);
        let exact = friction.force(normal, speed);
        let force = |[normal, speed]: [f64; 2]| friction.force(normal, speed);
        check(x, [0.1, 1e-5], exact, force, "friction");
    }
}

/// Foot of a moving point, by a new search and from one foot in dual numbers.
#[test]
fn feet_have_their_derivatives() {
    let curve = Epitrochoid::new(0.0028, 16, 0.7).unwrap();
    for a in [0.02, 0.11, 0.19, 2.3] {
        let at = curve.at(a);
        let x = (at.position - at.normal.scale(2e-5)).to_array();
        let foot = |x: [f64; 2]| curve.closest(x.into());
        let [px, py] = Dual::variables(x);
        let exact = curve.foot_beside(foot(x).unit, Complex::new(px, py));
        check(x, [1e-6; 2], exact.unit.re, |x| foot(x).unit.re, "unit");
        check(
            x,
            [1e-6; 2],
            exact.at.normal.im,
            |x| foot(x).at.normal.im,
            "normal",
        );
        check(
            x,
            [1e-6; 2],
            exact.at.curvature,
            |x| foot(x).at.curvature,
            "curvature",
        );
        let depth = |x| -foot(x).distance + 1.0;
        check(
            x,
            [1e-6; 2],
            exact.distance.like(1.0) - exact.distance,
            depth,
            "distance",
        );
    }
}
