//! Origin of a result: program, command, machine and day; and the envelope of every `summary.json`.

use std::path::Path;

use serde::Serialize;

use crate::output::{OutputError, write_json};

/// Processor, cores, operating system, and how the program was built.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Model name, or the architecture if the system does not report it.
    pub processor: String,
    /// Number of available cores.
    pub cores: usize,
    /// Operating system.
    pub operating_system: String,
    /// Build type `optimised` or `debug`; times of the latter are meaningless.
    pub build: &'static str,
}

/// Origin of a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Version of Pinwheel.
    pub version: &'static str,
    /// Command that repeats the result, or the calling program.
    pub command: String,
    /// Machine of the computation.
    pub machine: Machine,
    /// Day in UTC, `2026-01-31`.
    pub date: String,
}

impl Provenance {
    /// Describes this program on this machine, today.
    pub fn here(command: impl Into<String>) -> Self {
        Self {
            version: VERSION,
            command: command.into(),
            machine: Machine::here(),
            date: today(),
        }
    }

    /// Returns the versions for a page, with those of the engines after Pinwheel's.
    pub fn versions(&self) -> Vec<(String, String)> {
        vec![("pinwheel".to_owned(), self.version.to_owned())]
    }
}

/// Returns the day in UTC, `2026-01-31`.
#[expect(clippy::disallowed_methods, reason = "a day, no duration")]
fn today() -> String {
    let now = humantime::format_rfc3339_seconds(std::time::SystemTime::now());
    now.to_string().chars().take(10).collect()
}

/// Hash of the sources that determine figures (see `build.rs`): a changed solver gives other numbers under the same
/// version.
pub(crate) const SOURCES: &str = env!("PINWHEEL_SOURCES");

/// Version of Pinwheel.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Content of every `summary.json`: the origin and the results.
#[derive(Debug, Serialize)]
pub struct Summary<'a, T: Serialize> {
    pinwheel_version: &'static str,
    command: &'a str,
    #[serde(flatten)]
    results: T,
    machine: &'a Machine,
}

impl<'a, T: Serialize> Summary<'a, T> {
    /// Adds the origin to the results `results`, with keys on the same level.
    pub fn new(origin: &'a Provenance, results: T) -> Self {
        Self {
            pinwheel_version: origin.version,
            command: &origin.command,
            results,
            machine: &origin.machine,
        }
    }

    /// Writes `summary.json` into the folder `dir`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), OutputError> {
        write_json(&dir.join("summary.json"), self)
    }
}

impl Machine {
    /// Describes this machine.
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

    /// Returns processor and operating system.
    pub fn named(&self) -> String {
        format!("{}, {}", self.processor, self.operating_system)
    }

    /// Returns pairs of label and value.
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

/// Returns the value of the first line `key<separator>value` in a small system file.
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
