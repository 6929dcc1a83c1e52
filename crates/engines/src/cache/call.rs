//! Calls of Python, pip and compilers: their last words on failure, their current line as progress.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

use crate::process::{self, End};

/// Longest piece of a failed call's output that goes into an error, bytes.
const LAST_WORDS: usize = 400;
/// Lines of a progress note that fit beside its title.
const LINE: usize = 70;

/// A line on the terminal with what goes on and for how long; nothing when stderr is no terminal.
pub struct Note(ProgressBar);

impl Note {
    pub fn new(title: &'static str) -> Self {
        let bar = ProgressBar::new_spinner().with_finish(ProgressFinish::AndClear);
        if let Ok(style) = ProgressStyle::with_template("{prefix}: {msg} [{elapsed}]") {
            bar.set_style(style);
        }
        bar.set_prefix(title);
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    pub fn say(&self, text: &str) {
        let line: String = text.chars().take(LINE).collect();
        self.0.set_message(line);
    }
}

/// Settings of pip that say how to reach packages; all others (`PIP_TARGET`, `PIP_DRY_RUN`, ...) would install
/// something else, or elsewhere.
const PIP_MAY: &str = "CACHE_DIR CERT CLIENT_CERT CONFIG_FILE DEFAULT_TIMEOUT EXTRA_INDEX_URL FIND_LINKS INDEX_URL \
                       KEYRING_PROVIDER NO_CACHE_DIR NO_INDEX PROXY RETRIES TIMEOUT TRUSTED_HOST";

/// True if a variable of the user's environment is withheld from Python and pip.
pub fn kept_away(name: &str) -> bool {
    let may = |setting| PIP_MAY.split(' ').any(|known| known == setting);
    name.strip_prefix("PIP_")
        .is_some_and(|setting| !may(setting))
}

/// Runs to the end and returns standard output; ended as soon as `cancel` is set. The error is the call's own last words.
pub fn call<S: AsRef<OsStr>>(
    program: &Path,
    arguments: impl IntoIterator<Item = S>,
    note: Option<&Note>,
    cancel: &AtomicBool,
) -> Result<String, String> {
    let away = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    let mut command = Command::new(program);
    for name in away.filter(|name| kept_away(name)) {
        command.env_remove(name);
    }
    command.args(arguments).env("PYTHONUTF8", "1");
    let (mut output, mut complaints) = (Vec::new(), Vec::new());
    let ended = process::run(&mut command, None, &mut |piece| {
        match piece {
            Some(piece) if piece.stderr => complaints.extend(&piece.bytes),
            Some(piece) => {
                output.extend(&piece.bytes);
                let text = String::from_utf8_lossy(&piece.bytes);
                if let (Some(note), Some(line)) = (note, text.lines().last()) {
                    note.say(line.trim());
                }
            }
            None => {}
        }
        let stop = cancel.load(Ordering::Relaxed);
        stop.then_some(End::Cancelled)
    });
    let ended = ended.map_err(|error| format!("{} does not start: {error}", program.display()))?;
    let End::Status(status) = ended.end else {
        return Err("stopped".to_owned());
    };
    let [output, complaints] =
        [output, complaints].map(|text| String::from_utf8_lossy(&text).into_owned());
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
    let line = line.trim_start_matches("ERROR:").trim();
    Some(line.chars().take(LAST_WORDS).collect())
}
