//! Writing the files of a result into a folder that is there.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// A file or folder that cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: cannot be written: {reason}", path.display())]
pub struct OutputError {
    /// Which.
    pub path: PathBuf,
    /// Why.
    pub reason: String,
}

impl OutputError {
    /// `path` cannot be written because of `error`.
    pub fn new(path: &Path, error: &dyn Display) -> Self {
        Self {
            path: path.to_owned(),
            reason: error.to_string(),
        }
    }
}

/// Writes pretty JSON with a final newline.
///
/// # Errors
/// The file cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    let mut text =
        serde_json::to_string_pretty(value).map_err(|error| OutputError::new(path, &error))?;
    text.push('\n');
    write_text(path, &text)
}

/// Writes a text file.
///
/// # Errors
/// The file cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), OutputError> {
    fs::write(path, text).map_err(|error| OutputError::new(path, &error))
}

/// Makes the folder `name` in `dir`, and those above it.
pub(crate) fn folder(dir: &Path, name: &str) -> Result<PathBuf, OutputError> {
    let place = dir.join(name);
    fs::create_dir_all(&place).map_err(|error| OutputError::new(&place, &error))?;
    Ok(place)
}

/// Writes the file `name` in `dir` by `write`.
pub(crate) fn write_with<E: Display>(
    dir: &Path,
    name: &str,
    write: impl FnOnce(BufWriter<File>) -> Result<(), E>,
) -> Result<(), OutputError> {
    let path = dir.join(name);
    let file = File::create(&path).map_err(|error| OutputError::new(&path, &error))?;
    write(BufWriter::new(file)).map_err(|error| OutputError::new(&path, &error))
}
