//! Calls of Python, pip and compilers: final message on failure, current line as progress.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

use crate::process::{self, End};

/// Longest part of a failed call's output in an error, bytes.
const LAST_WORDS: usize = 400;
/// Longest line of a progress note beside its title, characters.
const LINE: usize = 70;

/// Progress line on the terminal with elapsed time; nothing if stderr is no terminal.
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

/// Settings of pip for access to packages, which are passed on; all others (`PIP_TARGET`, `PIP_DRY_RUN`, ...) would change the
/// packages or their place.
const PIP_MAY: &str = "CACHE_DIR CERT CLIENT_CERT CONFIG_FILE DEFAULT_TIMEOUT EXTRA_INDEX_URL FIND_LINKS INDEX_URL \
                       KEYRING_PROVIDER NO_CACHE_DIR NO_INDEX PROXY RETRIES TIMEOUT TRUSTED_HOST";

/// True if a variable of the user's environment is withheld from Python and pip.
pub fn kept_away(name: &str) -> bool {
    let may = |setting| PIP_MAY.split(' ').any(|known| known == setting);
    name.strip_prefix("PIP_")
        .is_some_and(|setting| !may(setting))
}

/// Runs a program to its end, or until `cancel` is set, and returns its standard output. The error is the program's final
/// message.
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

/// Returns the last line with content, preferably an error of pip.
fn last_words(text: &str) -> Option<String> {
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let line = lines()
        .rfind(|line| line.starts_with("ERROR:"))
        .or_else(|| lines().next_back())?;
    let line = line.trim_start_matches("ERROR:").trim();
    Some(line.chars().take(LAST_WORDS).collect())
}
