//! What can be wrong with a sweep. Every message is one line: where, what, and the remedy.

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
        /// What it varies.
        values: String,
        /// Why.
        source: Box<SceneError>,
    },
    /// A run that cannot be planned for another reason.
    #[error("run {number} ({values}): {what}")]
    Run {
        /// Number of the run.
        number: usize,
        /// What it varies.
        values: String,
        /// What is wrong, with the remedy.
        what: String,
    },
    /// More runs than are planned for.
    #[error(
        "the sweep asks for {runs} runs, more than {most}; give shorter lists, or split the sweep"
    )]
    TooMany {
        /// Runs asked for.
        runs: String,
        /// The bound.
        most: usize,
    },
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
    /// Results cannot be written.
    #[error("{}: {source}", path.display())]
    TimeSeries {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: pinwheel_timeseries::TimeSeriesError,
    },
    /// Runs that were to be gathered and are not there.
    #[error(
        "{missing} of {runs} runs are not there, the first of them run {first}; run the shards that did not end, or run what is missing \
         here with --resume in place of --gather"
    )]
    Missing {
        /// Runs that are not there.
        missing: usize,
        /// All runs.
        runs: usize,
        /// Number of the first that is not.
        first: usize,
    },
    /// There are runs of an earlier attempt, and nobody said whether they count.
    #[error("{} holds runs of an earlier attempt", place.display())]
    Begun {
        /// The journal's folder.
        place: PathBuf,
    },
    /// Nothing was begun that could be gathered.
    #[error("{} is not there: no shard of this sweep has begun; run them with --shard and the same --out", place.display())]
    NotBegun {
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
