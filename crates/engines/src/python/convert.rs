//! Conversion of Python's results and errors for [`Engine`](crate::Engine).

use pinwheel_timeseries::{TimeSeries, TimeSeriesError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::package::{package, text_of};
use crate::control::Cancelled;
use crate::engine::{Ending, Halt, Run, RunStats};

/// Converts the package's `Result` to a run, finished or partial.
pub(super) fn run(result: &Bound<'_, PyAny>) -> PyResult<Run> {
    let stats = result.getattr("stats")?;
    let of = |name: &str| stats.getattr(name);
    let stats = RunStats {
        wall_s: of("wall_s")?.extract()?,
        cpu_s: of("cpu_s")?.extract()?,
        rhs_calls: of("rhs_calls")?.extract()?,
        steps: of("steps")?.extract()?,
        rejected_steps: of("rejected_steps")?.extract()?,
        degrees_of_freedom: of("degrees_of_freedom")?.extract()?,
        bodies: of("bodies")?.extract()?,
        step_s: of("step_s")?.extract()?,
        settings: of("settings")?.extract()?,
        joint_drift_m: of("joint_drift_m")?.extract()?,
        notes: of("notes")?.extract()?,
        ..RunStats::default()
    };
    Ok(match time_series(&result.getattr("columns")?)? {
        Ok(time_series) => Run::new(time_series, stats),
        Err(error) => Run::ended(Ending::failed(error)),
    })
}

/// Converts a dict of numpy columns, with `time_s` among them, to time series.
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

/// Converts a Python error to a run that ended.
///
/// # Errors
/// A stop by the user.
pub(super) fn ended(py: Python<'_>, error: &PyErr) -> Result<Run, Halt> {
    known(py, error).unwrap_or_else(|broken| Ok(Run::ended(Ending::failed(text_of(py, &broken)))))
}

/// Converts a Python error to the halt of a step without time series.
pub(super) fn halt(py: Python<'_>, error: &PyErr) -> Halt {
    ended(py, error).map_or_else(|halt| halt, |run| run.ending.into())
}

/// Converts a Python error like [`ended`]; the outer error is one of the conversion.
fn known(py: Python<'_>, error: &PyErr) -> PyResult<Result<Run, Halt>> {
    let errors = package(py)?.getattr("errors")?;
    let value = error.value(py);
    let is = |name: &str| -> PyResult<bool> { value.is_instance(&errors.getattr(name)?) };
    let text = |name: &str| -> PyResult<String> { value.getattr(name)?.extract() };
    let ending = if is("Cancelled")? {
        return Ok(Err(Cancelled.into()));
    } else if is("Unsupported")? {
        Ending::unsupported(text("reason")?)
    } else if is("SceneError")? {
        Ending::unsupported(value.str()?)
    } else if is("Diverged")? {
        let ending = Ending::Diverged {
            time_s: value.getattr("time_s")?.extract()?,
            quantity: text("quantity")?,
        };
        let partial = value.getattr("partial")?;
        if !partial.is_none() {
            return Ok(Ok(run(&partial)?.with_ending(ending)));
        }
        ending
    } else if is("EngineFailed")? {
        Ending::failed(text("reason")?)
    } else if is("FrozenForces")? {
        Ending::failed(format!("frozen forces: {}", value.str()?))
    } else {
        Ending::failed(text_of(py, error))
    };
    Ok(Ok(Run::ended(ending)))
}
