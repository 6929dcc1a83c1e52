//! Errors as the package's exceptions. Messages name keys as in Python, and never options of the program.

use pinwheel::scene::{Location, SceneError};
use pinwheel::studies::StudyError;
use pinwheel::studies::choice::ChoiceError;
use pinwheel::studies::folder::FolderError;
use pinwheel::studies::output::OutputError;
use pinwheel::time_series::Ending;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError};
use pyo3::prelude::*;

/// Exception to raise: Python's own, or an error of the library as the package's exception.
pub(crate) struct Raised(PyErr);

/// Result of functions of this module.
pub(crate) type Raises<T> = Result<T, Raised>;

impl From<Raised> for PyErr {
    fn from(raised: Raised) -> Self {
        raised.0
    }
}

impl From<PyErr> for Raised {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

/// Name of a scene without a file; a scene from a file is named by its full path.
const NO_FILE: &str = "scene";

/// Returns an exception of the package with attributes.
fn raise(
    class: &str,
    message: &str,
    attributes: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<()>,
) -> Raised {
    let exception = |py: Python<'_>| -> PyResult<PyErr> {
        let class = py.import("pinwheel.errors")?.getattr(class)?;
        let error = class.call_method1("_of", (message,))?;
        attributes(&error)?;
        Ok(PyErr::from_value(error))
    };
    Raised(Python::attach(exception).unwrap_or_else(|broken| broken))
}

/// Returns message, key and remedy of a fault of a scene.
fn fault(error: &SceneError) -> (String, Option<&str>, &str) {
    let (message, key, remedy) = match error {
        SceneError::Key {
            place,
            key,
            what,
            remedy,
        } => {
            let at = match place {
                Location::File { source } if source != NO_FILE => format!("{source}: "),
                Location::Line { source, line } if source != NO_FILE => {
                    format!("{source}, line {line}: ")
                }
                _ => String::new(),
            };
            let message = format!("{at}`{key}` {what}; {remedy}");
            (message, Some(key.as_str()), remedy.as_str())
        }
        SceneError::Missing { keys, .. } => (error.to_string(), keys.first().copied(), ""),
        _ => (error.to_string(), None, ""),
    };
    (message.replace(&format!("{NO_FILE}: "), ""), key, remedy)
}

impl From<SceneError> for Raised {
    fn from(error: SceneError) -> Self {
        let (message, key, remedy) = fault(&error);
        of_key(&message, key, remedy)
    }
}

/// Returns the exception for a fault of `key` with a message.
pub(crate) fn of_key(message: &str, key: Option<&str>, remedy: &str) -> Raised {
    raise("SceneError", message, |raised| {
        raised.setattr("key", key)?;
        raised.setattr("remedy", remedy)
    })
}

/// Returns the exception for a run of `engine` that did not finish; `partial`: its results so far.
pub(crate) fn ended(engine: &str, ending: &Ending, partial: Option<Py<PyAny>>) -> Raised {
    let class = match ending {
        Ending::Diverged { .. } => "Diverged",
        Ending::Unsupported { .. } => "Unsupported",
        _ => "EngineFailed",
    };
    raise(class, &format!("{engine} {ending}"), |raised| {
        raised.setattr("engine", engine)?;
        match ending {
            Ending::Diverged { time_s, quantity } => {
                raised.setattr("time_s", *time_s)?;
                raised.setattr("quantity", quantity)?;
                raised.setattr("partial", partial)
            }
            Ending::Unsupported { reason }
            | Ending::Failed { reason }
            | Ending::Absent { reason }
            | Ending::TimedOut { reason, .. } => raised.setattr("reason", reason),
            Ending::Finished => Ok(()),
        }
    })
}

/// Returns the exception for bad input outside a scene.
pub(crate) fn input(message: impl AsRef<str>) -> Raised {
    raise("InputError", message.as_ref(), |_| Ok(()))
}

/// Returns the exception for an error that has only a message.
pub(crate) fn plain(error: impl ToString) -> Raised {
    PyRuntimeError::new_err(error.to_string()).into()
}

impl From<ChoiceError> for Raised {
    fn from(error: ChoiceError) -> Self {
        let message = match error {
            ChoiceError::Twice(name) => format!("{name} is named twice; name each engine once"),
            ChoiceError::NotBuilt { name, remedy } => {
                format!("engine `{name}` is not in this Python; {remedy}, see pinwheel.engines()")
            }
            other => other.to_string(),
        };
        raise("NoEngine", &message, |_| Ok(()))
    }
}

impl From<StudyError> for Raised {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Cancelled | StudyError::Stopped { .. } => {
                PyKeyboardInterrupt::new_err(error.to_string()).into()
            }
            StudyError::Io(..) => PyOSError::new_err(error.to_string()).into(),
            StudyError::Run {
                number,
                values,
                source,
            } => {
                let (message, key, _) = fault(&source);
                let message = format!("run {number} ({values}): {message}");
                raise("SceneError", &message, |raised| raised.setattr("key", key))
            }
            StudyError::Begun { .. } => input(format!(
                "{error}; go on with resume=True, or start over with force=True"
            )),
            StudyError::Ended { engine, ending } => ended(&engine, &ending, None),
            StudyError::Choice(error) => error.into(),
            StudyError::Load(error) => error.into(),
            StudyError::Output(error) => error.into(),
            StudyError::Input(_) | StudyError::Scene { .. } | StudyError::File(_) => {
                input(error.to_string())
            }
            other => plain(other),
        }
    }
}

impl From<OutputError> for Raised {
    fn from(error: OutputError) -> Self {
        PyOSError::new_err(format!("{error}; name another file")).into()
    }
}

impl From<FolderError> for Raised {
    fn from(error: FolderError) -> Self {
        let force = match error {
            FolderError::Kept { .. } => ", or force=True to replace it",
            _ => "",
        };
        PyOSError::new_err(format!("{error}; choose another `out`{force}")).into()
    }
}

impl From<serde_json::Error> for Raised {
    fn from(error: serde_json::Error) -> Self {
        plain(error)
    }
}
