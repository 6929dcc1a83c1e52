//! Words of the command line.

use std::ffi::OsString;
use std::process::Command;
use std::sync::OnceLock;

static WORDS: OnceLock<Vec<OsString>> = OnceLock::new();
static INTERPRETER: OnceLock<OsString> = OnceLock::new();

/// Names the Python that runs the program as its module `pinwheel`.
pub fn within(interpreter: OsString) {
    let _ = INTERPRETER.set(interpreter);
}

/// Returns a command that runs the same words in another process; `None` if no program is known.
pub(crate) fn again() -> Option<Command> {
    let mut command = match INTERPRETER.get() {
        Some(python) => Command::new(python),
        None => Command::new(std::env::current_exe().ok()?),
    };
    if INTERPRETER.get().is_some() {
        command.args(["-P", "-m", "pinwheel"]);
    }
    command.args(typed());
    Some(command)
}

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
