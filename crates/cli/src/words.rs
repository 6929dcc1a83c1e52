//! Words of the command line.

use std::ffi::OsString;
use std::sync::OnceLock;

static WORDS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Sets the words, the program's name first. They differ from those of the process if Python runs the program.
pub(crate) fn set(words: Vec<OsString>) {
    let _ = WORDS.set(words);
}

/// Returns all words, the program's name first.
pub(crate) fn all() -> &'static [OsString] {
    WORDS.get().map_or(&[], Vec::as_slice)
}

/// Returns the words after the program's name.
pub(crate) fn typed() -> impl Iterator<Item = &'static OsString> {
    all().iter().skip(1)
}
