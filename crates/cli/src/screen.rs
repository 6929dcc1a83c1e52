//! Writing to the terminal: colours only where they are seen, a closed pipe is no error, and nothing that a file or a
//! name holds steers the terminal.

use std::io::{ErrorKind, Write as _};
use std::path::Path;

use pinwheel::report::sanitize::{address, sanitize, shortened};
use pinwheel::report::terminal::{BAD, styled};
use pinwheel::studies::output::reason;

use crate::failure::Failure;

/// Writes results to stdout, with a final newline.
pub(crate) fn show(text: &str) -> Result<(), Failure> {
    let mut stdout = anstream::stdout().lock();
    match writeln!(stdout, "{}", sanitize(text.trim_end(), true)).and_then(|()| stdout.flush()) {
        // The reader (head, less) has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::input(format!(
            "the results cannot be written to stdout: {}; send them elsewhere",
            reason(&error)
        ))),
        Ok(()) => Ok(()),
    }
}

/// Writes results and where their page is; on terminals that know links, one to click.
pub(crate) fn show_with_page(text: &str, page: &Path) -> Result<(), Failure> {
    if !text.is_empty() {
        show(text)?;
    }
    let place = page.display().to_string();
    let place = sanitize(&place, false);
    let linked = supports_hyperlinks::on(supports_hyperlinks::Stream::Stdout);
    let line = match address(page).filter(|_| linked) {
        Some(address) => format!("\u{1b}]8;;{address}\u{1b}\\{place}\u{1b}]8;;\u{1b}\\"),
        None => place,
    };
    let mut stdout = std::io::stdout().lock();
    // The results are out already.
    let _ = writeln!(stdout, "page: {line}").and_then(|()| stdout.flush());
    Ok(())
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

/// One or the other.
pub(crate) fn show_or_json(
    json: bool,
    value: &impl serde::Serialize,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    if json {
        show_json(value)
    } else {
        show(&text())
    }
}

/// Writes to stderr; if that fails there is nobody left to tell.
pub(crate) fn show_on_stderr(text: &str) {
    let _ = writeln!(
        anstream::stderr().lock(),
        "{}",
        sanitize(text.trim_end(), true)
    );
}

/// `error: ...` on one line.
pub(crate) fn complain(message: &str) {
    let message = sanitize(&shortened(message), false);
    show_on_stderr(&format!("{}: {message}", styled(BAD, "error")));
}
