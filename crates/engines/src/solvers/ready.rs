//! What a shipped solver runs with.

use std::path::PathBuf;

/// Folder and interpreter with which a solver runs.
#[derive(Debug, Clone)]
pub(super) struct Ready {
    /// The folder of its manifests and of what they start.
    pub(super) here: PathBuf,
    /// Its interpreter, if it needs one.
    pub(super) python: Option<PathBuf>,
}
