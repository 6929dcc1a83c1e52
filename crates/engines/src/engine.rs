//! The one interface of all engines.

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

/// A run, however it ended.
#[derive(Debug, Clone)]
pub struct Run {
    /// Columns of the contract at the scene's sample times; a run that ended early has only the samples until its end.
    pub time_series: TimeSeries,
    /// Ending of the run.
    pub ending: Ending,
    /// Cost and settings.
    pub stats: RunStats,
    /// The numerical uncertainty of the time series, where the engine verified them itself (`auto`, `native-resolved`).
    pub uncertainty: Option<Uncertainty>,
    /// Figures that no time series holds, of what has none.
    pub figures: Vec<Figure>,
}

impl Run {
    /// A finished run of an engine that knows nothing of its uncertainty.
    #[must_use]
    pub fn new(time_series: TimeSeries, stats: RunStats) -> Self {
        Self {
            time_series,
            ending: Ending::Finished,
            stats,
            uncertainty: None,
            figures: Vec::new(),
        }
    }

    /// A run that ended without time series.
    #[must_use]
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

    /// The run if it finished.
    ///
    /// # Errors
    /// Any other ending.
    pub fn whole(self) -> Result<Self, Ending> {
        self.ending.whole().map(|()| self)
    }

    /// Adds a note if channels that the scene asks for are not among the time series.
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
            "This engine does not know {} of the {} channels asked for: {}.",
            missing.len(),
            asked.len(),
            families.join(", ")
        ));
    }
}

/// Reason why an engine stops, for `?` in the code of an engine. The caller of an engine gets an [`Ending`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Halt {
    /// The user asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The run ends here, without time series.
    #[error(transparent)]
    Ended(#[from] Ending),
}

/// A halt as a run, unless the user asked for it.
pub(crate) fn settled(ran: Result<Run, Halt>) -> Result<Run, Cancelled> {
    match ran {
        Ok(run) => Ok(run),
        Err(Halt::Ended(ending)) => Ok(Run::ended(ending)),
        Err(Halt::Cancelled(cancelled)) => Err(cancelled),
    }
}

/// A solver that turns a scene into time series.
///
/// One that keeps every body as it starts, recorded as all engines record:
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
    /// Changes when the engine is built anew under the same version; empty where it is part of this program.
    fn build(&self) -> String {
        String::new()
    }
    /// Says whether it honours the scene of `gearbox`, and makes everything ready that a run needs. A caller that runs
    /// a scene on several engines compiles it once.
    ///
    /// # Errors
    /// Ending of a run that cannot begin: unsupported, or absent on this machine.
    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt>;

    /// Returns an earlier run of the compiled scene that was kept; `most` is the CPU time that a run may take. See
    /// [`Store`](crate::kept::Store).
    fn kept(&self, _gearbox: &Gearbox, _most: Option<Duration>) -> Option<Run> {
        None
    }

    /// Keeps a run that took at most `most`, if runs of this engine are kept.
    fn keep(&self, _gearbox: &Gearbox, _run: &Run, _most: Option<Duration>) {}

    /// Name as typed by users.
    fn name(&self) -> &str {
        self.info().name
    }

    /// Parts that the engine shares with the native solver.
    fn track(&self) -> SharedModel {
        self.info().track
    }

    /// Checks that the engine honours the scene.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn supports(&self, scene: &CheckedScene) -> Result<(), Halt> {
        self.prepare(&compile(None, scene)?).map(|_| ())
    }

    /// Compiles, prepares and runs a scene.
    ///
    /// # Errors
    /// Only that the user asked to stop: what an engine does wrong is an [`Ending`] of the run.
    fn run(&self, scene: &CheckedScene, control: &Control<'_>) -> Result<Run, Cancelled> {
        self.run_after(&mut None, scene, control)
    }

    /// Runs a scene like [`run`](Self::run), but reuses parts of the gearbox `last` of an earlier run where they are
    /// equal. On return `last` is the gearbox of this run. Results do not depend on it.
    ///
    /// # Errors
    /// As [`run`](Self::run).
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
    /// As [`run`](Self::run).
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

/// An engine made ready for one scene: runs it from its start, and may be called again. A divergence keeps what was computed;
/// an error is a stop, or an ending without time series.
pub type Prepared<'a> = Box<dyn Fn(&Control<'_>) -> Result<Run, Halt> + 'a>;

/// A run of `gearbox` by `run`.
pub(crate) fn prepared<'a>(
    gearbox: Gearbox,
    run: impl Fn(&Gearbox, &Control<'_>) -> Result<Run, Halt> + 'a,
) -> Prepared<'a> {
    Box::new(move |control| run(&gearbox, control))
}

/// The scene compiled, after another.
pub(crate) fn compile(last: Option<&Gearbox>, scene: &CheckedScene) -> Result<Gearbox, Ending> {
    Gearbox::after(last, scene).map_err(Ending::unsupported)
}
