//! Package `pinwheel_engines` and the text of its errors.

use pyo3::prelude::*;
use pyo3::types::PyModule;

/// Name of the package.
pub(super) const PACKAGE: &str = "pinwheel_engines";

/// Imports the package.
pub(super) fn package(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import(PACKAGE)
}

/// Returns a Python error as one line that begins with its type.
pub(super) fn text_of(py: Python<'_>, error: &PyErr) -> String {
    let value = error.value(py);
    let kind = value.get_type().name();
    let kind = kind.map_or_else(|_| "error".to_owned(), |name| name.to_string());
    let text = value.str().map(|text| text.to_string()).unwrap_or_default();
    let text: Vec<&str> = text.split_whitespace().collect();
    match text.is_empty() {
        true => kind,
        false => format!("{kind}: {}", text.join(" ")),
    }
}
