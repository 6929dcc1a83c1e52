//! Files named by users.

use std::path::PathBuf;

use pinwheel::fmu::Package;
use pinwheel::studies::file;
use pyo3::prelude::*;

use crate::errors::Raises;

/// Writes a file completely or not at all. An existing file is replaced if it contains `mark`, which identifies its kind; a
/// unit is recognised by its description.
#[pyfunction]
pub(crate) fn write(py: Python<'_>, path: PathBuf, content: &[u8], mark: &str) -> Raises<()> {
    let ours = |earlier: &[u8]| match content.starts_with(b"PK") {
        true => Package::is_ours(earlier),
        false => String::from_utf8_lossy(earlier).contains(mark),
    };
    Ok(py.detach(|| file::replace(&path, content, &ours))?)
}
