//! Calls of Python and pip: their last words on failure, their current line as progress.

use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Longest piece of a failed call's output that goes into an error, bytes.
const LAST_WORDS: usize = 400;
/// Lines of a progress note that fit beside its title.
const LINE: usize = 70;

/// A line on the terminal with what goes on and for how long; nothing when stderr is no terminal.
pub(super) struct Note(ProgressBar);

impl Note {
    pub(super) fn new(title: &'static str) -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{prefix}: {msg} [{elapsed}]") {
            bar.set_style(style);
        }
        bar.set_prefix(title);
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    pub(super) fn say(&self, text: &str) {
        self.0
            .set_message(text.chars().take(LINE).collect::<String>());
    }
}

impl Drop for Note {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Runs to the end and returns standard output. The error is the call's own last words.
pub(super) fn call<S: AsRef<OsStr>>(
    program: &Path,
    arguments: impl IntoIterator<Item = S>,
    note: Option<&Note>,
) -> Result<String, String> {
    let mut child = Command::new(program)
        .args(arguments)
        .env("PYTHONUTF8", "1")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{} does not start: {error}", program.display()))?;
    let stderr = child.stderr.take();
    let complaints = thread::spawn(move || {
        let mut text = Vec::new();
        if let Some(mut stderr) = stderr {
            let _ = stderr.read_to_end(&mut text);
        }
        String::from_utf8_lossy(&text).into_owned()
    });
    let mut output = String::new();
    for line in child
        .stdout
        .take()
        .map(BufReader::new)
        .into_iter()
        .flat_map(BufRead::lines)
    {
        let Ok(line) = line else { break };
        if let Some(note) = note {
            note.say(line.trim());
        }
        output.push_str(&line);
        output.push('\n');
    }
    let status = child.wait().map_err(|error| error.to_string())?;
    let complaints = complaints.join().unwrap_or_default();
    if status.success() {
        return Ok(output);
    }
    Err(last_words(&complaints)
        .or_else(|| last_words(&output))
        .unwrap_or_else(|| status.to_string()))
}

/// The last line that says something, pip's errors before others.
fn last_words(text: &str) -> Option<String> {
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let line = lines()
        .rfind(|line| line.starts_with("ERROR:"))
        .or_else(|| lines().next_back())?;
    Some(
        line.trim_start_matches("ERROR:")
            .trim()
            .chars()
            .take(LAST_WORDS)
            .collect(),
    )
}

/// The interpreter of an environment.
pub(super) fn python_of(folder: &Path) -> PathBuf {
    if cfg!(windows) {
        folder.join("Scripts").join("python.exe")
    } else {
        folder.join("bin").join("python")
    }
}
