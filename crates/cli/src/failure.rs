//! Why the program ends early: an exit status and one line with the remedy.

use std::fmt::Display;
use std::path::Path;

use pinwheel_scene::SceneError;

/// Ran, but a limit was exceeded.
pub(crate) const EXCEEDED: u8 = 1;
/// Bad input or usage.
pub(crate) const INPUT: u8 = 2;
/// An engine is missing, diverged or failed.
pub(crate) const ENGINE: u8 = 3;
/// Stopped by the user, as shells number an interrupt.
pub(crate) const STOPPED: u8 = 130;

/// An early end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Failure {
    /// Exit status.
    pub(crate) code: u8,
    /// One line without the leading `error: `.
    pub(crate) message: String,
}

impl Failure {
    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self {
            code: INPUT,
            message: message.into(),
        }
    }

    pub(crate) fn engine(message: impl Into<String>) -> Self {
        Self {
            code: ENGINE,
            message: message.into(),
        }
    }

    /// A file or folder of the output cannot be written.
    pub(crate) fn unwritable(path: &Path, error: &dyn Display) -> Self {
        Self::input(format!(
            "{}: cannot be written: {error}; choose another --out",
            path.display()
        ))
    }

    pub(crate) fn stopped() -> Self {
        Self {
            code: STOPPED,
            message: "stopped; nothing was written".to_owned(),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::input(error.to_string())
    }
}
