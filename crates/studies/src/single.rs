//! Run of one scene on one engine, with its files: time series and `run.json` with scene, ending, cost and machine.

use std::path::Path;
use std::time::Duration;

use pinwheel_engines::{Engine, Form, Halt, Run, RunStats, SharedModel};
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::auto::AUTO;
use pinwheel_gearbox::resolve::{self, Uncertainty};
use pinwheel_scene::{Assumption, CheckedScene, Formulation, Scene, assumptions};
use pinwheel_timeseries::{Ending, TimeSeries};
use serde::Serialize;

use crate::StudyError;
use crate::band::{self, Bands};
use crate::control::{Control, Progress, of_scene};
use crate::design::limits::Limits;
use crate::motion::Motion;
use crate::output::{OutputError, write_json};
use crate::provenance::{Machine, Provenance};
use crate::resolution::{self, Resolution};
use crate::results::{self, Results};

/// Record of one run without its time series, the content of `run.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct RunRecord<'a> {
    pub(crate) engine: &'a str,
    pub(crate) version: &'a str,
    pub(crate) track: &'a str,
    status: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    diverged_at_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diverged_quantity: Option<&'a str>,
    /// Name of the file with the samples, in the same folder.
    #[serde(rename = "courses")]
    time_series: &'static str,
    samples: usize,
    #[serde(flatten)]
    pub(crate) stats: &'a RunStats,
    /// Evidence of the run at twice the step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) resolution: Option<&'a Resolution>,
    /// Numerical uncertainty stated by the engine.
    #[serde(
        rename = "numerical_uncertainty",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) uncertainty: Option<&'a Uncertainty>,
    /// Results of the run with their uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    results: Option<&'a Results>,
    /// Figures with other contact laws and fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    by_contact_law: Option<&'a Bands>,
    scene: &'a Scene,
    /// Values of the scene that are not in its file.
    assumptions: Vec<Assumption>,
    pinwheel_version: &'static str,
    machine: &'a Machine,
}

/// Longest wall time of the trial of a remedy.
const TRIED_WITHIN: Duration = Duration::from_secs(1);

/// Returns the remedy for a run that diverged or whose step does not resolve its scene: `auto`, first tried if that takes
/// under a second. The text continues an error message after a semicolon.
pub fn remedy(gearbox: &Gearbox, track: SharedModel) -> String {
    if track != SharedModel::Native {
        return "try a smaller solver.step_s, or the engine native-resolved".to_owned();
    }
    resolve::remedy(&gearbox.scene, TRIED_WITHIN).unwrap_or_else(|| {
        match gearbox.scene.solver.integrator == AUTO {
            true => {
                let load = gearbox.scene.drive.output_torque_n_m;
                format!(
                    "solver.integrator is \"auto\" already, which chooses its steps itself: see whether this gear bears its load, \
                     drive.output_torque_n_m = {load}"
                )
            }
            false => "make solver.step_s or solver.tolerance smaller, or set solver.integrator to \"auto\", which chooses and \
                      checks its method itself"
                .to_owned(),
        }
    })
}

/// Writes time series as CSV.
pub(crate) fn save(time_series: &TimeSeries, path: &Path) -> Result<(), OutputError> {
    let written = time_series.save_csv(path);
    written.map_err(|error| OutputError::new(path, &error))
}

/// Returns the name of the time series' file for a run with this ending.
pub fn file(ending: &Ending) -> &'static str {
    if ending.is_finished() {
        "courses.csv"
    } else {
        "courses.partial.csv"
    }
}

/// Checks that `engine` supports the scene of `gearbox`.
///
/// # Errors
/// Cancelled, or [`StudyError::Ended`] with the reason.
pub fn prepare(engine: &dyn Engine, gearbox: &Gearbox) -> Result<(), StudyError> {
    match engine.prepare(gearbox) {
        Ok(_) => Ok(()),
        Err(Halt::Cancelled(cancelled)) => Err(cancelled.into()),
        Err(Halt::Ended(ending)) => Err(StudyError::ended(engine, ending)),
    }
}

/// Run of one scene on one engine.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Name of the engine.
    pub engine: String,
    /// Version of the engine.
    pub version: String,
    /// Parts of the model that the engine shares with the native solver.
    pub track: SharedModel,
    /// Scene that was run.
    pub scene: CheckedScene,
    /// Time series, cost and ending; a run that diverged ends early.
    pub run: Run,
    /// Evidence of the run at twice the step, if origin.
    pub resolution: Option<Resolution>,
    /// Figures with other contact laws and fits; `None` if they were not requested or there are no other laws.
    pub bands: Option<Bands>,
    /// Loads of the parts against their limits, for a page.
    pub limits: Option<Limits>,
    /// Motion of the gearbox, for a page.
    pub motion: Option<Motion>,
}

/// Runs the scene of `gearbox` on `engine`; `checked`: repeats a native run at twice its step to check its resolution. A
/// divergence is a result.
///
/// # Errors
/// Cancelled; an engine that cannot run the scene or fails.
pub fn run(
    gearbox: &Gearbox,
    engine: &dyn Engine,
    checked: bool,
    control: &Control<'_>,
) -> Result<Outcome, StudyError> {
    let scene = &gearbox.scene;
    let at = Progress::new(0, 1, engine.name());
    let run = engine.run_compiled(gearbox, &control.piece(at))?;
    if !matches!(run.ending, Ending::Finished | Ending::Diverged { .. }) {
        return Err(StudyError::ended(engine, run.ending));
    }
    // A run with its own uncertainty needs no second run.
    let resolution = if run.ending.is_finished() && checked && run.uncertainty.is_none() {
        check(engine, gearbox, &run, control)?
    } else {
        None
    };
    Ok(Outcome {
        engine: engine.name().to_owned(),
        version: engine.version(),
        track: engine.track(),
        scene: scene.clone(),
        run,
        resolution,
        bands: None,
        limits: None,
        motion: None,
    })
}

/// Returns the evidence of a native run at twice its step; `None` for the resolved engine, which ignores the scene's step.
fn check(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    run: &Run,
    control: &Control<'_>,
) -> Result<Option<Resolution>, StudyError> {
    let formulation = match engine.info().form {
        Some(Form::Reduced) => Formulation::Reduced,
        Some(Form::Lagrange) => Formulation::Lagrange,
        Some(Form::Resolved) | None => return Ok(None),
    };
    let formed = gearbox.with_solver(|solver| solver.formulation = formulation);
    let formed = formed.map_err(|fault| of_scene(&gearbox.scene, fault.into()))?;
    let label = format!("{} once more, coarser", engine.name());
    let at = control.piece(Progress::new(0, 1, &label));
    let at = at.lasting(formed.scene.solver.duration_s);
    let from_s = results::from_s(run, &gearbox.scene);
    let ran = (&run.time_series, run.stats.rhs_calls);
    match resolution::check(&formed, ran, from_s, &mut |t| at.reached(t)) {
        Ok(result) => Ok(Some(result)),
        Err(StudyError::Cancelled) => Err(StudyError::Cancelled),
        Err(error) => Err(StudyError::Unrepeated(Box::new(error))),
    }
}

impl Outcome {
    /// Adds the figures with other contact laws and fits.
    ///
    /// # Errors
    /// Cancelled.
    pub fn with_bands(self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Self, StudyError> {
        let bands = band::of(gearbox, control)?;
        Ok(Self { bands, ..self })
    }

    /// Adds limits and motion.
    ///
    /// # Errors
    /// Cancelled.
    pub fn for_page(self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Self, StudyError> {
        Ok(Self {
            limits: Limits::of_gear(gearbox, self.bands.as_ref(), control.cancel)?,
            motion: Motion::of(gearbox, control)?,
            ..self
        })
    }

    /// Returns time and quantity of a divergence in words; `None` for other endings.
    pub fn diverged(&self) -> Option<String> {
        let ending = &self.run.ending;
        (!ending.is_finished()).then(|| format!("{} {ending}", self.engine))
    }

    /// Returns the results of the run.
    pub fn results(&self) -> Results {
        self.results_from(results::from_s(&self.run, &self.scene))
    }

    /// Returns the results from the sample `from_s` on, without those of the energy balance's window.
    pub fn results_from(&self, from_s: f64) -> Results {
        let verified = self.run.uncertainty.as_ref().and_then(|u| u.error);
        let estimated = self.resolution.as_ref().and_then(|r| r.error);
        let known = match (verified, estimated) {
            (Some(_), _) => "verified",
            (None, Some(_)) => "estimated",
            (None, None) => "not verified",
        };
        let known = (known, verified.or(estimated));
        Results::of(&self.run, &self.scene, from_s, known, self.bands.as_ref())
    }

    /// Returns a message with a remedy if the step or tolerance does not resolve the scene.
    pub fn unresolved(&self, gearbox: &Gearbox) -> Option<String> {
        let resolution = self.resolution.as_ref();
        if let Some(resolution) = resolution.filter(|resolution| !resolution.holds()) {
            return Some(format!(
                "the step does not resolve this scene: {}; {}",
                resolution.sentence(),
                remedy(gearbox, self.track)
            ));
        }
        let verified = self.run.uncertainty.as_ref();
        let verified = verified.filter(|uncertainty| !uncertainty.is_resolved())?;
        Some(verified.sentence())
    }

    /// Writes `run.json` with the run's [`results`](Self::results) and `courses.csv`, or `courses.partial.csv` if the run
    /// diverged, into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(
        &self,
        dir: &Path,
        origin: &Provenance,
        results: &Results,
    ) -> Result<(), OutputError> {
        let engine = (&*self.engine, &*self.version, self.track);
        let (ending, stats) = (&self.run.ending, &self.run.stats);
        let record = RunRecord {
            resolution: self.resolution.as_ref(),
            uncertainty: self.run.uncertainty.as_ref(),
            results: ending.is_finished().then_some(results),
            by_contact_law: self.bands.as_ref(),
            ..RunRecord::new(engine, &self.scene, ending, stats, origin)
        };
        record.write(dir, &self.run.time_series)
    }
}

impl<'a> RunRecord<'a> {
    /// Returns the record of a run of `engine` (name, version, shared model).
    pub(crate) fn new(
        (engine, version, track): (&'a str, &'a str, SharedModel),
        scene: &'a CheckedScene,
        ending: &'a Ending,
        stats: &'a RunStats,
        origin: &'a Provenance,
    ) -> Self {
        let (diverged_at_s, diverged_quantity) = match ending {
            Ending::Diverged { time_s, quantity } => (Some(*time_s), Some(quantity.as_str())),
            _ => (None, None),
        };
        Self {
            engine,
            version,
            track: track.as_str(),
            status: ending.word(),
            diverged_at_s,
            diverged_quantity,
            time_series: file(ending),
            samples: 0,
            stats,
            resolution: None,
            uncertainty: None,
            results: None,
            by_contact_law: None,
            scene,
            assumptions: assumptions(scene),
            pinwheel_version: origin.version,
            machine: &origin.machine,
        }
    }

    /// Writes the record beside the time series into the folder `dir`.
    pub(crate) fn write(mut self, dir: &Path, time_series: &TimeSeries) -> Result<(), OutputError> {
        self.samples = time_series.len();
        save(time_series, &dir.join(self.time_series))?;
        write_json(&dir.join("run.json"), &self)
    }
}
