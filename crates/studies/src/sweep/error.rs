//! Errors of a sweep. Every message is one line: where, what, and the remedy.

use std::path::PathBuf;

use pinwheel_files::FileError;
use pinwheel_scene::SceneError;

/// Faults of reading, planning or running a sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The file cannot be read, or does not say what to do.
    #[error(transparent)]
    File(#[from] FileError),
    /// A run's scene is refused.
    #[error("run {number} ({values}): {source}")]
    Scene {
        /// Number of the run, the first being 1.
        number: usize,
        /// Values of the varied keys.
        values: String,
        /// Why.
        source: Box<SceneError>,
    },
    /// Fault of the input, with the remedy.
    #[error("{0}")]
    Input(String),
    /// A file cannot be read or written.
    #[error("{}: {}; check that there is room and that you may write there", path.display(), crate::output::reason(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file of the results cannot be written.
    #[error(transparent)]
    Output(#[from] crate::output::OutputError),
    /// There are runs of an earlier attempt, and nobody said whether they count.
    #[error("{} holds runs of an earlier attempt", place.display())]
    Begun {
        /// The journal's folder.
        place: PathBuf,
    },
    /// The user asked to stop; finished runs are kept.
    #[error("stopped after {finished} of {runs} runs")]
    Stopped {
        /// Runs that are kept.
        finished: usize,
        /// All runs.
        runs: usize,
    },
}
