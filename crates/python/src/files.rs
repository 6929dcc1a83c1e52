//! Files that users name.

use std::path::PathBuf;

use pinwheel::fmu::Package;
use pinwheel::studies::file;
use pyo3::prelude::*;

use crate::errors::Raises;

/// Writes all of a file or nothing. What is there is replaced if it holds `mark`, by which files of its kind are known; units
/// are known by their description.
#[pyfunction]
pub(crate) fn write(py: Python<'_>, path: PathBuf, content: &[u8], mark: &str) -> Raises<()> {
    let ours = |earlier: &[u8]| match content.starts_with(b"PK") {
        true => Package::is_ours(earlier),
        false => String::from_utf8_lossy(earlier).contains(mark),
    };
    Ok(py.detach(|| file::replace(&path, content, &ours))?)
}
