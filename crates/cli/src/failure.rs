//! Failures of the program: an exit status and one line with the remedy.

use pinwheel::compare::CompareError;
use pinwheel::engines::Cancelled;
use pinwheel::scene::SceneError;
use pinwheel::studies::StudyError;
use pinwheel::studies::choice::ChoiceError;
use pinwheel::studies::folder::FolderError;
use pinwheel::studies::output::OutputError;
use pinwheel::time_series::Ending;

/// Finished; engines differ, or a result is worse than permitted.
pub(crate) const DIFFER: u8 = 1;
/// Finished; a result is inconclusive, and a setting could decide it.
pub(crate) const INCONCLUSIVE: u8 = 4;
/// Invalid input or usage.
pub(crate) const INPUT: u8 = 2;
/// Missing, diverged or failed engine.
pub(crate) const ENGINE: u8 = 3;
/// Stop by the user; shells number an interrupt like this.
pub(crate) const STOPPED: u8 = 130;

/// Failure that ends the program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Failure {
    /// Exit status.
    pub(crate) code: u8,
    /// Message on one line, without the leading `error: `.
    pub(crate) message: String,
}

impl Failure {
    pub(crate) fn new(code: u8, message: impl ToString) -> Self {
        let message = message.to_string();
        Self { code, message }
    }

    pub(crate) fn input(message: impl ToString) -> Self {
        Self::new(INPUT, message)
    }

    pub(crate) fn engine(message: impl ToString) -> Self {
        Self::new(ENGINE, message)
    }

    pub(crate) fn stopped() -> Self {
        Self::new(STOPPED, "stopped; nothing was written")
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::input(error)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::input(format!("{error}; choose another --out"))
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        Self::input(match error {
            FolderError::Empty => "--out is empty; name a folder".to_owned(),
            FolderError::Refused { .. } => format!("--out {error}; choose another --out"),
            FolderError::Kept { .. } => {
                format!("--out {error}; choose another --out, or --force to replace it")
            }
            FolderError::Output(error) => return error.into(),
        })
    }
}

impl From<ChoiceError> for Failure {
    fn from(error: ChoiceError) -> Self {
        match error {
            ChoiceError::NotBuilt { .. } => Self::engine(error),
            _ => Self::input(error),
        }
    }
}

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::stopped()
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Cancelled | StudyError::Stopped { finished: 0, .. } => Self::stopped(),
            StudyError::Stopped { finished, runs } => Self::new(
                STOPPED,
                format!("stopped; {finished} of {runs} runs are kept: go on with --resume"),
            ),
            StudyError::Input(_)
            | StudyError::Load(_)
            | StudyError::File(_)
            | StudyError::Run { .. }
            | StudyError::Io(..)
            | StudyError::Scene { .. }
            | StudyError::Compare(CompareError::Unmatched { .. }) => Self::input(error),
            StudyError::Begun { .. } => Self::input(format!(
                "{error}; go on with --resume, or start over with --force"
            )),
            StudyError::Output(error) => error.into(),
            StudyError::Choice(error) => error.into(),
            StudyError::Ended {
                ending: Ending::Unsupported { .. },
                ..
            } => Self::engine(format!(
                "{error}; choose another engine (`pinwheel engines`) or change the scene"
            )),
            StudyError::Ended { .. } => Self::engine(format!(
                "{error}; nothing was written; see `pinwheel engines` for others"
            )),
            StudyError::Unrepeated(_) => {
                Self::engine(format!("{error}; --unchecked leaves that out"))
            }
            error => Self::engine(error),
        }
    }
}
