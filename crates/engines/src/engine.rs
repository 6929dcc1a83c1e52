//! The one interface of all engines.

use std::sync::atomic::{AtomicBool, Ordering};

pub use pinwheel_courses::{RunStats, Track};

use pinwheel_courses::Courses;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::resolve::Uncertainty;
use pinwheel_scene::channels::Channels;
use pinwheel_scene::{CheckedScene, Scene};

/// A finished run.
#[derive(Debug, Clone)]
pub struct Run {
    /// The contract's columns on the scene's sample times.
    pub courses: Courses,
    /// Cost and settings.
    pub stats: RunStats,
    /// The numerical uncertainty of the courses, where the engine verified them itself (`auto`, `native-resolved`).
    pub uncertainty: Option<Uncertainty>,
    /// Numbers that no time series holds, of what has none: names with units, and values.
    pub figures: Vec<(&'static str, f64)>,
}

impl Run {
    /// A run of an engine that knows nothing of its uncertainty.
    #[must_use]
    pub fn new(courses: Courses, stats: RunStats) -> Self {
        Self {
            courses,
            stats,
            uncertainty: None,
            figures: Vec::new(),
        }
    }

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
    /// What the engine needs is not on this machine: a package, a compiler, a library.
    #[error("{engine} is not on this machine: {reason}")]
    Absent {
        /// Engine name.
        engine: String,
        /// What is missing, and how to get it.
        reason: String,
    },
    /// The engine broke.
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

/// What is made smaller for more accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knob {
    /// `solver.step_s`.
    Step,
    /// `solver.tolerance`.
    Tolerance,
}

/// How an engine is refined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refinement {
    /// What is made smaller.
    pub knob: Knob,
    /// Order of the error in it.
    pub order: f64,
}

/// A solver that turns a scene into courses.
///
/// One that keeps every body as it starts, recorded as all engines record:
///
/// ```
/// use pinwheel_engines::{Control, Engine, EngineError, Prepared, Run, RunStats, Track};
/// use pinwheel_gearbox::{Gearbox, Recorder};
/// use pinwheel_scene::Scene;
///
/// struct Frozen;
///
/// impl Engine for Frozen {
///     fn name(&self) -> &str { "frozen" }
///     fn track(&self) -> Track { Track::SharedLaw }
///     fn version(&self) -> String { "1".into() }
///     fn summary(&self) -> &str { "nothing moves" }
///     fn differences(&self) -> &str { "integrates nothing" }
///
///     fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Box<dyn Prepared + 'a>, EngineError> {
///         let failed = |reason: String| EngineError::Failed { engine: "frozen".into(), reason };
///         if gearbox.has_friction() {
///             let reason = "friction needs motion".into();
///             return Err(EngineError::Unsupported { engine: "frozen".into(), reason });
///         }
///         let gearbox = gearbox.clone();
///         Ok(Box::new(move |control: &Control<'_>| {
///             let bodies = gearbox.initial_states();
///             let mut law = gearbox.contact_field().map_err(|e| failed(e.to_string()))?;
///             let mut recorder = Recorder::new(&gearbox);
///             for t in gearbox.scene.solver.sample_times_s() {
///                 if control.reached(t) {
///                     return Err(EngineError::Cancelled);
///                 }
///                 recorder.record(t, 0.0, &bodies, law.as_mut());
///             }
///             let courses = recorder.finish().map_err(|e| failed(e.to_string()))?;
///             Ok(Run::new(courses, RunStats::default()))
///         }))
///     }
/// }
///
/// let scene = Scene::load("paper", &["solver.duration_s=0.001".parse()?])?;
/// let run = Frozen.run(&scene, &Control::quiet())?;
/// assert_eq!(run.courses.len(), 11);
/// let rough = Scene::load("paper-friction", &[])?;
/// assert!(Frozen.supports(&rough).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Engine: Send + Sync {
    /// Name as typed by users, kebab-case, with the track in foreign engines' names.
    fn name(&self) -> &str;
    /// Which comparison it belongs to.
    fn track(&self) -> Track;
    /// Version of the engine behind it.
    fn version(&self) -> String;
    /// Changes when the engine is built anew under the same version; empty where it is part of this program.
    fn build(&self) -> String {
        String::new()
    }
    /// One line for `pinwheel engines`.
    fn summary(&self) -> &str;
    /// How it differs from the native solver, in plain words, for the report.
    fn differences(&self) -> &str;
    /// Which key of a scene makes it more accurate, and with which order; `None` where none does, or where comparisons know
    /// better (the native engines).
    fn refinement(&self) -> Option<Refinement> {
        None
    }
    /// Whether it runs in a process of its own, whose CPU time is not this one's.
    fn is_outside(&self) -> bool {
        false
    }
    /// Says whether it honours the scene of `gearbox`, and makes everything ready that a run needs. A caller that runs
    /// a scene on several engines compiles it once.
    ///
    /// # Errors
    /// [`EngineError::Unsupported`] with the reason, or [`EngineError::Absent`] where the engine is not there.
    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Box<dyn Prepared + 'a>, EngineError>;

    /// Whether it honours the scene.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn supports(&self, scene: &CheckedScene) -> Result<(), EngineError> {
        self.prepare(&compile(self.name(), None, scene)?)
            .map(|_| ())
    }

    /// Compiles, prepares and runs a scene.
    ///
    /// # Errors
    /// Any [`EngineError`]; a divergence keeps what was computed.
    fn run(&self, scene: &CheckedScene, control: &Control<'_>) -> Result<Run, EngineError> {
        self.run_after(&mut None, scene, control)
    }

    /// The same after another run, whose gearbox is `last`; afterwards it is this run's. What like gears have in common is
    /// not computed again, and nothing else depends on it.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    fn run_after(
        &self,
        last: &mut Option<Gearbox>,
        scene: &CheckedScene,
        control: &Control<'_>,
    ) -> Result<Run, EngineError> {
        let gearbox = compile(self.name(), last.as_ref(), scene)?;
        self.prepare(last.insert(gearbox))?.run(control)
    }
}

/// An engine made ready for one scene.
pub trait Prepared {
    /// Runs the scene from its start; may be called again.
    ///
    /// # Errors
    /// Any [`EngineError`]; a divergence keeps what was computed.
    fn run(&self, control: &Control<'_>) -> Result<Run, EngineError>;
}

impl<F: Fn(&Control<'_>) -> Result<Run, EngineError>> Prepared for F {
    fn run(&self, control: &Control<'_>) -> Result<Run, EngineError> {
        self(control)
    }
}

/// The scene compiled for `engine`, after another.
pub(crate) fn compile(
    engine: &str,
    last: Option<&Gearbox>,
    scene: &CheckedScene,
) -> Result<Gearbox, EngineError> {
    Gearbox::after(last, scene).map_err(|error| EngineError::Unsupported {
        engine: engine.to_owned(),
        reason: error.to_string(),
    })
}
