//! Normal contact laws: forces, energies, texts.

use pinwheel_contact::laws::{LAWS, hysteresis_factor, law_info, step};
use pinwheel_contact::{Lanes, Law, LawParameters, NormalLaw as _, PaperLaw, Ramp};
use pulp::Simd;

/// Iterates over every law at the default parameters.
fn each() -> impl Iterator<Item = (&'static str, Law)> {
    let parameters = LawParameters::default();
    LAWS.iter().map(move |info| {
        let law = Law::named(info.name, &parameters).expect("registered");
        assert_eq!(law.info().name, info.name);
        (info.name, law)
    })
}

#[test]
fn names_differ_and_texts_are_there() {
    for (k, law) in LAWS.iter().enumerate() {
        assert!(LAWS[..k].iter().all(|other| other.name != law.name));
        for text in [
            law.summary,
            law.formula,
            law.source,
            law.domain,
            law.slow_impact,
        ] {
            assert!(text.len() > 10, "{}: {text}", law.name);
        }
    }
    assert!(law_info("paper").is_some() && law_info("papre").is_none());
    assert!(Law::named("papre", &LawParameters::default()).is_none());
}

/// Only the printed law pulls, no law has a jump at first touch at rest, and the stored energy is the work of the force at
/// rest.
#[test]
fn forces_push_and_store() {
    for (name, law) in each() {
        for depth in [1e-12, 1e-7, 4e-6, 1e-5, 3e-5, 4e-4] {
            for rate in [-10.0, -0.3, -1e-4, 0.0, 1e-4, 0.3, 10.0] {
                let f = law.force(9e7, depth, rate);
                let pushes = f >= 0.0 || (name == "paper-printed" && rate < 0.0);
                assert!(pushes && f.is_finite(), "{name} {depth} {rate}: {f}");
            }
            let h = 1e-6 * depth;
            let slope = (law.stored(9e7, depth + h) - law.stored(9e7, depth - h)) / (2.0 * h);
            let f = law.force(9e7, depth, 0.0);
            assert!(
                (slope / f - 1.0).abs() < 1e-6,
                "{name} {depth}: {slope} {f}"
            );
        }
        assert!(law.force(9e7, 1e-13, 0.0) < 1e-3, "{name}");
    }
}

/// Damping raises the force of approaching bodies and lowers that of separating ones, below the ramp and above it.
#[test]
fn damping_opposes() {
    for (name, law) in each() {
        for depth in [4e-6, 3e-5, 4e-4] {
            let at = |rate: f64| law.force(9e7, depth, rate);
            let (closing, rest, parting) = (at(1e-3), at(0.0), at(-1e-3));
            assert!(
                parting < rest && rest < closing,
                "{name} {depth}: {parting} {rest} {closing}"
            );
        }
    }
}

/// A law declares a potential if and only if its force along the profile is that potential's: dU/dK, or 0 where the energy does
/// not depend on K.
#[test]
fn potentials_have_their_force_along_the_profile() {
    // Linear springs have constant stiffness along the profile.
    for (name, law) in each().filter(|(name, _)| *name != "linear") {
        for depth in [1e-7, 4e-6, 1e-5, 3e-5, 4e-4] {
            let (k, h) = (1e8, 1e4);
            let change = (law.stored(k + h, depth) - law.stored(k - h, depth)) / (2.0 * h);
            let along = law.along(k, depth).unwrap_or(0.0);
            // Either nothing depends on K, or a difference of 1e-4 of K agrees to its rounding.
            let elastic = (along - change).abs() <= 1e-7 * change;
            assert_eq!(
                elastic,
                law.info().conservative,
                "{name} {depth}: {along} {change}"
            );
        }
    }
}

/// Comparison of a law in lanes with its scalar form.
struct InLanes(Law);

impl pulp::WithSimd for InLanes {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let law = self.0;
        let name = law.info().name;
        let same = |lanes: Lanes<S>, value: f64| {
            let all = lanes.as_slice().iter();
            let off = all.map(|x| (x - value).abs()).fold(0.0, f64::max);
            assert!(off <= 4e-15 * value.abs(), "{name}: {off:e} of {value:e}");
        };
        let splat = |x: f64| Lanes::splat(simd, x);
        for depth in [1e-7, 4e-6, 1e-5, 3e-5, 4e-4] {
            for rate in [-0.3, 0.0, 1e-4, 0.3] {
                let lanes = law.force(splat(9e7), splat(depth), splat(rate));
                same(lanes, law.force(9e7, depth, rate));
            }
            let stored = law.stored(splat(9e7), splat(depth));
            same(stored, law.stored(9e7, depth));
            match (law.along(splat(9e7), splat(depth)), law.along(9e7, depth)) {
                (Some(lanes), Some(value)) => same(lanes, value),
                (lanes, value) => assert!(lanes.is_none() && value.is_none(), "{name}"),
            }
        }
    }
}

#[test]
fn lanes_are_the_law() {
    for (_, law) in each() {
        pulp::Arch::new().dispatch(InLanes(law));
        pulp::Arch::Scalar.dispatch(InLanes(law));
    }
}

/// Above its ramp and at rest a law's force, depth and slope are consistent.
#[test]
fn springs_are_those_of_the_force() {
    for (name, law) in each() {
        let near = |a: f64, b: f64, to: f64| assert!((a / b - 1.0).abs() < to, "{name}: {a} {b}");
        for hertz in [3e7, 9e7] {
            for depth in [3e-5, 4e-4] {
                let force = law.force(hertz, depth, 0.0);
                near(law.elastic(hertz, depth), force, 1e-12);
                near(law.depth(hertz, force), depth, 1e-12);
                let h = 1e-5 * depth;
                let rise = law.force(hertz, depth + h, 0.0) - law.force(hertz, depth - h, 0.0);
                near(law.tangent(hertz, depth), rise / (2.0 * h), 1e-8);
            }
        }
    }
}

/// Published factors at two restitutions, by hand.
#[test]
fn hysteresis_factors_are_those_of_their_authors() {
    for (name, at_half, at_four_fifths) in [
        ("hunt-crossley", 0.75, 0.3),
        ("lee-wang", 0.375, 0.15),
        ("herbert-mcwhannell", 1.0, 1.2 / 3.36),
        ("lankarani-nikravesh", 0.5625, 0.27),
        ("flores", 1.6, 0.4),
    ] {
        for (c, expected) in [(0.5, at_half), (0.8, at_four_fifths)] {
            let chi = hysteresis_factor(name, c).expect("of the family");
            assert!((chi - expected).abs() < 1e-15, "{name} {c}: {chi}");
        }
    }
    assert!(hysteresis_factor("paper", 0.5).is_none());
}

#[test]
fn step_is_adams_s() {
    assert_eq!(step(-1.0, 0.0, 2.0, 1.0, 5.0), 2.0);
    assert_eq!(step(0.5, 0.0, 2.0, 1.0, 5.0), 3.5);
    assert_eq!(step(7.0, 0.0, 2.0, 1.0, 5.0), 5.0);
}

#[test]
fn the_paper_s_law_by_hand() {
    let law = PaperLaw {
        damping: 8.0,
        ramp: Ramp::new(1e-5),
    };
    assert_eq!(law.force(1e8, 4e-4, 0.0), 1e8 * (4e-4 * 0.02));
    // Half way up the ramp force and damping are halved.
    assert!((law.force(1e8, 5e-6, 0.1) - 0.5 * (1e8 * 5e-6_f64.powf(1.5) + 0.8)).abs() < 1e-12);
    assert_eq!(law.force(1e8, 1e-6, -10.0), 0.0);
}

#[test]
fn pulls_where_the_paper_s_law_is_clamped() {
    let law = Law::named("paper-printed", &LawParameters::default()).unwrap();
    assert_eq!(law.force(1e8, 4e-4, 0.0), 1e8 * 4e-4 * 0.02);
    assert!(law.force(1e8, 1e-5, -10.0) < -70.0);
}

/// Palmgren's formula, with H = 1: 1000 N on 10 mm.
#[test]
fn depth_is_palmgren_s() {
    let parameters = LawParameters {
        stiffness_multiplier: 1.0,
        ..LawParameters::default()
    };
    let law = Law::named("line-contact", &parameters).unwrap();
    let depth = 1e-3 * 3.84e-5 * 1000.0_f64.powf(0.9) / 10.0_f64.powf(0.8);
    assert!((law.force(0.0, depth, 0.0) / 1000.0 - 1.0).abs() < 1e-12);
}

/// The formula as printed, with H = 1: 1000 N on 10 mm.
#[test]
fn published_depth_is_kunert_s() {
    let parameters = LawParameters {
        stiffness_multiplier: 1.0,
        ..LawParameters::default()
    };
    let law = Law::named("kunert", &parameters).unwrap();
    let depth = 1e-3 * 4.05e-5 * 1000.0_f64.powf(0.925) / 10.0_f64.powf(0.85);
    assert!((law.force(0.0, depth, 0.0) / 1000.0 - 1.0).abs() < 1e-12);
}
