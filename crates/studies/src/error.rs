//! Errors of a study.

use std::path::PathBuf;

use pinwheel_engines::{Cancelled, Ending, Engine};
use pinwheel_files::FileError;
use pinwheel_scene::{Scene, SceneError};

use crate::choice::ChoiceError;
use crate::output::{OutputError, reason};

/// Reason for a study without result.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Stop by the observer.
    #[error("stopped")]
    Cancelled,
    /// Input that cannot be used, with the remedy.
    #[error("{0}")]
    Input(String),
    /// Engine that cannot be chosen.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// Unfinished run that the study needs.
    #[error("{engine} {ending}")]
    Ended {
        /// Name of the engine.
        engine: String,
        /// Ending of the run.
        ending: Ending,
    },
    /// Failed run that the study needs.
    #[error("{0}; nothing was written")]
    Broken(String),
    /// Failure of a run that checks another.
    #[error("the run cannot be repeated at twice its step: {0}")]
    Unrepeated(Box<StudyError>),
    /// Incompatible time series.
    #[error("the time series cannot be compared: {0}")]
    Compare(#[from] pinwheel_compare::CompareError),
    /// File of the results that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Scene that cannot be loaded.
    #[error(transparent)]
    Load(#[from] SceneError),
    /// Scene that cannot be modelled.
    #[error("{scene}: {source}")]
    Scene {
        /// Name of the scene.
        scene: String,
        /// Fault of the model.
        source: pinwheel_gearbox::GearboxError,
    },
    /// Failed reference run.
    #[error("{scene}: the reference run {reason}; use a scene that can be resolved")]
    Reference {
        /// Name of the scene.
        scene: String,
        /// Failure of the run.
        reason: String,
    },
    /// File of a study that cannot be read, or is incomplete.
    #[error(transparent)]
    File(#[from] FileError),
    /// Refused scene of a sweep's run.
    #[error("run {number} ({values}): {source}")]
    Run {
        /// Number of the run, from 1.
        number: usize,
        /// Values of the varied keys.
        values: String,
        /// Fault of the scene.
        source: Box<SceneError>,
    },
    /// File of a journal that cannot be read or written.
    #[error("{}: {}; check the free space and the permission to write", .0.display(), reason(.1))]
    Io(PathBuf, #[source] std::io::Error),
    /// Runs of an earlier attempt, without a choice of their treatment.
    #[error("{} holds runs of an earlier attempt", place.display())]
    Begun {
        /// Folder of the journal.
        place: PathBuf,
    },
    /// Stop by the user; finished runs are kept.
    #[error("stopped after {finished} of {runs} runs")]
    Stopped {
        /// Number of stored runs.
        finished: usize,
        /// Number of all runs.
        runs: usize,
    },
    /// Recording failed.
    #[error(transparent)]
    TimeSeries(#[from] pinwheel_timeseries::TimeSeriesError),
}

impl StudyError {
    pub(crate) fn ended(engine: &dyn Engine, ending: Ending) -> Self {
        Self::Ended {
            engine: engine.name().to_owned(),
            ending,
        }
    }

    pub(crate) fn reference(scene: &Scene, reason: impl ToString) -> Self {
        Self::Reference {
            scene: scene.name.clone(),
            reason: reason.to_string(),
        }
    }
}

impl From<Cancelled> for StudyError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
