//! Time series as bytes for numpy.

use pinwheel::TimeSeries;
use pinwheel::time_series::TimeSeriesError;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Columns of a run.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Columns(pub(crate) TimeSeries);

#[pymethods]
impl Columns {
    /// Restores columns from [`names`](Self::names), [`time`](Self::time) and [`values`](Self::values), for pickling.
    #[new]
    fn new(names: Vec<String>, time: &[u8], values: &[u8]) -> PyResult<Self> {
        let numbers = |bytes: &[u8]| -> Vec<f64> {
            let (all, _) = bytes.as_chunks::<8>();
            all.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect()
        };
        let wrong = |error: TimeSeriesError| PyValueError::new_err(error.to_string());
        let mut time_series = TimeSeries::new(numbers(time)).map_err(wrong)?;
        let samples = time_series.len();
        for (k, name) in names.into_iter().enumerate() {
            let column = values.get(8 * samples * k..8 * samples * (k + 1));
            let column = numbers(column.unwrap_or_default());
            time_series.push(name, column).map_err(wrong)?;
        }
        Ok(Self(time_series))
    }

    /// Returns the names of the columns after the time; each ends in its unit, and for several of a kind in a number.
    fn names(&self) -> Vec<&str> {
        let channels = self.0.channels().iter();
        channels.map(|channel| channel.name.as_str()).collect()
    }

    /// Returns the sample times, s, as doubles of this machine.
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        bytes(py, std::iter::once(self.0.time_s()), self.0.len())
    }

    /// Returns all columns in sequence as doubles, (columns, samples).
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let channels = self.0.channels();
        let count = channels.len() * self.0.len();
        let columns = channels.iter().map(|channel| channel.values.as_slice());
        bytes(py, columns, count)
    }

    /// Returns the content of the program's `courses.csv`.
    fn csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut text = Vec::new();
        let written = self.0.write_csv(&mut text);
        written.map_err(|error| PyOSError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &text))
    }
}

fn bytes<'py, 'a>(
    py: Python<'py>,
    columns: impl Iterator<Item = &'a [f64]>,
    count: usize,
) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, 8 * count, |place| {
        let (slots, _) = place.as_chunks_mut::<8>();
        for (slot, value) in slots.iter_mut().zip(columns.flatten()) {
            *slot = value.to_ne_bytes();
        }
        Ok(())
    })
}
