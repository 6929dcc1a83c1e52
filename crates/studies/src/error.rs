//! Errors of a study.

use pinwheel_engines::{Cancelled, Ending, Engine};
use pinwheel_scene::Scene;

use crate::choice::ChoiceError;
use crate::output::OutputError;

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
    Load(#[from] pinwheel_scene::SceneError),
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
