//! Errors of a sweep. Every message is one line with place, fault and remedy.

use std::path::PathBuf;

use pinwheel_files::FileError;
use pinwheel_scene::SceneError;

/// Faults of reading, planning or running a sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// Sweep file that cannot be read, or is incomplete.
    #[error(transparent)]
    File(#[from] FileError),
    /// Refused scene of a run.
    #[error("run {number} ({values}): {source}")]
    Scene {
        /// Number of the run, from 1.
        number: usize,
        /// Values of the varied keys.
        values: String,
        /// Fault of the scene.
        source: Box<SceneError>,
    },
    /// Fault of the input, with the remedy.
    #[error("{0}")]
    Input(String),
    /// File that cannot be read or written.
    #[error("{}: {}; check the free space and the permission to write", path.display(), crate::output::reason(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Result file that cannot be written.
    #[error(transparent)]
    Output(#[from] crate::output::OutputError),
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
}
