//! What can go wrong before a Python engine runs. One line each, with the remedy.

use std::path::{Path, PathBuf};

use super::variables::{ENVIRONMENT, WHEELS};
use crate::cache::CacheError;

/// Why there is no Python environment.
#[derive(Debug, Clone, thiserror::Error)]
pub enum PythonError {
    /// A variable would send the embedded interpreter to a foreign library.
    #[error(
        "PYTHONHOME = {0:?} would send the embedded Python to another installation; unset PYTHONHOME"
    )]
    Home(String),
    /// No interpreter to make an environment with.
    #[error(
        "no Python {version} interpreter was found to make an environment with (tried {tried}); install it, or name an \
         environment of that version with {ENVIRONMENT}"
    )]
    NoInterpreter {
        /// Version of the embedded interpreter.
        version: String,
        /// Where it was looked for.
        tried: String,
    },
    /// The environment named by the user is of no use.
    #[error(
        "{ENVIRONMENT} = {folder}: {reason}; name an environment made with `python3 -m venv` and filled with `pip install -r \
         python/requirements.txt`, or unset {ENVIRONMENT}"
    )]
    Named {
        /// The folder.
        folder: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// `venv` failed.
    #[error(
        "no virtual environment can be made with {interpreter}: {reason}; install its module venv (Debian: apt install \
         python3-venv), or name an environment with {ENVIRONMENT}"
    )]
    Venv {
        /// Interpreter used.
        interpreter: PathBuf,
        /// Its own words.
        reason: String,
    },
    /// `pip` failed.
    #[error(
        "the Python packages cannot be installed: {reason}; without a network fill a folder with `pip download {packages} \
         -d FOLDER` elsewhere and set {WHEELS}=FOLDER, or name an environment that has them with {ENVIRONMENT}"
    )]
    Install {
        /// pip's own words.
        reason: String,
        /// pip's arguments that name the packages.
        packages: String,
    },
    /// The environment is there, and the package cannot be loaded all the same.
    #[error("the Python package cannot be loaded: {reason}; {}", remedy(.folder, *.named))]
    Load {
        /// Python's own words.
        reason: String,
        /// The environment.
        folder: PathBuf,
        /// Whether the user named it: then it is the user's.
        named: bool,
    },
    /// The cache folder, or the user asked to stop.
    #[error(transparent)]
    Cache(#[from] CacheError),
}

/// What helps against an environment that is there and of no use.
fn remedy(folder: &Path, named: bool) -> String {
    let folder = folder.display();
    if named {
        format!(
            "run `pip install -r python/requirements.txt` in {folder}, or unset {ENVIRONMENT} to have one made"
        )
    } else {
        format!("remove {folder} to have it made anew")
    }
}

impl PythonError {
    /// The user asked to stop.
    pub(crate) const STOPPED: Self = Self::Cache(CacheError::Stopped);

    pub(super) fn storage(path: &Path, reason: impl ToString) -> Self {
        CacheError::storage(path, reason).into()
    }

    /// Whether the user asked to stop.
    pub(crate) fn is_stop(&self) -> bool {
        matches!(self, Self::Cache(CacheError::Stopped))
    }
}
