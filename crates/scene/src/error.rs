//! What can be wrong with a scene. Every message is one line: where, what, and the remedy.

use std::borrow::Cow;
use std::fmt;
use std::path::PathBuf;

/// Where a value came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A line of the scene file, the first being 1.
    Line {
        /// File or preset as the user named it.
        source: String,
        /// Line number.
        line: usize,
    },
    /// A scene file whose lines say nothing to its reader (JSON).
    File {
        /// File as the user named it.
        source: String,
    },
    /// An override on the command line, as typed: `gear.wheels=1`.
    Set(String),
    /// Neither: the key was left at its default.
    Default {
        /// File or preset as the user named it.
        source: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { source, line } => write!(f, "{}, line {line}", one_line(source)),
            Self::File { source } => write!(f, "{}", one_line(source)),
            Self::Set(text) => write!(f, "--set {}", one_line(text)),
            Self::Default { source } => write!(f, "{} (not written there)", one_line(source)),
        }
    }
}

/// Faults of finding, reading, understanding or checking a scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// Neither a preset nor a file.
    #[error("there is no preset and no file `{}`; {remedy}", one_line(.spec))]
    NotFound {
        /// As typed.
        spec: String,
        /// Nearest preset, or all of them.
        remedy: String,
    },
    /// The file is there but cannot be read.
    #[error("{}: cannot be read: {source}; check that it is a file you may read", one_line(&.path.display().to_string()))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// No scene is that long.
    #[error("{}: longer than {limit} bytes, which no scene is; give a scene file (TOML)", one_line(.source_name))]
    TooLong {
        /// File or preset.
        source_name: String,
        /// The bound, bytes.
        limit: usize,
    },
    /// Not text.
    #[error("{}, line {line}: not UTF-8 text; save the scene as UTF-8", one_line(.source_name))]
    NotText {
        /// File or preset.
        source_name: String,
        /// Line of the first bad byte.
        line: usize,
    },
    /// Not TOML, nor JSON.
    #[error("{}, line {line}: not valid {language}: {}; a scene consists of `key = value` lines under [gear], [mass], [drive], [contact] and [solver]", one_line(.source_name), one_line(.what))]
    Syntax {
        /// File or preset.
        source_name: String,
        /// Line of the fault.
        line: usize,
        /// What it was read as.
        language: &'static str,
        /// The parser's words.
        what: String,
    },
    /// `--set` without `key=value`.
    #[error("--set {}: {what}; write --set key=value, for example --set gear.backlash_m=0.0006", one_line(.text))]
    Override {
        /// As typed.
        text: String,
        /// What is wrong.
        what: &'static str,
    },
    /// Keys that nothing can stand in for.
    #[error("{}: gives no {}; write them, or begin with `base = \"paper\"` (any preset or scene file) to take from it what is left out", one_line(.source_name), list(.keys))]
    Missing {
        /// File or preset.
        source_name: String,
        /// The keys.
        keys: Vec<&'static str>,
    },
    /// A key or its value.
    #[error("{place}: `{}` {}; {}", one_line(.key), one_line(.what), one_line(.remedy))]
    Key {
        /// Where it stands.
        place: Place,
        /// Full key, for example `gear.wheels`.
        key: String,
        /// What is wrong.
        what: String,
        /// How to put it right.
        remedy: String,
    },
}

/// A value the checks refuse; its place is added by whoever knows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The keys that take part, the likeliest culprit first.
    pub keys: Vec<Cow<'static, str>>,
    /// What is wrong with the first key, a predicate: "is -1 m, but must be above 0 m".
    pub what: String,
    /// How to put it right.
    pub remedy: String,
}

impl Fault {
    /// A fault of `keys`, the likeliest culprit first.
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

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = self.keys.first().map_or("scene", AsRef::as_ref);
        write!(
            f,
            "`{key}` {}; {}",
            one_line(&self.what),
            one_line(&self.remedy)
        )
    }
}

impl std::error::Error for Fault {}

/// `a`, `b` and `c`.
fn list(keys: &[&str]) -> String {
    let quoted: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// The text on one line, control characters made visible, cut where it gets out of hand.
pub(super) fn one_line(text: &str) -> String {
    const LONGEST: usize = 400;
    let mut line = String::new();
    for (count, c) in text.chars().enumerate() {
        if count == LONGEST {
            line.push_str("...");
            break;
        }
        match c {
            '\n' | '\r' | '\t' => line.push(' '),
            c if c.is_control() => line.extend(c.escape_default()),
            c => line.push(c),
        }
    }
    line
}

/// A user's own text inside a message: quoted, short.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((cut, _)) => format!("\"{}...\"", &text[..cut]),
        None => format!("\"{text}\""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_stay_on_one_line() {
        let error = SceneError::Key {
            place: Place::Line {
                source: "a\nb.toml".to_owned(),
                line: 3,
            },
            key: "gear.x\u{7}".to_owned(),
            what: "is\r\nwrong".to_owned(),
            remedy: "mend it".to_owned(),
        };
        assert_eq!(
            error.to_string(),
            "a b.toml, line 3: `gear.x\\u{7}` is  wrong; mend it"
        );
        assert!(one_line(&"x".repeat(10_000)).len() < 500);
        assert_eq!(quoted("ab"), "\"ab\"");
        assert!(quoted(&"é".repeat(100)).ends_with("...\""));
    }
}
