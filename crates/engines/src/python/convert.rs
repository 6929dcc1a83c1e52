//! Python's results and errors in the words of [`Engine`](crate::Engine).

use pinwheel_timeseries::{TimeSeries, TimeSeriesError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::host;
use crate::control::Cancelled;
use crate::engine::{Ending, Halt, Run, RunStats};

/// A finished run, or the part of one, from the package's `Result`.
pub(super) fn run(result: &Bound<'_, PyAny>) -> PyResult<Run> {
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
    Ok(match time_series(&result.getattr("columns")?)? {
        Ok(time_series) => Run::new(time_series, stats),
        Err(error) => Run::ended(Ending::failed(error)),
    })
}

/// TimeSeries from a dict of numpy columns, `time_s` among them.
fn time_series(columns: &Bound<'_, PyAny>) -> PyResult<Result<TimeSeries, TimeSeriesError>> {
    let columns = columns.cast::<PyDict>()?;
    let each = columns.iter().map(|(name, values)| {
        let bytes = values.call_method0("tobytes")?;
        let (numbers, _) = bytes.cast::<PyBytes>()?.as_bytes().as_chunks::<8>();
        let values = numbers.iter().map(|&bytes| f64::from_ne_bytes(bytes));
        Ok((name.extract()?, values.collect()))
    });
    let columns: Vec<(String, Vec<f64>)> = each.collect::<PyResult<_>>()?;
    Ok(TimeSeries::of_columns(columns))
}

/// What a Python error makes of a run.
///
/// # Errors
/// The user asked to stop.
pub(super) fn ended(py: Python<'_>, error: &PyErr) -> Result<Run, Halt> {
    known(py, error).unwrap_or_else(|broken| Ok(Run::ended(Ending::failed(text_of(py, &broken)))))
}

/// The same; the outer error came up on the way.
fn known(py: Python<'_>, error: &PyErr) -> PyResult<Result<Run, Halt>> {
    let errors = host::package(py)?.getattr("errors")?;
    let value = error.value(py);
    let is = |name: &str| -> PyResult<bool> { value.is_instance(&errors.getattr(name)?) };
    let text = |name: &str| -> PyResult<String> { value.getattr(name)?.extract() };
    Ok(Ok(if is("Cancelled")? {
        return Ok(Err(Cancelled.into()));
    } else if is("Unsupported")? {
        Run::ended(Ending::unsupported(text("reason")?))
    } else if is("SceneError")? {
        Run::ended(Ending::unsupported(value.str()?))
    } else if is("Diverged")? {
        let partial = value.getattr("partial")?;
        let ending = Ending::Diverged {
            time_s: value.getattr("time_s")?.extract()?,
            quantity: text("quantity")?,
        };
        if partial.is_none() {
            Run::ended(ending)
        } else {
            run(&partial)?.with_ending(ending)
        }
    } else if is("EngineFailed")? {
        Run::ended(Ending::failed(text("reason")?))
    } else if is("FrozenForces")? {
        Run::ended(Ending::failed(format!("frozen forces: {}", value.str()?)))
    } else {
        Run::ended(Ending::failed(text_of(py, error)))
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
