//! Errors as the package's exceptions. Messages name keys as Python writes them, and never the program's options.

use pinwheel::pages::PageError;
use pinwheel::scene::{Location, SceneError};
use pinwheel::studies::StudyError;
use pinwheel::studies::choice::ChoiceError;
use pinwheel::studies::sweep::SweepError;
use pinwheel::time_series::Ending;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The name of a scene that stands in no file; files come with their whole path.
pub(crate) const NO_FILE: &str = "scene";

/// An exception of the package with attributes.
fn raise(py: Python<'_>, class: &str, message: &str, attributes: &[(&str, Py<PyAny>)]) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let error = py
            .import("pinwheel.errors")?
            .getattr(class)?
            .call_method1("_of", (message,))?;
        for (name, value) in attributes {
            error.setattr(*name, value)?;
        }
        Ok(PyErr::from_value(error))
    };
    made().unwrap_or_else(|broken| broken)
}

fn text(py: Python<'_>, value: &str) -> Py<PyAny> {
    pyo3::types::PyString::new(py, value).into_any().unbind()
}

/// A fault of a scene: `key`, `remedy`, `line`.
pub(crate) fn scene(py: Python<'_>, error: &SceneError) -> PyErr {
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
            (
                format!("{at}`{key}` {what}; {remedy}"),
                Some(key.as_str()),
                remedy.as_str(),
            )
        }
        SceneError::Missing { keys, .. } => (error.to_string(), keys.first().copied(), ""),
        _ => (error.to_string(), None, ""),
    };
    let message = message.replace(&format!("{NO_FILE}: "), "");
    let key = key.map_or_else(|| py.None(), |key| text(py, key));
    raise(
        py,
        "SceneError",
        &message,
        &[("key", key), ("remedy", text(py, remedy))],
    )
}

/// How a run of `engine` ended other than finished; `partial`: what it had computed until then, or None.
pub(crate) fn ended(py: Python<'_>, engine: &str, ending: &Ending, partial: Py<PyAny>) -> PyErr {
    let message = format!("{engine} {ending}");
    let name = ("engine", text(py, engine));
    match ending {
        Ending::Diverged { time_s, quantity } => {
            let time = pyo3::types::PyFloat::new(py, *time_s).into_any().unbind();
            let quantity = text(py, quantity);
            let attributes = [
                name,
                ("time_s", time),
                ("quantity", quantity),
                ("partial", partial),
            ];
            raise(py, "Diverged", &message, &attributes)
        }
        Ending::Unsupported { reason } => raise(
            py,
            "Unsupported",
            &message,
            &[name, ("reason", text(py, reason))],
        ),
        Ending::Failed { reason } | Ending::Absent { reason } | Ending::TimedOut { reason, .. } => {
            raise(
                py,
                "EngineFailed",
                &message,
                &[name, ("reason", text(py, reason))],
            )
        }
        Ending::Finished => raise(py, "EngineFailed", &message, &[name]),
    }
}

/// Bad input that is no scene's.
pub(crate) fn input(py: Python<'_>, message: &str) -> PyErr {
    raise(py, "InputError", message, &[])
}

pub(crate) fn choice(py: Python<'_>, error: &ChoiceError) -> PyErr {
    let message = match error {
        ChoiceError::Twice(name) => format!("{name} is named twice; name each engine once"),
        ChoiceError::NotBuilt { name, .. } => format!(
            "engine `{name}` needs a package that this Python lacks; pip install \"./python[engines]\" in a checkout, see pinwheel.engines()"
        ),
        other => other.to_string(),
    };
    raise(py, "NoEngine", &message, &[])
}

/// Any error of a study.
pub(crate) fn study(py: Python<'_>, error: &StudyError) -> PyErr {
    match error {
        StudyError::Cancelled => PyKeyboardInterrupt::new_err("stopped"),
        StudyError::Ended { engine, ending } => ended(py, engine, ending, py.None()),
        StudyError::Choice(error) => choice(py, error),
        StudyError::Load(error) => scene(py, error),
        StudyError::Output(error) => PyOSError::new_err(error.to_string()),
        StudyError::Input(_) | StudyError::Scene { .. } => input(py, &error.to_string()),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

pub(crate) fn sweep(py: Python<'_>, error: &SweepError) -> PyErr {
    match error {
        SweepError::Stopped { .. } => PyKeyboardInterrupt::new_err(error.to_string()),
        SweepError::Io { .. } | SweepError::Output(_) => PyOSError::new_err(error.to_string()),
        SweepError::Scene {
            number,
            values,
            source,
        } => {
            let inner = scene(py, source);
            let value = inner.value(py);
            let key = value
                .getattr("key")
                .map_or_else(|_| py.None(), Bound::unbind);
            let text = format!("run {number} ({values}): {value}");
            raise(py, "SceneError", &text, &[("key", key)])
        }
        SweepError::Begun { .. } => input(
            py,
            &format!("{error}; go on with resume=True, or start over with force=True"),
        ),
        other => input(py, &other.to_string()),
    }
}

pub(crate) fn page(error: &PageError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

pub(crate) fn json(error: &serde_json::Error) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

/// A dict from pairs.
pub(crate) fn dict<'py>(
    py: Python<'py>,
    pairs: &[(&str, Bound<'py, PyAny>)],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in pairs {
        dict.set_item(*name, value)?;
    }
    Ok(dict)
}

/// An error that only its words tell.
pub(crate) fn study_text(error: &dyn std::fmt::Display) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
