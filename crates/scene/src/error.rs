//! Errors of a scene. Every message is one line with place, fault and remedy.

use std::borrow::Cow;
use std::fmt;

use pinwheel_files::{FileError, one_line};

/// Source of a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Location {
    /// Line of the scene file; the first is 1.
    Line {
        /// File or preset as the user named it.
        source: String,
        /// Line number.
        line: usize,
    },
    /// Scene file without useful line numbers (JSON).
    File {
        /// File as the user named it.
        source: String,
    },
    /// Override on the command line, as typed: `gear.wheels=1`.
    Set(String),
    /// Omitted key with its default value.
    Default {
        /// File or preset as the user named it.
        source: String,
    },
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { source, line } => write!(f, "{}, line {line}", one_line(source)),
            Self::File { source } => write!(f, "{}", one_line(source)),
            Self::Set(text) => write!(f, "--set {}", one_line(text)),
            Self::Default { source } => write!(f, "{} (not written there)", one_line(source)),
        }
    }
}

/// Faults in locating, reading, parsing or checking a scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// Text that names neither a preset nor a file.
    #[error("there is no preset and no file `{}`; {remedy}", one_line(.spec))]
    NotFound {
        /// Text as typed.
        spec: String,
        /// Nearest preset, or the list of all presets.
        remedy: String,
    },
    /// File that cannot be read, or is neither TOML nor JSON.
    #[error(transparent)]
    File(#[from] FileError),
    /// `--set` without `key=value`.
    #[error("--set {}: {what}; write --set key=value, for example --set gear.backlash_m=0.0006", one_line(.text))]
    Override {
        /// Text as typed.
        text: String,
        /// Description of the fault.
        what: &'static str,
    },
    /// Omitted keys without a default.
    #[error("{}: gives no {}; write them, or begin with `base = \"paper\"` (any preset or scene file) to take from it what is left out", one_line(.source_name), list(.keys))]
    Missing {
        /// File or preset.
        source_name: String,
        /// Missing keys.
        keys: Vec<&'static str>,
    },
    /// Fault of a key or its value.
    #[error("{place}: `{}` {}; {}", one_line(.key), one_line(.what), one_line(.remedy))]
    Key {
        /// Source of the value.
        place: Location,
        /// Full key, for example `gear.wheels`.
        key: String,
        /// Description of the fault.
        what: String,
        /// Remedy.
        remedy: String,
    },
}

impl SceneError {
    /// Returns a fault of a key.
    pub(crate) fn key(
        place: &Location,
        key: &str,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Key {
            place: place.clone(),
            key: key.to_owned(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }
}

/// Fault that a check reports; the caller adds its place in the file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{}` {}; {}", .keys.first().map_or("scene", AsRef::as_ref), one_line(.what), one_line(.remedy))]
pub struct Fault {
    /// Keys involved, the likeliest culprit first.
    pub keys: Vec<Cow<'static, str>>,
    /// Fault of the first key, a predicate: "is -1 m, but must be above 0 m".
    pub what: String,
    /// Remedy.
    pub remedy: String,
}

impl Fault {
    /// Creates a fault of `keys`, the likeliest culprit first.
    pub(super) fn new(
        keys: &[&'static str],
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            keys: keys.iter().map(|&key| Cow::Borrowed(key)).collect(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }
}

/// Joins keys as `a`, `b` and `c`.
fn list(keys: &[&str]) -> String {
    let quoted: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}
