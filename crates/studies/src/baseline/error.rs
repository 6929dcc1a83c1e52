//! What can go wrong with a baseline.

use std::path::PathBuf;

use crate::StudyError;
use crate::output::OutputError;

/// Version of the layout.
pub(super) const FORMAT: u32 = 2;

/// Why there is no baseline, or no check of it.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] OutputError),
    /// A file that is no baseline.
    #[error("{}: {what}", path.display())]
    Spoiled {
        /// Which.
        path: PathBuf,
        /// What is wrong in it.
        what: String,
    },
    /// A layout of another time.
    #[error("{}: format {found} is not the one this program writes ({}); record it anew under another name", path.display(), FORMAT)]
    Format {
        /// Which file.
        path: PathBuf,
        /// Its format.
        found: i64,
    },
    /// Made by other solvers than those that are to be checked.
    #[error("{}", other_solvers(recorded))]
    OtherSolvers {
        /// Those that made it.
        recorded: Vec<String>,
    },
    /// A name that is no folder's.
    #[error("`{0}` is no name for a baseline; use letters, digits, `-`, `_` and `.`")]
    Name(String),
    /// No baseline of that name.
    #[error("no baseline `{name}` in {}; {remedy}", dir.display())]
    Missing {
        /// As it was asked for.
        name: String,
        /// Folder of the baselines.
        dir: PathBuf,
        /// Those that there are, or how to make one.
        remedy: String,
    },
    /// A choice of the set that does not come to its end cannot be a baseline.
    #[error("{scene}, {choice}: {reason}")]
    DoesNotHold {
        /// Which scene.
        scene: String,
        /// By which solver.
        choice: String,
        /// How it ended.
        reason: String,
    },
    /// No scene of the set has this name.
    #[error("no scene of the baselines is called `{0}`")]
    NoScene(String),
    /// A run failed.
    #[error(transparent)]
    Study(#[from] StudyError),
}

fn other_solvers(recorded: &[String]) -> String {
    if recorded.is_empty() {
        return "this baseline was made by Pinwheel's own solver; leave out --solver, or record one under another name"
            .to_owned();
    }
    format!(
        "this baseline was made by {}; name the same by --solver, in this order",
        recorded.join(", ")
    )
}
