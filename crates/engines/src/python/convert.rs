//! Python's results and errors in the words of [`Engine`](crate::Engine).

use pinwheel_courses::Courses;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::host;
use crate::engine::{EngineError, Run, RunStats};

/// A finished run, or the part of one, from the package's `Result`.
pub(super) fn run(result: &Bound<'_, PyAny>) -> PyResult<Result<Run, String>> {
    let stats = result.getattr("stats")?;
    let number = |name: &str| -> PyResult<f64> { stats.getattr(name)?.extract() };
    let count = |name: &str| -> PyResult<u64> { stats.getattr(name)?.extract() };
    let size = |name: &str| -> PyResult<usize> { stats.getattr(name)?.extract() };
    let stats = RunStats {
        wall_s: number("wall_s")?,
        cpu_s: number("cpu_s")?,
        rhs_calls: count("rhs_calls")?,
        steps: count("steps")?,
        rejected_steps: count("rejected_steps")?,
        degrees_of_freedom: size("degrees_of_freedom")?,
        bodies: size("bodies")?,
        step_s: number("step_s")?,
        settings: stats.getattr("settings")?.extract()?,
        joint_drift_m: stats.getattr("joint_drift_m")?.extract()?,
        notes: stats.getattr("notes")?.extract()?,
        ..RunStats::default()
    };
    Ok(courses(&result.getattr("columns")?)?.map(|courses| Run::new(courses, stats)))
}

/// Courses from a dict of numpy columns, `time_s` among them.
fn courses(columns: &Bound<'_, PyAny>) -> PyResult<Result<Courses, String>> {
    let columns = columns.cast::<PyDict>()?;
    let (mut time_s, mut channels) = (Vec::new(), Vec::new());
    for (name, values) in columns {
        let name: String = name.extract()?;
        let bytes = values.call_method0("tobytes")?;
        let values: Vec<f64> = bytes
            .cast::<PyBytes>()?
            .as_bytes()
            .as_chunks::<8>()
            .0
            .iter()
            .map(|&bytes| f64::from_ne_bytes(bytes))
            .collect();
        if name == "time_s" {
            time_s = values;
        } else {
            channels.push((name, values));
        }
    }
    let made = Courses::new(time_s).and_then(|mut courses| {
        for (name, values) in channels {
            courses.push(name, values)?;
        }
        Ok(courses)
    });
    Ok(made.map_err(|error| error.to_string()))
}

/// A Python error as the engine's.
pub(super) fn error(py: Python<'_>, engine: &str, error: &PyErr) -> EngineError {
    let failed = |reason: String| EngineError::Failed {
        engine: engine.to_owned(),
        reason,
    };
    known(py, engine, error)
        .unwrap_or_else(|broken| Some(failed(text_of(py, &broken))))
        .unwrap_or_else(|| failed(text_of(py, error)))
}

/// The package's own errors; `None` for any other.
fn known(py: Python<'_>, engine: &str, error: &PyErr) -> PyResult<Option<EngineError>> {
    let errors = host::package(py)?.getattr("errors")?;
    let value = error.value(py);
    let is = |name: &str| -> PyResult<bool> { value.is_instance(&errors.getattr(name)?) };
    let owner = engine.to_owned();
    let text = |name: &str| -> PyResult<String> { value.getattr(name)?.extract() };
    Ok(Some(if is("Cancelled")? {
        EngineError::Cancelled
    } else if is("Unsupported")? {
        EngineError::Unsupported {
            engine: owner,
            reason: text("reason")?,
        }
    } else if is("SceneError")? {
        EngineError::Unsupported {
            engine: owner,
            reason: value.str()?.extract()?,
        }
    } else if is("Diverged")? {
        let partial = value.getattr("partial")?;
        let nothing = || Run::new(Courses::default(), RunStats::default());
        EngineError::Diverged {
            engine: owner,
            time_s: value.getattr("time_s")?.extract()?,
            quantity: text("quantity")?,
            partial: Box::new(if partial.is_none() {
                nothing()
            } else {
                run(&partial)?.unwrap_or_else(|_| nothing())
            }),
        }
    } else if is("EngineFailed")? {
        EngineError::Failed {
            engine: owner,
            reason: text("reason")?,
        }
    } else if is("FrozenForces")? {
        EngineError::Failed {
            engine: owner,
            reason: format!("frozen forces: {}", value.str()?),
        }
    } else {
        return Ok(None);
    }))
}

/// A Python error on one line, its type first.
pub(super) fn text_of(py: Python<'_>, error: &PyErr) -> String {
    let value = error.value(py);
    let kind = value
        .get_type()
        .name()
        .map_or_else(|_| "error".to_owned(), |name| name.to_string());
    let text = value
        .str()
        .map_or_else(|_| String::new(), |text| text.to_string());
    let text: Vec<&str> = text.split_whitespace().collect();
    if text.is_empty() {
        kind
    } else {
        format!("{kind}: {}", text.join(" "))
    }
}
