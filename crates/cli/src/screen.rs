//! Writing to the terminal: colours only where they are seen, a closed pipe is no error.

use std::io::{ErrorKind, Write as _};

use pinwheel::report::terminal::{BAD, styled};

use crate::failure::Failure;

/// Writes results to stdout, with a final newline.
pub(crate) fn show(text: &str) -> Result<(), Failure> {
    let mut stdout = anstream::stdout().lock();
    match writeln!(stdout, "{}", text.trim_end()).and_then(|()| stdout.flush()) {
        // The reader (head, less) has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::input(format!(
            "the results cannot be written to stdout: {error}; send them elsewhere"
        ))),
        Ok(()) => Ok(()),
    }
}

/// The same for what another program reads.
pub(crate) fn show_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|error| {
        Failure::input(format!(
            "the results cannot be written as JSON: {error}; leave out --json"
        ))
    })?;
    show(&text)
}

/// Writes to stderr; if that fails there is nobody left to tell.
pub(crate) fn show_on_stderr(text: &str) {
    let _ = writeln!(anstream::stderr().lock(), "{}", text.trim_end());
}

/// `error: ...` on one line.
pub(crate) fn complain(message: &str) {
    show_on_stderr(&format!("{}: {message}", styled(BAD, "error")));
}
