//! Static facts of an engine.

use pinwheel_compare::model::ModelTolerance;
use pinwheel_mbs::integrators::{self, UNSEEN};
use pinwheel_scene::Scene;
use pinwheel_timeseries::SharedModel;
use serde::{Deserialize, Serialize};

use crate::own_contact::OwnContact;

/// Setting that controls accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum AccuracySetting {
    /// Key `solver.step_s`.
    #[serde(rename(serialize = "step-s", deserialize = "solver.step_s"))]
    Step,
    /// Key `solver.tolerance`.
    #[serde(rename(serialize = "tolerance", deserialize = "solver.tolerance"))]
    Tolerance,
}

impl AccuracySetting {
    /// Returns the accuracy setting of a native integrator.
    pub fn of(method: &str) -> Self {
        match integrators::method(method).is_some_and(|method| method.adaptive) {
            true => Self::Tolerance,
            false => Self::Step,
        }
    }

    /// Returns the value of the setting: a step, s, or a tolerance.
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

/// Accuracy setting of an engine with the order of its error.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Setting to be reduced.
    #[serde(rename = "key")]
    pub knob: AccuracySetting,
    /// Order of the error in the setting.
    pub order: f64,
}

impl Refinement {
    /// Returns a refinement by `solver.step_s`.
    pub const fn step(order: f64) -> Self {
        Self {
            knob: AccuracySetting::Step,
            order,
        }
    }

    /// Returns a refinement by `solver.tolerance`.
    pub const fn tolerance(order: f64) -> Self {
        Self {
            knob: AccuracySetting::Tolerance,
            order,
        }
    }
}

/// Formulation of a native engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Reduced form: centre-pinned bodies eliminated.
    Reduced,
    /// Lagrange form: all bodies, Eq. 2.
    Lagrange,
    /// Reduced form, refined until the step no longer matters.
    Resolved,
}

/// Static facts of an engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineInfo<'a> {
    /// Name as typed by users, kebab-case; names of foreign engines include the shared parts.
    pub name: &'a str,
    /// Short name, used beside the shared parts.
    pub short: &'a str,
    /// Parts that the engine shares with the native solver.
    pub track: SharedModel,
    /// Description in one line.
    pub summary: &'a str,
    /// Differences from the native solver, in plain words, for the report.
    pub differences: &'a str,
    /// Key of the scene that controls accuracy, with the order of the error; `None` without one, and for native engines, whose
    /// integrators have their own.
    pub refinement: Option<Refinement>,
    /// Relative error of the forces from iterations, at any step.
    pub floor: f64,
    /// Error that coarser runs of the engine do not reveal, as a share of the tolerance.
    pub shared_error: f64,
    /// Contacts of the engine that replace the scene's contact law.
    pub own_contact: OwnContact,
    /// Tolerances of the engine's contact model against the native one.
    pub model: &'a [ModelTolerance],
    /// True if friction is evaluated explicitly, which requires short steps.
    pub explicit_friction: bool,
    /// True if the engine runs in a separate process, with its own CPU time.
    pub outside: bool,
    /// True if the engine runs in the process's single Python interpreter: one such engine at a time.
    pub in_python: bool,
    /// True for a user's solver: a comparison must give evidence for it.
    pub brought: bool,
    /// Formulation of a native engine.
    pub form: Option<Form>,
    /// Index of the colour on every page; `None` for a colour derived from the name.
    pub colour: Option<usize>,
    /// Cargo feature of the builds with the engine; `None` for all builds.
    pub feature: Option<&'a str>,
    /// Package whose pinned version is the engine's version.
    pub package: &'a str,
    /// Significant digits of recordings, for a rounding of a thousandth of the engine's limits.
    pub digits: usize,
    /// CPU time of its runs in a comparison on `paper`, s.
    pub usual_s: f64,
    /// Rank among the substitutes for Adams beside the paper's figures: multibody programs with their own contacts.
    pub stands_in: Option<usize>,
}

impl<'a> EngineInfo<'a> {
    /// Returns default facts of an engine.
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
            usual_s: 10.0,
            stands_in: None,
        }
    }

    /// Returns the program of the engine: `exudyn` for `exudyn-own-contact`.
    pub fn family(&self) -> &'a str {
        family(self.name)
    }
}

/// Returns the first word of an engine's name.
pub fn family(name: &str) -> &str {
    name.split_once('-').map_or(name, |(family, _)| family)
}
