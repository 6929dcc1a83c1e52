//! Recorded time series: an engine's results for a scene, for builds and machines without it.
//!
//! `reference/recorded/SCENE/ENGINE.toml` describes a recording; `ENGINE.csv` beside it has the time series, thinned and
//! rounded. Both are embedded in the program. A recording replaces a run of its own scene only, and is never interpolated.

use std::fmt::Write as _;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Scene, Solver};
use pinwheel_timeseries::norms::rows_at;
use pinwheel_timeseries::{RecordedUncertainty, TimeSeries};
use serde::{Deserialize, Serialize};

use crate::control::Cancelled;
use crate::engine::{Ending, Engine, Halt, Prepared, Run, RunStats, prepared};
use crate::info::{AccuracySetting, EngineInfo};
use crate::known::info;
use crate::registry::{lacking, remedy};

/// Files of the recordings: path below their folder, text.
const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/recorded.rs"));

/// Spacing of recorded samples, s: 51 samples in the transient window, 301 in the steady one of 0.6 s.
pub const SAMPLE_S: f64 = 1e-3;

/// Scenes with recordings.
pub const RECORDED_SCENES: [&str; 6] = [
    "paper",
    "paper-friction",
    "backlash-0.6",
    "steel",
    "eleven-pins",
    "forty-pins",
];

/// Time series of one engine for one scene.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Engine name.
    pub engine: String,
    /// Version of the engine.
    pub version: String,
    /// Day of the recording, `2026-01-31`.
    pub date: String,
    /// Command that repeats the recording.
    pub command: String,
    /// Machine of the recording.
    pub machine: String,
    /// Significant digits of the time series' largest values.
    pub digits: usize,
    /// Cost and settings of the recorded run.
    pub stats: RunStats,
    /// Complete scene.
    pub scene: Scene,
    /// Uncertainties of the recorded quantities, window by window; empty if no setting refines the engine.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub uncertainty: Vec<RecordedUncertainty>,
    /// Time series at samples [`SAMPLE_S`] apart.
    #[serde(skip)]
    pub time_series: TimeSeries,
}

/// Fault of a recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// Description that cannot be read.
    #[error(
        "the description of the recording is broken: {0}; record it again with `pinwheel record`"
    )]
    Description(#[from] toml::de::Error),
    /// Description that cannot be written.
    #[error("the description of the recording cannot be written: {0}")]
    Unwritable(#[from] toml::ser::Error),
    /// Time series that cannot be read.
    #[error("the recorded time series are broken: {0}; record them again with `pinwheel record`")]
    TimeSeries(#[from] pinwheel_timeseries::TimeSeriesError),
}

impl Recording {
    /// Makes a recording of a run with [`thinned`] time series, which are rounded on writing.
    pub fn new(
        engine: &dyn Engine,
        scene: &Scene,
        stats: RunStats,
        time_series: TimeSeries,
        uncertainty: Vec<RecordedUncertainty>,
    ) -> Self {
        let digits = engine.info().digits;
        Self {
            engine: engine.name().to_owned(),
            version: engine.version(),
            date: String::new(),
            command: String::new(),
            machine: String::new(),
            digits,
            stats,
            scene: scene.clone(),
            uncertainty,
            time_series,
        }
    }

    /// Returns description and time series as text.
    ///
    /// # Errors
    /// See [`RecordingError`].
    pub fn write(&self) -> Result<(String, String), RecordingError> {
        Ok((toml::to_string(self)?, self.csv()))
    }

    /// Reads the output of [`Recording::write`].
    ///
    /// # Errors
    /// See [`RecordingError`].
    pub fn read(description: &str, csv: &str) -> Result<Self, RecordingError> {
        let mut recording: Self = pinwheel_files::parse(description)?;
        recording.time_series = TimeSeries::read_csv(csv.as_bytes())?;
        Ok(recording)
    }

    /// Returns the time series as CSV, with the decimals that each quantity's largest value requires.
    pub fn csv(&self) -> String {
        let channels = self.time_series.channels();
        let decimals: Vec<usize> = channels
            .iter()
            .map(|channel| {
                let group = pinwheel_timeseries::group_of(&channel.name).0;
                let peak = channels
                    .iter()
                    .filter(|other| pinwheel_timeseries::group_of(&other.name).0 == group)
                    .flat_map(|other| &other.values)
                    .fold(0.0_f64, |peak, value| peak.max(value.abs()));
                let leading = if peak > 0.0 {
                    peak.log10().floor()
                } else {
                    0.0
                };
                (self.digits as f64 - 1.0 - leading).clamp(0.0, 15.0) as usize
            })
            .collect();
        let mut text = String::from("time_s");
        for channel in channels {
            let _ = write!(text, ",{}", channel.name);
        }
        for (row, time_s) in self.time_series.time_s().iter().enumerate() {
            let _ = write!(text, "\n{}", trimmed(*time_s, 9));
            for (channel, &decimals) in channels.iter().zip(&decimals) {
                let _ = write!(text, ",{}", trimmed(channel.values[row], decimals));
            }
        }
        text.push('\n');
        text
    }

    /// True if a run of `scene` would be this recording, or its beginning: all keys agree, except those that name the scene,
    /// belong to the native solver, or select samples.
    pub fn is_of(&self, scene: &Scene) -> bool {
        let refinement = info(&self.engine).and_then(|info| info.refinement);
        let by_tolerance =
            refinement.is_some_and(|refined| refined.knob == AccuracySetting::Tolerance);
        let setting = |own: &Solver| {
            let mut solver = Scene::paper().solver;
            if by_tolerance {
                solver.tolerance = own.tolerance;
            } else {
                solver.step_s = own.step_s;
            }
            solver
        };
        let alike = |scene: &Scene| Scene {
            solver: setting(&scene.solver),
            ..bare(scene)
        };
        alike(scene) == alike(&self.scene)
            && scene.solver.duration_s <= self.scene.solver.duration_s * (1.0 + 1e-12)
    }

    /// Returns the recorded samples that a run of `scene` would have.
    pub fn at_samples_of(&self, scene: &Scene) -> TimeSeries {
        let wanted = scene.solver.sample_times_s();
        let rows = rows_at(&wanted, self.time_series.time_s());
        let rows: Vec<usize> = rows.flatten().collect();
        self.time_series.select(&rows)
    }
}

/// Returns the scene without keys that affect no run: its names, and the uncertainty of its values.
pub(crate) fn bare(scene: &Scene) -> Scene {
    Scene {
        name: String::new(),
        description: String::new(),
        uncertain: Default::default(),
        ..scene.clone()
    }
}

/// Selects the recorded samples, [`SAMPLE_S`] apart.
pub fn thinned(time_series: &TimeSeries, scene: &Scene) -> TimeSeries {
    let every = (SAMPLE_S / scene.solver.sample_s).round().max(1.0) as usize;
    let rows: Vec<usize> = (0..time_series.len()).step_by(every).collect();
    time_series.select(&rows)
}

/// Formats a number without superfluous zeros and without a sign of zero.
fn trimmed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    match text {
        "-0" | "" => "0".to_owned(),
        text => text.to_owned(),
    }
}

/// Checks that a run resolves its scene well enough to be recorded.
///
/// # Errors
/// Reason of a refusal, in words.
pub fn worth_keeping(engine: &str, scene: &Scene) -> Result<(), String> {
    let explicit = info(engine).is_some_and(|info| info.explicit_friction);
    if explicit && scene.slides() && scene.solver.step_s > EXPLICIT_FRICTION_STEP_S {
        return Err(format!(
            "its friction is explicit and takes steps of {EXPLICIT_FRICTION_STEP_S:e} s to resolve"
        ));
    }
    Ok(())
}

/// Step at which explicit methods resolve regularised friction of the paper's gear, s.
const EXPLICIT_FRICTION_STEP_S: f64 = 2e-7;

/// Returns scene and engine of every recording of this build.
pub fn list() -> impl Iterator<Item = (&'static str, &'static str)> {
    FILES
        .iter()
        .filter_map(|(name, _)| name.strip_suffix(".toml")?.split_once('/'))
}

/// Returns the recording of an engine and a scene, by their names.
///
/// The inner error is that of a damaged recording.
pub fn find(scene: &str, engine: &str) -> Option<Result<Recording, RecordingError>> {
    let text = |ending: &str| {
        let name = format!("{scene}/{engine}.{ending}");
        let file = FILES.iter().find(|(path, _)| *path == name);
        file.map(|(_, text)| *text)
    };
    Some(Recording::read(text("toml")?, text("csv")?))
}

/// Returns a recording of `engine` that replaces a run of `scene`; `why` is the reason for readers.
pub fn instead(engine: &str, scene: &Scene, why: &str) -> Option<Box<dyn Engine>> {
    let info = info(engine)?;
    let recording = list()
        .filter(|&(_, recorded)| recorded == engine)
        .filter_map(|(name, _)| find(name, engine)?.ok())
        .find(|recording| recording.is_of(scene))?;
    Some(Box::new(Recorded {
        info,
        recording,
        why: why.to_owned(),
    }))
}

/// Returns the recordings for a scene of all engines that this build lacks.
pub fn missing(scene: &Scene) -> Vec<Box<dyn Engine>> {
    lacking()
        .filter_map(|info| in_place_of_lacking(info.name, scene))
        .collect()
}

/// Returns the recording of an engine that this build lacks.
pub fn in_place_of_lacking(engine: &str, scene: &Scene) -> Option<Box<dyn Engine>> {
    let remedy = remedy(info(engine)?)?;
    instead(engine, scene, &format!("it is not here ({remedy})"))
}

/// True if an engine may be missing in a build or on a machine, so that recordings of it are of use.
pub fn may_be_missing(engine: &str) -> bool {
    info(engine).is_some_and(|info| info.feature == Some("crossval"))
}

/// Recording in the place of an engine.
struct Recorded {
    info: &'static EngineInfo<'static>,
    recording: Recording,
    why: String,
}

impl Engine for Recorded {
    /// Returns the engine's facts without a refinement.
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            refinement: None,
            ..*self.info
        }
    }

    fn version(&self) -> String {
        format!("{}, recorded", self.recording.version)
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        if !self.recording.is_of(&gearbox.scene) {
            return Err(Ending::unsupported("there is no recording of it").into());
        }
        Ok(prepared(gearbox.clone(), |gearbox, control| {
            let scene = &gearbox.scene;
            if control.reached(scene.solver.duration_s) {
                return Err(Cancelled.into());
            }
            let (of, why) = (&self.recording, &self.why);
            let recorded = format!(
                "Recorded on {} with {} on {} by `{}`, because {why}.",
                of.date, of.version, of.machine, of.command
            );
            let stats = RunStats {
                recorded: Some(recorded),
                recorded_uncertainty: of.uncertainty.clone(),
                ..of.stats.clone()
            };
            Ok(Run::new(of.at_samples_of(scene), stats))
        }))
    }
}
