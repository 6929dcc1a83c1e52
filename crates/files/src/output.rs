//! Writing of result files into an existing folder.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use serde::Serialize;

/// File or folder that cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: cannot be written: {reason}", path.display())]
pub struct OutputError {
    /// Path of the output.
    pub path: PathBuf,
    /// Reason of the failure.
    pub reason: String,
}

impl OutputError {
    /// Returns the error of `path` with the cause `error`.
    pub fn new(path: &Path, error: &dyn Display) -> Self {
        Self {
            path: path.to_owned(),
            reason: reason(error),
        }
    }
}

/// Describes the reason of a write error, with one wording for a full disk from any library.
pub fn reason(error: &dyn Display) -> String {
    let text = error.to_string();
    // Codes ENOSPC, EDQUOT and EFBIG, or their words if a library omits the number.
    let is = |signs: [&str; 2]| cfg!(unix) && signs.iter().any(|sign| text.contains(sign));
    if is(["(os error 28)", "No space left on device"]) {
        return "the disk is full".to_owned();
    }
    if is(["(os error 122)", "Disk quota exceeded"]) {
        return "the disk quota is used up".to_owned();
    }
    if is(["(os error 27)", "File too large"]) {
        return "the file is larger than the system allows (ulimit -f)".to_owned();
    }
    text
}

/// Converts a name to a path component that is safe everywhere: letters, digits, `-`, `_` and `.`, no leading dot, at most 80
/// bytes.
pub fn file_name(name: &str) -> String {
    const LONGEST: usize = 80;
    let safe = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let mut text = String::new();
    for c in name.chars().map(|c| if safe(c) { c } else { '-' }) {
        // A leading dot would hide the file, or leave the folder.
        if (text.is_empty() && c == '.') || text.len() + c.len_utf8() > LONGEST {
            continue;
        }
        text.push(c);
    }
    if text.is_empty() {
        text.push_str("unnamed");
    }
    text
}

/// True if a character acts on the displaying program: control characters, and those that change the direction of text.
pub fn steers(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Escapes text for elements and attributes of HTML and XML; control characters are written as `\u202e`.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c if steers(c) && !matches!(c, '\n' | '\t') => {
                escaped.push_str(&format!("\\u{:04x}", u32::from(c)));
            }
            c => escaped.push(c),
        }
    }
    escaped
}

/// Writes pretty JSON with a final newline.
///
/// # Errors
/// The file cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    let failed = |error: &dyn Display| OutputError::new(path, error);
    let file = File::create(path).map_err(|error| failed(&error))?;
    // Streamed, because the text of a large sweep takes more memory than the sweep.
    let mut sink = BufWriter::new(file);
    serde_json::to_writer_pretty(&mut sink, value).map_err(|error| failed(&error))?;
    let ended = sink.write_all(b"\n").and_then(|()| sink.flush());
    ended.map_err(|error| failed(&error))
}

/// Writes a text file.
///
/// # Errors
/// The file cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), OutputError> {
    fs::write(path, text).map_err(|error| OutputError::new(path, &error))
}

/// Creates the folder `name` in `dir`, and missing parent folders.
///
/// # Errors
/// The folder cannot be created.
pub fn folder(dir: &Path, name: &str) -> Result<PathBuf, OutputError> {
    let place = dir.join(name);
    fs::create_dir_all(&place).map_err(|error| OutputError::new(&place, &error))?;
    Ok(place)
}

/// Writes the file `name` in `dir` by `write`.
///
/// # Errors
/// The file cannot be written.
pub fn write_with<E: Display>(
    dir: &Path,
    name: &str,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), OutputError> {
    let path = dir.join(name);
    let failed = |error: &dyn Display| OutputError::new(&path, error);
    let file = File::create(&path).map_err(|error| failed(&error))?;
    let mut sink = BufWriter::new(file);
    write(&mut sink).map_err(|error| failed(&error))?;
    // Dropping the sink would hide its last error.
    sink.flush().map_err(|error| failed(&error))
}
