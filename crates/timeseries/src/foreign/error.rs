//! Errors of foreign files. Every message is one line with its remedy.

/// Error of a foreign file, with its remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ForeignError(pub(super) String);

impl ForeignError {
    /// Returns the error of a file that cannot be read.
    pub fn unreadable(error: impl std::fmt::Display) -> Self {
        Self(format!(
            "cannot be read: {error}; give a text file of separated values"
        ))
    }
}

/// Lists the first entries, and the number of the others.
pub fn first_of(list: &[String], most: usize, between: &str) -> String {
    let mut first = list[..most.min(list.len())].to_vec();
    if list.len() > most {
        first.push(format!("{} more", list.len() - most));
    }
    first.join(between)
}

/// Shortens a foreign text to one line for a message.
pub(super) fn short(text: &str) -> String {
    pinwheel_files::cut(text, 40)
}
