//! Common interface of all engines.

use std::time::Duration;

pub use pinwheel_timeseries::{Ending, RunStats, SharedModel};

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::resolve::Uncertainty;
use pinwheel_scene::channels::Channels;
use pinwheel_scene::{CheckedScene, Scene};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::figure::Figure;

use crate::control::{Cancelled, Control};
use crate::info::EngineInfo;

/// Run with any ending.
#[derive(Debug, Clone)]
pub struct Run {
    /// Columns of the contract at the scene's sample times; a run that ended early has only the samples until its end.
    pub time_series: TimeSeries,
    /// Ending of the run.
    pub ending: Ending,
    /// Cost and settings.
    pub stats: RunStats,
    /// Numerical uncertainty of the time series, if the engine verified them itself (`auto`, `native-resolved`).
    pub uncertainty: Option<Uncertainty>,
    /// Figures of results without time series.
    pub figures: Vec<Figure>,
}

impl Run {
    /// Returns a finished run without a stated uncertainty.
    pub fn new(time_series: TimeSeries, stats: RunStats) -> Self {
        Self {
            time_series,
            ending: Ending::Finished,
            stats,
            uncertainty: None,
            figures: Vec::new(),
        }
    }

    /// Returns a run that ended without time series.
    pub fn ended(ending: Ending) -> Self {
        Self {
            ending,
            ..Self::new(TimeSeries::default(), RunStats::default())
        }
    }

    /// Sets another ending.
    #[must_use]
    pub fn with_ending(self, ending: Ending) -> Self {
        Self { ending, ..self }
    }

    /// Returns the run if it finished.
    ///
    /// # Errors
    /// Any other ending.
    pub fn finished(self) -> Result<Self, Ending> {
        self.ending.finished().map(|()| self)
    }

    /// Adds a note if requested channels are missing in the time series.
    fn note_missing_channels(&mut self, scene: &Scene) {
        let Ok(asked) = Channels::of(scene) else {
            return;
        };
        let missing = asked.without(|name| self.time_series.channel(name).is_some());
        if missing.is_empty() {
            return;
        }
        let families = missing.families().into_iter();
        let families: Vec<&str> = families.map(|(family, _)| family.pattern).collect();
        self.stats.notes.push(format!(
            "This engine does not know {} of the {} requested channels: {}.",
            missing.len(),
            asked.len(),
            families.join(", ")
        ));
    }
}

/// Reason for an engine's stop, for `?` inside an engine. The caller of an engine gets an [`Ending`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Halt {
    /// Stop requested by the user.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// End of the run without time series.
    #[error(transparent)]
    Ended(#[from] Ending),
}

/// Converts a halt to a run, unless the user requested it.
pub(crate) fn settled(ran: Result<Run, Halt>) -> Result<Run, Cancelled> {
    match ran {
        Ok(run) => Ok(run),
        Err(Halt::Ended(ending)) => Ok(Run::ended(ending)),
        Err(Halt::Cancelled(cancelled)) => Err(cancelled),
    }
}

/// Solver that converts a scene to time series.
///
/// Example: an engine that leaves every body at its start, recorded as by all engines:
///
/// ```
/// use pinwheel_engines::{
///     Cancelled, Control, Ending, Engine, EngineInfo, Halt, Prepared, Run, RunStats, SharedModel,
/// };
/// use pinwheel_gearbox::{Gearbox, Recorder};
/// use pinwheel_scene::Scene;
///
/// struct Frozen;
///
/// impl Engine for Frozen {
///     fn info(&self) -> EngineInfo<'_> {
///         EngineInfo::own("frozen", SharedModel::SharedLaw)
///     }
///     fn version(&self) -> String { "1".into() }
///
///     fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
///         if gearbox.has_friction() {
///             return Err(Ending::unsupported("friction needs motion").into());
///         }
///         let gearbox = gearbox.clone();
///         Ok(Box::new(move |control: &Control<'_>| {
///             let bodies = gearbox.initial_states();
///             let mut law = gearbox.contact_field().map_err(Ending::unsupported)?;
///             let mut recorder = Recorder::new(&gearbox);
///             for t in gearbox.scene.solver.sample_times_s() {
///                 recorder.record(t, 0.0, &bodies, &mut law);
///                 if control.reached(t) {
///                     return Err(Cancelled.into());
///                 }
///             }
///             let time_series = recorder.finish().map_err(Ending::failed)?;
///             Ok(Run::new(time_series, RunStats::default()))
///         }))
///     }
/// }
///
/// let scene = Scene::load("paper", &["solver.duration_s=0.001".parse()?])?;
/// let run = Frozen.run(&scene, &Control::quiet())?;
/// assert!(run.ending.is_finished() && run.time_series.len() == 11);
/// let rough = Scene::load("paper-friction", &[])?;
/// assert!(Frozen.supports(&rough).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Engine: Send + Sync {
    /// Facts of the engine that are known without running it.
    fn info(&self) -> EngineInfo<'_>;
    /// Version of the engine behind it.
    fn version(&self) -> String;
    /// Returns a mark that changes with a new build of the same version; empty for engines inside this program.
    fn build(&self) -> String {
        String::new()
    }
    /// Checks that the engine supports the scene of `gearbox`, and prepares a run. For several engines a caller compiles a
    /// scene once.
    ///
    /// # Errors
    /// Ending of a run that cannot begin: unsupported, or absent on this machine.
    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt>;

    /// Returns a stored earlier run of the compiled scene; `most` is the permitted CPU time of a run. See
    /// [`Store`](crate::kept::Store).
    fn kept(&self, _gearbox: &Gearbox, _most: Option<Duration>) -> Option<Run> {
        None
    }

    /// Stores a run of at most `most`, if runs of this engine are stored.
    fn keep(&self, _gearbox: &Gearbox, _run: &Run, _most: Option<Duration>) {}

    /// Name as typed by users.
    fn name(&self) -> &str {
        self.info().name
    }

    /// Returns the parts that the engine shares with the native solver.
    fn track(&self) -> SharedModel {
        self.info().track
    }

    /// Checks that the engine supports the scene.
    ///
    /// # Errors
    /// Errors of [`prepare`](Self::prepare).
    fn supports(&self, scene: &CheckedScene) -> Result<(), Halt> {
        self.prepare(&compile(None, scene)?).map(|_| ())
    }

    /// Compiles, prepares and runs a scene.
    ///
    /// # Errors
    /// A stop by the user only: failures of an engine are an [`Ending`] of the run.
    fn run(&self, scene: &CheckedScene, control: &Control<'_>) -> Result<Run, Cancelled> {
        self.run_after(&mut None, scene, control)
    }

    /// Runs a scene like [`run`](Self::run), but reuses equal parts of the gearbox `last` of an earlier run. On return `last`
    /// is the gearbox of this run. Results do not depend on it.
    ///
    /// # Errors
    /// Errors of [`run`](Self::run).
    fn run_after(
        &self,
        last: &mut Option<Gearbox>,
        scene: &CheckedScene,
        control: &Control<'_>,
    ) -> Result<Run, Cancelled> {
        match compile(last.as_ref(), scene) {
            Ok(gearbox) => self.run_compiled(last.insert(gearbox), control),
            Err(ending) => Ok(Run::ended(ending)),
        }
    }

    /// Prepares and runs a compiled scene.
    ///
    /// # Errors
    /// Errors of [`run`](Self::run).
    fn run_compiled(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, Cancelled> {
        control.check()?;
        let control = control.lasting(gearbox.scene.solver.duration_s);
        let prepared = self.prepare(gearbox);
        let mut run = settled(prepared.and_then(|prepared| prepared(&control)))?;
        control.check()?;
        if run.ending.is_finished() || !run.time_series.is_empty() {
            if gearbox.has_friction() && self.info().explicit_friction {
                let note = "Friction is explicit here, and its regularisation takes steps of about 2e-7 s to resolve.";
                run.stats.notes.push(note.to_owned());
            }
            run.note_missing_channels(&gearbox.scene);
        }
        Ok(run)
    }
}

/// Engine prepared for one scene: runs it from its start at each call. A divergence keeps the samples so far; an error is a
/// stop, or an ending without time series.
pub type Prepared<'a> = Box<dyn Fn(&Control<'_>) -> Result<Run, Halt> + 'a>;

/// Returns a prepared run of `gearbox` by `run`.
pub(crate) fn prepared<'a>(
    gearbox: Gearbox,
    run: impl Fn(&Gearbox, &Control<'_>) -> Result<Run, Halt> + 'a,
) -> Prepared<'a> {
    Box::new(move |control| run(&gearbox, control))
}

/// Compiles the scene, reusing parts of another gearbox.
pub(crate) fn compile(last: Option<&Gearbox>, scene: &CheckedScene) -> Result<Gearbox, Ending> {
    Gearbox::after(last, scene).map_err(Ending::unsupported)
}
