//! Normal contact laws: force as a function of stiffness, penetration and its rate.
//!
//! Each file has one law: its equation and source, its [`NormalLaw`], its `INFO` (data for users) and `new` (the law from a
//! scene's parameters). One line below registers it. From that line follow [`LAWS`], [`Law`] with its forces, energy and force
//! along the profile, and [`Law::named`].

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

/// Any of the laws. Its branch on the type is cheap because it is always taken the same way; loops over contacts are compiled
/// once for all laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Index in [`LAWS`].
    number: usize,
    form: Form,
}

impl Law {
    /// Returns the law called `name`, with the parameters that it reads; `None` if there is no law of that name.
    pub fn named(name: &str, parameters: &LawParameters) -> Option<Self> {
        let number = LAWS.iter().position(|info| info.name == name)?;
        let form = CONSTRUCTORS[number](parameters);
        Some(Self { number, form })
    }

    /// Returns the data of the law for users.
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
    /// One stiffness for all contacts, fitted to any shape.
    Fitted,
}

impl Shape {
    /// Returns `sphere`, `line` or `fitted`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Line => "line",
            Self::Fitted => "fitted",
        }
    }

    /// Returns the shape in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Sphere => "balls that touch in a point; the face width does not enter",
            Self::Line => "rollers that touch on a line; stiffness grows with the face width",
            Self::Fitted => {
                "those to which the one stiffness was fitted; the face width does not enter"
            }
        }
    }
}

/// Data of a law for users.
#[derive(Debug, Clone, Copy)]
pub struct LawInfo {
    /// Name in scenes.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Formula of the force.
    pub formula: &'static str,
    /// Source of the law.
    pub source: &'static str,
    /// Range of validity.
    pub domain: &'static str,
    /// Behaviour as the impact speed tends to 0.
    pub slow_impact: &'static str,
    /// Scene keys that the law reads, besides those of every law.
    pub keys: &'static [&'static str],
    /// Hysteresis factor chi as a function of the restitution c in (0, 1], for laws of the hysteresis family.
    pub restitution_factor: Option<fn(f64) -> f64>,
    /// True if the undamped force has a potential on a profile of varying stiffness.
    pub conservative: bool,
    /// Shape of contact that the law assumes.
    pub shape: Shape,
    /// Materials for which the law is valid.
    pub materials: &'static str,
    /// Function that gives the law's stiffness from Hertz's K, if it differs.
    pub stiffness: Option<fn(HertzStiffness, &LawParameters) -> HertzStiffness>,
}

/// Returns the data of the law called `name`.
pub fn law_info(name: &str) -> Option<&'static LawInfo> {
    LAWS.iter().find(|law| law.name == name)
}

/// Returns the hysteresis factor chi of a law for the restitution c in (0, 1]; `None` for laws outside the hysteresis family.
pub fn hysteresis_factor(name: &str, restitution: f64) -> Option<f64> {
    let factor = law_info(name)?.restitution_factor?;
    Some(factor(restitution))
}

/// Evaluates STEP of the Adams solver: h0 below x0, h1 above x1, a smooth cubic between.
#[inline(always)]
pub fn step<R: Real>(x: R, x0: f64, h0: f64, x1: f64, h1: f64) -> R {
    let c = |v: f64| x.like(v);
    let s = ((x - c(x0)) / c(x1 - x0)).max(c(0.0)).min(c(1.0));
    c(h0) + c(h1 - h0) * s * s * (c(3.0) - c(2.0) * s)
}
