//! The machine a run was timed on.

use serde::Serialize;

/// Processor, cores, operating system, and how the program was built.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Machine {
    /// Model name, or the architecture where the system does not tell.
    pub(crate) processor: String,
    /// Cores this program may use.
    pub(crate) cores: usize,
    /// Operating system.
    pub(crate) operating_system: String,
    /// `optimised` or `debug`: times of the latter mean nothing.
    pub(crate) build: &'static str,
}

impl Machine {
    /// This machine.
    pub(crate) fn here() -> Self {
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

    /// As pairs of label and value.
    pub(crate) fn rows(&self) -> Vec<(String, String)> {
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
