//! Normal contact laws: force as a function of stiffness, penetration and its rate.
//!
//! One file a law; each opens with its equation and source, implements [`NormalLaw`], and has `INFO` (what it is, for
//! users) and `new` (the law of a scene's parameters). One line below registers it, and everything follows from that
//! line: [`LAWS`], [`Law`] with its forces, energy and force along the profile, and [`Law::named`].

mod adams_impact;
mod constant;
mod flores;
mod herbert_mcwhannell;
mod hunt_crossley;
mod hysteresis;
mod kunert;
mod lankarani_nikravesh;
mod lee_wang;
mod line_contact;
mod line_hertz;
mod linear;
mod lundberg;
mod normal;
mod paper;
mod paper_conservative;
mod paper_printed;
mod parameters;
mod pin_law;
mod ramp;
mod registry;

use crate::{HertzStiffness, Real};

pub use adams_impact::AdamsImpact;
pub use constant::ConstantStiffness;
pub use hysteresis::Hysteresis;
pub use line_contact::LineContact;
pub use line_hertz::LineHertz;
pub use linear::LinearSprings;
pub use normal::NormalLaw;
pub use paper::PaperLaw;
pub use paper_conservative::PaperConservative;
pub use paper_printed::PaperPrinted;
pub use parameters::LawParameters;
pub use pin_law::{OnPin, PinLaw};
pub use ramp::Ramp;
use registry::registry;

registry! {
    laws {
        paper: Paper,
        paper_conservative: PaperConservative,
        constant: Constant,
        hunt_crossley: Hysteresis,
        lee_wang: Hysteresis,
        herbert_mcwhannell: Hysteresis,
        lankarani_nikravesh: Hysteresis,
        flores: Hysteresis,
        adams_impact: AdamsImpact,
        line_contact: LineContact,
        line_hertz: LineHertz,
        lundberg: LineHertz,
        kunert: LineContact,
        linear: Linear,
        paper_printed: PaperPrinted,
    }
    forms {
        Paper(PaperLaw),
        PaperConservative(PaperConservative),
        Constant(ConstantStiffness),
        Hysteresis(Hysteresis),
        AdamsImpact(AdamsImpact),
        LineContact(LineContact),
        LineHertz(LineHertz),
        Linear(LinearSprings),
        PaperPrinted(PaperPrinted),
    }
}

/// Any law. One branch on its type, which always goes the same way, is cheap: loops over contacts are compiled once for all laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Index in [`LAWS`].
    number: usize,
    form: Form,
}

impl Law {
    /// Returns the law called `name`, with the parameters that it reads; `None` if there is none.
    #[must_use]
    pub fn named(name: &str, parameters: &LawParameters) -> Option<Self> {
        let number = LAWS.iter().position(|info| info.name == name)?;
        let form = CONSTRUCTORS[number](parameters);
        Some(Self { number, form })
    }

    /// Returns the facts of the law for users.
    #[must_use]
    pub fn info(&self) -> &'static LawInfo {
        &LAWS[self.number]
    }
}

impl From<PaperLaw> for Law {
    fn from(law: PaperLaw) -> Self {
        let number = LAWS.iter().position(|info| info.name == paper::INFO.name);
        Self {
            number: number.unwrap_or_default(),
            form: Form::Paper(law),
        }
    }
}

impl NormalLaw for Law {
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        for_form!(self, law => law.force(stiffness, penetration, rate))
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        for_form!(self, law => law.stored(stiffness, penetration))
    }

    #[inline(always)]
    fn along<R: Real>(&self, stiffness: R, penetration: R) -> Option<R> {
        for_form!(self, law => law.along(stiffness, penetration))
    }

    #[inline]
    fn stiffness(&self, hertz: f64) -> f64 {
        for_form!(self, law => law.stiffness(hertz))
    }

    #[inline]
    fn exponent(&self) -> f64 {
        for_form!(self, law => law.exponent())
    }

    fn elastic(&self, hertz: f64, depth: f64) -> f64 {
        for_form!(self, law => law.elastic(hertz, depth))
    }

    fn depth(&self, hertz: f64, force: f64) -> f64 {
        for_form!(self, law => law.depth(hertz, force))
    }

    fn tangent(&self, hertz: f64, depth: f64) -> f64 {
        for_form!(self, law => law.tangent(hertz, depth))
    }

    #[inline(always)]
    fn observed<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
        for_form!(self, law => law.observed(stiffness, penetration, rate))
    }
}

/// Shape of contact that a law assumes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Two balls that touch in a point: the length of a roller does not enter.
    Sphere,
    /// Two rollers that touch on a line.
    Line,
    /// One stiffness for all contacts, whatever it was fitted to.
    Fitted,
}

impl Shape {
    /// `sphere`, `line` or `fitted`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Line => "line",
            Self::Fitted => "fitted",
        }
    }

    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Sphere => "balls that touch in a point; the face width does not enter",
            Self::Line => "rollers that touch on a line; stiffness grows with the face width",
            Self::Fitted => {
                "whatever the one stiffness was fitted to; the face width does not enter"
            }
        }
    }
}

/// A law as listed for users.
#[derive(Debug, Clone, Copy)]
pub struct LawInfo {
    /// Name in scenes.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// The force.
    pub formula: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Where it may be used.
    pub domain: &'static str,
    /// Behaviour as the impact speed tends to 0.
    pub slow_impact: &'static str,
    /// Scene keys it reads, besides those every law shares.
    pub keys: &'static [&'static str],
    /// The hysteresis factor chi as a function of the restitution c in (0, 1], of laws of that family.
    pub restitution_factor: Option<fn(f64) -> f64>,
    /// True if the undamped force has a potential on a profile of varying stiffness.
    pub conservative: bool,
    /// Shape of contact that the law assumes.
    pub shape: Shape,
    /// Materials that it holds for.
    pub materials: &'static str,
    /// Stiffness of the law from Hertz's K, if it is another.
    pub stiffness: Option<fn(HertzStiffness, &LawParameters) -> HertzStiffness>,
}

/// The law called `name`.
#[must_use]
pub fn law_info(name: &str) -> Option<&'static LawInfo> {
    LAWS.iter().find(|law| law.name == name)
}

/// The hysteresis factor chi of a law of that family for the restitution c in (0, 1]; `None` for other laws.
#[must_use]
pub fn hysteresis_factor(name: &str, restitution: f64) -> Option<f64> {
    let factor = law_info(name)?.restitution_factor?;
    Some(factor(restitution))
}

/// STEP of the Adams solver: h0 below x0, h1 above x1, a smooth cubic between.
#[must_use]
#[inline(always)]
pub fn step<R: Real>(x: R, x0: f64, h0: f64, x1: f64, h1: f64) -> R {
    let c = |v: f64| x.like(v);
    let s = ((x - c(x0)) / c(x1 - x0)).max(c(0.0)).min(c(1.0));
    c(h0) + c(h1 - h0) * s * s * (c(3.0) - c(2.0) * s)
}

#[cfg(test)]
mod tests {
    use pulp::Simd;

    use super::*;
    use crate::Lanes;

    /// Every law at the default parameters.
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

    /// No law but the printed one pulls, none has a jump at first touch when bodies meet at rest, and stored energy is
    /// what the force at rest does.
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

    /// Closing bodies are pressed apart more and parting ones less, below the ramp and above it.
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

    /// A law says that it has a potential if and only if its force along the profile is that potential's: dU/dK, or
    /// nothing where the energy does not depend on K.
    #[test]
    fn potentials_have_their_force_along_the_profile() {
        // The stiffness of linear springs is the same all along the profile.
        for (name, law) in each().filter(|(name, _)| *name != "linear") {
            for depth in [1e-7, 4e-6, 1e-5, 3e-5, 4e-4] {
                let (k, h) = (1e8, 1e4);
                let change = (law.stored(k + h, depth) - law.stored(k - h, depth)) / (2.0 * h);
                let along = law.along(k, depth).unwrap_or(0.0);
                // Nothing depends on K, or a difference of 1e-4 of it to its rounding.
                let whole = (along - change).abs() <= 1e-7 * change;
                assert_eq!(
                    whole,
                    law.info().conservative,
                    "{name} {depth}: {along} {change}"
                );
            }
        }
    }

    /// A law in lanes against itself, one contact at a time.
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

    /// Above its ramp and at rest a law's force, depth and slope belong together.
    #[test]
    fn springs_are_those_of_the_force() {
        for (name, law) in each() {
            let near =
                |a: f64, b: f64, to: f64| assert!((a / b - 1.0).abs() < to, "{name}: {a} {b}");
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

    /// The published factors at two restitutions, by hand.
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
}
