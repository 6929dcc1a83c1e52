//! The one interface of all engines.

use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_courses::Courses;
use pinwheel_gearbox::channels::Channels;
use pinwheel_gearbox::energy::EnergyAudit;
use pinwheel_gearbox::resolve::Uncertainty;
use pinwheel_gearbox::scene::Scene;
use serde::{Deserialize, Serialize};

/// Which comparison an engine belongs to. Tracks are never mixed in one table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Track {
    /// Pinwheel's own solver; stands in both tables.
    Native,
    /// Foreign bodies, joints and time integration; contact forces from our law inside the engine's step.
    SharedLaw,
    /// The engine detects or resolves contact itself.
    OwnContact,
}

impl Track {
    /// The word used in reports and files.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::SharedLaw => "shared-law",
            Self::OwnContact => "own-contact",
        }
    }
}

/// What one run did and cost.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunStats {
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time of the running thread, s.
    pub cpu_s: f64,
    /// Evaluations of the contact forces inside the integration (samples not counted).
    pub rhs_calls: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps (adaptive methods).
    pub rejected_steps: u64,
    /// Degrees of freedom integrated (velocities, not coordinates with their rates).
    pub degrees_of_freedom: usize,
    /// Bodies the engine moves.
    pub bodies: usize,
    /// Step in use, s (the mean accepted step of adaptive methods).
    pub step_s: f64,
    /// The engine's own settings in words, e.g. `reduced, rk2`.
    pub settings: String,
    /// Largest position error of any joint, m, where the engine has constraints.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub joint_drift_m: Option<f64>,
    /// Energy account of the whole run and of its second half, where the engine keeps one.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub energy: Vec<EnergyAudit>,
    /// Remarks for the reader (approximations, guards that fired).
    pub notes: Vec<String>,
    /// The numerical uncertainty of the courses, where the engine verified them itself (`auto`, `native-resolved`).
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub uncertainty: Option<Uncertainty>,
    /// For courses that were recorded earlier and not computed now: when, with what, and why they stand here.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub recorded: Option<String>,
}

/// A finished run.
#[derive(Debug, Clone)]
pub struct Run {
    /// The contract's columns on the scene's sample times.
    pub courses: Courses,
    /// Cost and settings.
    pub stats: RunStats,
}

impl Run {
    /// Adds a note if channels that the scene asks for are not among the courses.
    pub fn note_missing_channels(&mut self, scene: &Scene) {
        let Ok(asked) = Channels::of(scene) else {
            return;
        };
        let missing = asked.without(|name| self.courses.channel(name).is_some());
        if missing.is_empty() {
            return;
        }
        let families: Vec<&str> = missing
            .families()
            .into_iter()
            .map(|(family, _)| family.pattern)
            .collect();
        self.stats.notes.push(format!(
            "This engine does not know {} of the {} channels asked for: {}.",
            missing.len(),
            asked.len(),
            families.join(", ")
        ));
    }
}

/// Why a run gave no complete courses.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The engine cannot honour the scene; it never approximates in silence.
    #[error("{engine} cannot run this scene: {reason}")]
    Unsupported {
        /// Engine name.
        engine: String,
        /// Which part of the scene and why.
        reason: String,
    },
    /// The numbers ran away.
    #[error("{engine} diverged at t = {time_s:.6} s: {quantity}")]
    Diverged {
        /// Engine name.
        engine: String,
        /// When, s.
        time_s: f64,
        /// Which quantity and its value.
        quantity: String,
        /// What was computed until then.
        partial: Box<Run>,
    },
    /// The user asked to stop.
    #[error("stopped")]
    Cancelled,
    /// The engine is not there or broke.
    #[error("{engine} failed: {reason}")]
    Failed {
        /// Engine name.
        engine: String,
        /// Its own words.
        reason: String,
    },
}

/// Cancellation and progress of one run. Cheap enough to be asked at every sample.
pub struct Control<'a> {
    /// Set from outside (Ctrl-C) to stop the run.
    pub cancel: &'a AtomicBool,
    /// Receives simulated seconds as they pass.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl Control<'_> {
    /// A control that never cancels and reports nothing.
    #[must_use]
    pub fn quiet() -> Control<'static> {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Control {
            cancel: &NEVER,
            progress: &|_| {},
        }
    }

    /// Reports the simulated time; true when the run must stop.
    #[must_use]
    pub fn reached(&self, time_s: f64) -> bool {
        (self.progress)(time_s);
        self.cancel.load(Ordering::Relaxed)
    }
}

/// A solver that turns a scene into courses.
pub trait Engine: Send + Sync {
    /// Name as typed by users, kebab-case, with the track in foreign engines' names.
    fn name(&self) -> &'static str;
    /// Which comparison it belongs to.
    fn track(&self) -> Track;
    /// Version of the engine behind it.
    fn version(&self) -> String;
    /// One line for `pinwheel engines`.
    fn summary(&self) -> &'static str;
    /// How it differs from the native solver, in plain words, for the report.
    fn differences(&self) -> &'static str;
    /// Whether it honours the scene.
    ///
    /// # Errors
    /// [`EngineError::Unsupported`] with the reason.
    fn supports(&self, scene: &Scene) -> Result<(), EngineError>;
    /// Runs the scene.
    ///
    /// # Errors
    /// Any [`EngineError`]; a divergence keeps what was computed.
    fn run(&self, scene: &Scene, control: &Control<'_>) -> Result<Run, EngineError>;
}
