//! Errors in files of users. Every message is one line: place, fault and remedy.

use std::fmt;

/// Fault of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileError {
    /// Name of the file as the user wrote it.
    pub file: String,
    /// Line, from 1; `None` if the fault has no line.
    pub line: Option<usize>,
    /// Description of the fault, with the key if there is one.
    pub what: String,
    /// Remedy.
    pub remedy: String,
}

impl FileError {
    /// Returns a fault of the file without a line.
    pub fn new(file: &str, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line: None,
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// Sets the line of the fault.
    #[must_use]
    pub fn in_line(self, line: usize) -> Self {
        Self {
            line: Some(line),
            ..self
        }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(&self.file))?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}; {}", one_line(&self.what), one_line(&self.remedy))
    }
}

impl std::error::Error for FileError {}

/// Fault with its remedy.
pub type Broken = (String, String);

/// Requires a condition of a file; `what` describes the violation.
///
/// # Errors
/// Violated condition.
pub fn require(holds: bool, what: impl Into<String>, remedy: &str) -> Result<(), Broken> {
    match holds {
        true => Ok(()),
        false => Err((what.into(), remedy.to_owned())),
    }
}

/// Returns the text on one line, control characters made visible, cut if very long.
pub fn one_line(text: &str) -> String {
    cut(text, 400)
}

/// Returns the first `longest` characters of the text on one line, control characters made visible; an ellipsis marks
/// the cut.
pub fn cut(text: &str, longest: usize) -> String {
    let mut line = String::new();
    for c in text.chars().take(longest) {
        match c {
            '\n' | '\r' | '\t' => line.push(' '),
            c if c.is_control() => line.extend(c.escape_default()),
            c => line.push(c),
        }
    }
    if text.chars().nth(longest).is_some() {
        line.push_str("...");
    }
    line
}

/// Quotes a user's text in a message, shortened.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((cut, _)) => format!("\"{}...\"", &text[..cut]),
        None => format!("\"{text}\""),
    }
}
