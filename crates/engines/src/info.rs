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
    /// Returns the accuracy setting of a native integrator.
    #[must_use]
    pub fn of(method: &str) -> Self {
        match integrators::method(method).is_some_and(|method| method.adaptive) {
            true => Self::Tolerance,
            false => Self::Step,
        }
    }

    /// Returns the value of the setting: a step, s, or a tolerance.
    #[must_use]
    pub fn get(self, scene: &Scene) -> f64 {
        match self {
            Self::Step => scene.solver.step_s,
            Self::Tolerance => scene.solver.tolerance,
        }
    }

    /// Changes the value of the setting.
    pub fn set(self, scene: &mut Scene, setting: f64) {
        match self {
            Self::Step => scene.solver.step_s = setting,
            Self::Tolerance => scene.solver.tolerance = setting,
        }
    }
}

/// Accuracy setting of an engine and the order of the error in it.
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
    /// Refinement by `solver.step_s`.
    #[must_use]
    pub const fn step(order: f64) -> Self {
        Self {
            knob: AccuracySetting::Step,
            order,
        }
    }

    /// Refinement by `solver.tolerance`.
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
    /// Name as typed by users, kebab-case; names of foreign engines say which parts are shared.
    pub name: &'a str,
    /// Name where the shared parts are shown beside it.
    pub short: &'a str,
    /// Parts that the engine shares with the native solver.
    pub track: SharedModel,
    /// Description in one line.
    pub summary: &'a str,
    /// Differences from the native solver, in plain words, for the report.
    pub differences: &'a str,
    /// Key of the scene that controls accuracy, and the order of the error in it; `None` if there is none, and for native
    /// engines, whose integrators have their own.
    pub refinement: Option<Refinement>,
    /// Relative error of the forces that iterations leave at any step.
    pub floor: f64,
    /// Error that coarser runs of the engine do not show, as a share of the tolerance.
    pub shared_error: f64,
    /// Contacts that the engine has in place of the scene's contact law.
    pub own_contact: OwnContact,
    /// Tolerances of the engine's contact model against the native one.
    pub model: &'a [ModelTolerance],
    /// True if friction is evaluated explicitly, so that it takes short steps to resolve it.
    pub explicit_friction: bool,
    /// True if the engine runs in a process of its own, whose CPU time is not this one's.
    pub outside: bool,
    /// True if the engine runs in the one Python interpreter of a process: one such engine at a time.
    pub in_python: bool,
    /// True for a solver of the user's: a comparison has to show something of it.
    pub brought: bool,
    /// The form of a native engine.
    pub form: Option<Form>,
    /// Number of the colour on every page; `None`: a colour that follows from the name.
    pub colour: Option<usize>,
    /// Cargo feature of the builds that have the engine; `None` if all have it.
    pub feature: Option<&'a str>,
    /// Package whose pinned version is the engine's version.
    pub package: &'a str,
    /// Significant digits of recordings: rounding to them is a thousandth of the engine's limits.
    pub digits: usize,
    /// Rank among the substitutes for Adams beside the paper's figures: multibody programs with their own contacts.
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
            in_python: false,
            brought: false,
            form: None,
            colour: None,
            feature: None,
            package: "",
            digits: 9,
            stands_in: None,
        }
    }

    /// Returns the program behind the engine: `exudyn` of `exudyn-own-contact`.
    #[must_use]
    pub fn family(&self) -> &'a str {
        family(self.name)
    }
}

/// Returns the first word of an engine's name.
#[must_use]
pub fn family(name: &str) -> &str {
    name.split_once('-').map_or(name, |(family, _)| family)
}
