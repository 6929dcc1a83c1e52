//! Laws of rollers against their authors' printed formulas.

use std::f64::consts::PI;

use pinwheel_contact::{HertzStiffness, Law, LawParameters, Material, NormalLaw};

const STEEL: Material = Material {
    young: 2.1e11,
    poisson: 0.3,
};
const PRINTED: Material = Material {
    young: 2.4e9,
    poisson: 0.39,
};

/// Roller of radius `pin` against a disc, R = R_c R_p/(R_c + R_p), lengths in m.
struct Case {
    pin: f64,
    radius: f64,
    depth: f64,
    length: f64,
    materials: [Material; 2],
}

impl Case {
    /// Returns the approach of both bodies under a force, m: Johnson's half cylinder, 5.6, and the half plane to a depth h of
    /// Weber and Banaschek, whose contact is 2 a wide.
    fn approach(&self, force: f64) -> f64 {
        let [pin, disc] = self.materials;
        let b = |m: Material| (1.0 - m.poisson * m.poisson) / (PI * m.young * self.length);
        let a = (4.0 * force * self.radius * (b(pin) + b(disc))).sqrt();
        let of_pin = b(pin) * force * (2.0 * (4.0 * self.pin / a).ln() - 1.0);
        let poisson = disc.poisson / (1.0 - disc.poisson);
        of_pin + b(disc) * force * (2.0 * (2.0 * self.depth / a).ln() - poisson)
    }

    fn law(&self) -> (Law, HertzStiffness) {
        let parameters = LawParameters {
            pin: self.materials[0],
            disc: self.materials[1],
            disc_depth: self.depth,
            line_length: self.length,
            stiffness_multiplier: 1.0,
            sleeve_radius: 0.002,
            ..LawParameters::default()
        };
        let law = Law::named("line-hertz", &parameters).unwrap();
        (law, parameters.hertz("line-hertz"))
    }
}

/// Rollers of 1 to 20 mm in pits, holes and on lobes, of steel on steel and on a printed disc, from almost no load to 20 kN.
#[test]
fn published_approach_of_rollers() {
    for materials in [[STEEL, STEEL], [STEEL, PRINTED]] {
        for (pin, radius) in [
            (0.002, 0.012),
            (0.002, 0.0013),
            (0.004, 0.02),
            (0.001, 0.001),
            (0.02, 0.1),
        ] {
            let case = Case {
                pin,
                radius,
                depth: 0.01,
                length: 0.015,
                materials,
            };
            let (law, hertz) = case.law();
            let k = hertz.of(pin, radius);
            for force in [1e-9, 1e-3, 1.0, 300.0, 2e4] {
                let delta = case.approach(force);
                // Beyond this width the contact is no longer narrow, and the law is a spring.
                let a = (4.0 * force * radius * 2.0 * materials[1].compliance() / 0.015).sqrt();
                if a > 0.2 * pin {
                    continue;
                }
                let actual = law.force(k, delta, 0.0);
                assert!((actual / force - 1.0).abs() < 1e-11, "{actual} {force}");
                assert!((law.depth(k, force) / delta - 1.0).abs() < 1e-13);
                let h = 1e-4 * force;
                let slope = 2.0 * h / (case.approach(force + h) - case.approach(force - h));
                assert!((law.tangent(k, delta) / slope - 1.0).abs() < 1e-6);
            }
        }
    }
}

/// Twice the length halves the approach under the same load per length; laws of balls do not depend on it.
#[test]
fn published_rollers_know_their_length() {
    let at = |length: f64| {
        let case = Case {
            pin: 0.002,
            radius: 0.004,
            depth: 0.01,
            length,
            materials: [STEEL, STEEL],
        };
        let (law, hertz) = case.law();
        law.depth(hertz.of(0.002, 0.004), 300.0 * length / 0.015)
    };
    assert!((at(0.03) / at(0.015) - 1.0).abs() < 1e-12);
    let parameters = LawParameters::default();
    let balls = Law::named("paper", &parameters).unwrap();
    let longer = LawParameters {
        line_length: 1.0,
        ..parameters
    };
    assert_eq!(Some(balls), Law::named("paper", &longer));
}

/// Values of a prototype in Python for contacts of a 39:1 gear of steel, 7.8 mm wide, discs 10 mm deep: approach in um, local
/// exponent, and tangent in N/um, as printed. R is that of the approach of balls.
#[test]
fn crossval_approaches_of_a_prototype() {
    let parameters = LawParameters {
        pin: STEEL,
        disc: STEEL,
        disc_depth: 0.01,
        line_length: 0.0078,
        stiffness_multiplier: 1.0,
        ..LawParameters::default()
    };
    let laws = ["paper", "line-contact", "kunert", "line-hertz"];
    for (what, pin, radius, force, figures) in [
        (
            "flank",
            2.65e-3,
            12.25e-3,
            300.0,
            [
                [6.77, 1.5, 66.0],
                [1.26, 1.11, 265.0],
                [1.38, 1.08, 235.0],
                [1.05, 1.11, 318.0],
            ],
        ),
        (
            "lobe",
            2.65e-3,
            1.3e-3,
            300.0,
            [
                [14.3, 1.5, 32.0],
                [1.26, 1.11, 265.0],
                [1.38, 1.08, 235.0],
                [1.29, 1.09, 254.0],
            ],
        ),
        (
            "hole",
            0.01,
            0.129,
            1700.0,
            [
                [9.82, 1.5, 260.0],
                [6.0, 1.11, 315.0],
                [6.88, 1.08, 267.0],
                [4.29, 1.16, 461.0],
            ],
        ),
    ] {
        for (name, [approach, exponent, tangent]) in laws.into_iter().zip(figures) {
            let law = Law::named(name, &parameters).unwrap();
            let k = parameters.hertz(name).of(pin, radius);
            let depth = law.depth(k, force);
            let slope = law.tangent(k, depth);
            // Half of the last printed digit, and its effect on R.
            let close = |of: f64, to: f64, digit: f64| {
                let most = 0.5 * digit + 2e-3 * to;
                assert!((of - to).abs() < most, "{what}, {name}: {of} {to}");
            };
            close(
                1e6 * depth,
                approach,
                if approach < 10.0 { 0.01 } else { 0.1 },
            );
            close(depth * slope / force, exponent, 0.01);
            close(1e-6 * slope, tangent, 1.0);
        }
    }
}

/// Lundberg's printed formula, for two rollers and several materials. Measured: 1e-14.
#[test]
fn published_lundberg() {
    for materials in [[STEEL, STEEL], [STEEL, PRINTED]] {
        let parameters = LawParameters {
            pin: materials[0],
            disc: materials[1],
            line_length: 0.015,
            stiffness_multiplier: 1.0,
            ..LawParameters::default()
        };
        let law = Law::named("lundberg", &parameters).unwrap();
        let hertz = parameters.hertz("lundberg");
        for (pin, radius) in [(0.002, 0.012), (0.004, 0.0013)] {
            for force in [1e-3, 1.0, 100.0] {
                let softness: f64 = materials
                    .map(|m| (1.0 - m.poisson * m.poisson) / m.young)
                    .iter()
                    .sum();
                // Half the width for two bodies: b^2 = 4 Q (1/E_1' + 1/E_2') R/(pi L).
                let b = (4.0 * force * softness * radius / (PI * 0.015)).sqrt();
                let delta =
                    2.0 * force / (PI * 0.015) * softness * (1.8864 + (0.015 / (2.0 * b)).ln());
                let actual = law.force(hertz.of(pin, radius), delta, 0.0);
                assert!((actual / force - 1.0).abs() < 1e-11, "{actual} {force}");
            }
        }
    }
}
