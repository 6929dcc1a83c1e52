//! A check as files.

use std::path::Path;

use serde::Serialize;

use super::{Check, Head};
use crate::output::OutputError;
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Found<'a> {
    baseline: &'a Head,
    check: &'a Check,
}

/// Writes `summary.json` of a check against `baseline` into the folder `dir`.
///
/// # Errors
/// The file cannot be written.
pub fn write(
    check: &Check,
    baseline: &Head,
    dir: &Path,
    made: &Provenance,
) -> Result<(), OutputError> {
    Summary::new(made, Found { baseline, check }).write(dir)
}
