//! Facts of an engine that are known without running it.

use pinwheel_compare::model::ModelTolerance;
use pinwheel_mbs::integrators::{self, UNSEEN};
use pinwheel_scene::Scene;
use pinwheel_timeseries::SharedModel;
use serde::{Deserialize, Serialize};

use crate::own_contact::OwnContact;

/// Setting that is made smaller for more accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum AccuracySetting {
    /// `solver.step_s`.
    #[serde(rename(serialize = "step-s", deserialize = "solver.step_s"))]
    Step,
    /// `solver.tolerance`.
    #[serde(rename(serialize = "tolerance", deserialize = "solver.tolerance"))]
    Tolerance,
}

impl AccuracySetting {
    /// That of an integrator of ours.
    #[must_use]
    pub fn of(method: &str) -> Self {
        match integrators::method(method).is_some_and(|method| method.adaptive) {
            true => Self::Tolerance,
            false => Self::Step,
        }
    }

    /// Where it stands: a step, s, or a tolerance.
    #[must_use]
    pub fn get(self, scene: &Scene) -> f64 {
        match self {
            Self::Step => scene.solver.step_s,
            Self::Tolerance => scene.solver.tolerance,
        }
    }

    /// Turns it.
    pub fn set(self, scene: &mut Scene, setting: f64) {
        match self {
            Self::Step => scene.solver.step_s = setting,
            Self::Tolerance => scene.solver.tolerance = setting,
        }
    }
}

/// How an engine is refined.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Setting that is made smaller.
    #[serde(rename = "key")]
    pub knob: AccuracySetting,
    /// Order of the error in it.
    pub order: f64,
}

impl Refinement {
    /// By `solver.step_s`.
    #[must_use]
    pub const fn step(order: f64) -> Self {
        Self {
            knob: AccuracySetting::Step,
            order,
        }
    }

    /// By `solver.tolerance`.
    #[must_use]
    pub const fn tolerance(order: f64) -> Self {
        Self {
            knob: AccuracySetting::Tolerance,
            order,
        }
    }
}

/// The form of the equations that a native engine solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Centre-pinned bodies eliminated.
    Reduced,
    /// All bodies, Eq. 2.
    Lagrange,
    /// The reduced form, integrated until the step no longer matters.
    Resolved,
}

/// Facts of an engine that are known without running it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineInfo<'a> {
    /// As typed by users, kebab-case, with what it shares in the names of others' engines.
    pub name: &'a str,
    /// The name where what it shares is said beside it.
    pub short: &'a str,
    /// Parts that the engine shares with the native solver.
    pub track: SharedModel,
    /// One line.
    pub summary: &'a str,
    /// How it differs from the native solver, in plain words, for the report.
    pub differences: &'a str,
    /// Which key of a scene makes it more accurate, and with which order; `None` where none does, and for native engines,
    /// whose methods have their own.
    pub refinement: Option<Refinement>,
    /// Relative error of the forces that its iterations leave, whatever the step.
    pub floor: f64,
    /// Error that none of its coarser runs show, as a share of its tolerance.
    pub shared_error: f64,
    /// Contacts that the engine has in place of the scene's contact law.
    pub own_contact: OwnContact,
    /// How far a contact model of its own is from ours.
    pub model: &'a [ModelTolerance],
    /// True if friction is evaluated explicitly, so that it takes short steps to resolve it.
    pub explicit_friction: bool,
    /// True if the engine runs in a process of its own, whose CPU time is not this one's.
    pub outside: bool,
    /// True for a solver of the user's: a comparison has to show something of it.
    pub brought: bool,
    /// The form of a native engine.
    pub form: Option<Form>,
    /// Colour of its lines, the same on every page; `None`: one that follows from its name.
    pub colour: Option<usize>,
    /// Feature of the builds that have it; `None` where all have.
    pub feature: Option<&'a str>,
    /// Package whose version counts, where that is pinned.
    pub package: &'a str,
    /// Digits of its recordings, which leave its own accuracy untouched: a thousandth of its limits.
    pub digits: usize,
    /// Its place among those that may stand in for Adams beside the paper's figures: multibody programs with contacts of
    /// their own, as Adams is one.
    pub stands_in: Option<usize>,
}

impl<'a> EngineInfo<'a> {
    /// An engine of which nothing else is known.
    #[must_use]
    pub const fn own(name: &'a str, track: SharedModel) -> Self {
        Self {
            name,
            short: name,
            track,
            summary: "",
            differences: "",
            refinement: None,
            floor: 0.0,
            shared_error: UNSEEN,
            own_contact: OwnContact::SceneLaw,
            model: &[],
            explicit_friction: false,
            outside: false,
            brought: false,
            form: None,
            colour: None,
            feature: None,
            package: "",
            digits: 9,
            stands_in: None,
        }
    }

    /// The program behind it: `exudyn` of `exudyn-own-contact`.
    #[must_use]
    pub fn family(&self) -> &'a str {
        family(self.name)
    }
}

/// The first word of an engine's name.
#[must_use]
pub fn family(name: &str) -> &str {
    name.split_once('-').map_or(name, |(family, _)| family)
}
