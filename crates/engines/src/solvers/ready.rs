//! Folder and interpreter of a shipped solver.

use std::path::PathBuf;

/// Folder and interpreter with which a solver runs.
#[derive(Debug, Clone)]
pub(super) struct Ready {
    /// Folder of the manifests and of the programs that they start.
    pub(super) here: PathBuf,
    /// Python interpreter, for solvers in Python.
    pub(super) python: Option<PathBuf>,
}
