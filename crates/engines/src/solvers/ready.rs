//! What a shipped solver needs, or why it cannot be had.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cache::CacheError;

/// Why a solver cannot be used here.
#[derive(Debug, Clone)]
pub(super) enum Missing {
    /// One line with the remedy.
    Because(String),
    /// The user asked to stop.
    Stopped,
}

impl Missing {
    /// A failure, unless it is the user's wish.
    pub(super) fn of(cancel: &AtomicBool, because: impl FnOnce() -> String) -> Self {
        if cancel.load(Ordering::Relaxed) {
            Self::Stopped
        } else {
            Self::Because(because())
        }
    }
}

impl From<CacheError> for Missing {
    fn from(error: CacheError) -> Self {
        match error {
            CacheError::Stopped => Self::Stopped,
            other => Self::Because(other.to_string()),
        }
    }
}

/// What a solver needs to run.
#[derive(Debug, Clone)]
pub(super) struct Ready {
    /// The folder of its manifests and of what they start.
    pub(super) here: PathBuf,
    /// Its interpreter, if it needs one.
    pub(super) python: Option<PathBuf>,
}
