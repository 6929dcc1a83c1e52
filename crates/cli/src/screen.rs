//! Output to the terminal: colours only on a terminal, a closed pipe is no error, and control characters in files or names
//! are removed.

use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::sync::OnceLock;

use pinwheel::report::sanitize::{sanitize, shortened};
use pinwheel::report::terminal::{BAD, paragraph, styled};
use pinwheel::studies::output::reason;

use crate::args::manner::Manner;
use crate::failure::{DIFFER, Failure};

static MANNER: OnceLock<Manner> = OnceLock::new();
/// Answer of a study, by default the first paragraph of its text.
static ANSWER: OnceLock<String> = OnceLock::new();

/// Sets the options for the program's output.
pub(crate) fn speak(manner: Manner) {
    manner.color.write_global();
    let _ = MANNER.set(manner);
}

/// Returns the options for the program's output.
pub(crate) fn manner() -> Manner {
    MANNER.get().copied().unwrap_or_default()
}

/// Name of the file that every study writes for programs.
pub(crate) const SUMMARY: &str = "summary.json";

/// Writes results to stdout, with a final newline.
pub(crate) fn show(text: &str) -> Result<(), Failure> {
    let mut stdout = anstream::stdout().lock();
    match writeln!(stdout, "{}", sanitize(text.trim_end(), true)).and_then(|()| stdout.flush()) {
        // The reader (head, less) has closed the pipe.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::input(format!(
            "the results cannot be written to stdout: {}; send them elsewhere",
            reason(&error)
        ))),
        Ok(()) => Ok(()),
    }
}

/// Writes the text of a study's results, or on request the JSON of its folder, or less.
pub(crate) fn show_found(text: &str, folder: &Path, file: &str) -> Result<(), Failure> {
    if manner().json {
        let path = folder.join(file);
        let unread = |error: std::io::Error| {
            let (path, why) = (path.display(), reason(&error));
            Failure::input(format!("{path} cannot be read: {why}"))
        };
        return show(&std::fs::read_to_string(&path).map_err(unread)?);
    }
    if !(manner().quiet || text.is_empty()) {
        show(text)?;
    }
    if manner().verbose {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.filter(|name| !name.starts_with('.')).collect();
        names.sort();
        show(&paragraph(&format!("files: {}", names.join(", "))))?;
    }
    Ok(())
}

/// Writes a study's text or JSON, then the path of its page.
pub(crate) fn show_with_page(text: &str, page: &Path) -> Result<(), Failure> {
    let folder = page.parent().unwrap_or(page);
    let answer = text.trim_start().split("\n\n").next().unwrap_or_default();
    self::answer(anstream::adapter::strip_str(answer).to_string());
    show_found(text, folder, SUMMARY)?;
    if manner().json {
        return Ok(());
    }
    let line = sanitize(&page.display().to_string(), false);
    let mut stdout = std::io::stdout().lock();
    // The results are out already.
    let _ = writeln!(stdout, "page: {line}").and_then(|()| stdout.flush());
    Ok(())
}

/// Returns a value as JSON for other programs.
pub(crate) fn as_json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|error| {
        Failure::input(format!(
            "the results cannot be written as JSON: {error}; leave out --json"
        ))
    })
}

/// Writes a value as JSON for other programs.
pub(crate) fn show_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    show(&as_json(value)?)
}

/// Writes a value as JSON on request, else as a text.
pub(crate) fn show_or_json(
    value: &impl serde::Serialize,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    match manner().json {
        true => show_json(value),
        false => show(&text()),
    }
}

/// Writes to stderr; a failure is ignored, because there is no other place to report it.
pub(crate) fn show_on_stderr(text: &str) {
    let text = sanitize(text.trim_end(), true);
    let _ = writeln!(anstream::stderr().lock(), "{text}");
}

/// Writes `note: ...` on one line, except in quiet mode.
pub(crate) fn warn(message: &str) {
    if !manner().quiet {
        show_on_stderr(&format!("note: {}", sanitize(&shortened(message), false)));
    }
}

/// Writes `error: ...` on one line.
pub(crate) fn complain(message: &str) {
    let message = sanitize(&shortened(message), false);
    show_on_stderr(&format!("{}: {message}", styled(BAD, "error")));
    annotate("error", &message);
}

/// Stores the first answer of a study as text, and ignores later ones.
pub(crate) fn answer(words: String) {
    let _ = ANSWER.set(words);
}

/// Annotates a run of GitHub Actions with an answer other than success: an error for differing or worse results, a warning
/// for inconclusive ones. The message is the answer in words.
pub(crate) fn annotate_answer(status: u8) {
    let level = match status {
        0 => return,
        DIFFER => "error",
        _ => "warning",
    };
    if let Some(answer) = ANSWER.get() {
        annotate(level, answer);
    }
}

/// Writes a workflow command of GitHub Actions to stderr, if the program runs there. A message `FILE, line N: ...` refers
/// to that line.
fn annotate(level: &str, message: &str) {
    if std::env::var("GITHUB_ACTIONS").is_ok_and(|is_there| is_there == "true") {
        let _ = writeln!(std::io::stderr().lock(), "{}", annotation(level, message));
    }
}

fn annotation(level: &str, message: &str) -> String {
    let escaped = |text: &str, more: &[(char, &str)]| {
        let all = [('%', "%25"), ('\r', "%0D"), ('\n', "%0A")];
        let all = all.iter().chain(more);
        all.fold(text.to_owned(), |text, (from, to)| text.replace(*from, to))
    };
    let place = message.split_once(": ").and_then(|(place, _)| {
        let (file, line) = place.rsplit_once(", line ")?;
        Some((file, line.parse::<usize>().ok()?))
    });
    let place = place.map(|(file, line)| {
        let file = escaped(file, &[(':', "%3A"), (',', "%2C")]);
        format!(" file={file},line={line}")
    });
    let (place, message) = (place.unwrap_or_default(), escaped(message, &[]));
    format!("::{level}{place}::{message}")
}

#[cfg(test)]
mod tests {
    use super::annotation;

    #[test]
    fn annotations_stand_at_the_line_of_the_fault() {
        let text = annotation(
            "error",
            "a,b.toml, line 7: `gear.wheels` is 0; at least 1, not 100 %",
        );
        let there = "::error file=a%2Cb.toml,line=7::a,b.toml, line 7: `gear.wheels` is 0; at least 1, not 100 %25";
        assert_eq!(text, there);
        assert_eq!(
            annotation("warning", "nothing\nshown: 1"),
            "::warning::nothing%0Ashown: 1"
        );
    }
}
