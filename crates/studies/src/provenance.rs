//! Origin of a result: program, command, machine and day; and the envelope of every `summary.json`.

use std::path::Path;

use serde::Serialize;

use crate::output::{OutputError, write_json};

/// Processor, cores, operating system, and how the program was built.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Model name, or the architecture where the system does not tell.
    pub processor: String,
    /// Cores this program may use.
    pub cores: usize,
    /// Operating system.
    pub operating_system: String,
    /// `optimised` or `debug`: times of the latter mean nothing.
    pub build: &'static str,
}

/// Origin of a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Version of Pinwheel.
    pub version: &'static str,
    /// The command that repeats it, or a word on the program that called.
    pub command: String,
    /// Where it was computed.
    pub machine: Machine,
    /// Day in UTC, `2026-01-31`.
    pub date: String,
}

impl Provenance {
    /// This program on this machine, today.
    #[must_use]
    pub fn here(command: impl Into<String>) -> Self {
        Self {
            version: VERSION,
            command: command.into(),
            machine: Machine::here(),
            date: today(),
        }
    }

    /// The entry of a page's list of versions, with those of the engines after it.
    #[must_use]
    pub fn versions(&self) -> Vec<(String, String)> {
        vec![("pinwheel".to_owned(), self.version.to_owned())]
    }
}

/// The day in UTC, `2026-01-31`.
#[expect(clippy::disallowed_methods, reason = "a day, no duration")]
fn today() -> String {
    let now = humantime::format_rfc3339_seconds(std::time::SystemTime::now());
    now.to_string().chars().take(10).collect()
}

/// The sources that figures come from, as a hash (see `build.rs`): a changed solver gives other numbers under the same
/// version.
pub(crate) const SOURCES: &str = env!("PINWHEEL_SOURCES");

/// Version of Pinwheel.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// `summary.json` of every command: what made it, around what was found.
#[derive(Debug, Serialize)]
pub struct Summary<'a, T: Serialize> {
    pinwheel_version: &'static str,
    command: &'a str,
    #[serde(flatten)]
    found: T,
    machine: &'a Machine,
}

impl<'a, T: Serialize> Summary<'a, T> {
    /// The envelope around `found`, whose keys stand beside the envelope's.
    pub fn new(made: &'a Provenance, found: T) -> Self {
        Self {
            pinwheel_version: made.version,
            command: &made.command,
            found,
            machine: &made.machine,
        }
    }

    /// Writes it as `summary.json` into the folder `dir`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), OutputError> {
        write_json(&dir.join("summary.json"), self)
    }
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            operating_system: operating_system(),
            build: if cfg!(debug_assertions) {
                "debug"
            } else {
                "optimised"
            },
        }
    }

    /// Processor and operating system.
    #[must_use]
    pub fn named(&self) -> String {
        format!("{}, {}", self.processor, self.operating_system)
    }

    /// As pairs of label and value.
    pub fn rows(&self) -> Vec<(String, String)> {
        [
            ("processor", self.processor.clone()),
            ("cores", self.cores.to_string()),
            ("operating system", self.operating_system.clone()),
            ("build", self.build.to_owned()),
        ]
        .map(|(label, value)| (label.to_owned(), value))
        .into()
    }
}

/// The value of the first line `key<separator>value` in a small system file.
fn line_value(path: &str, key: &str, separator: char) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    text.lines().find_map(|line| {
        let (name, value) = line.split_once(separator)?;
        (name.trim() == key).then(|| value.trim().trim_matches('"').to_owned())
    })
}

fn processor() -> Option<String> {
    line_value("/proc/cpuinfo", "model name", ':').filter(|name| !name.is_empty())
}

fn operating_system() -> String {
    let name = line_value("/etc/os-release", "PRETTY_NAME", '=')
        .unwrap_or_else(|| std::env::consts::OS.to_owned());
    format!("{name}, {}", std::env::consts::ARCH)
}
