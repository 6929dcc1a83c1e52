//! Overrides: values that replace those of a file's keys.

use std::str::FromStr;

use pinwheel_files::MOST_BYTES;

use crate::error::{Location, SceneError};
use crate::keys::{Kind, key};

/// Override `--set key=value`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    pub(super) key: String,
    pub(super) value: String,
}

impl Override {
    /// Replaces `key` (`gear.backlash_m`) by `value`, a TOML value or a bare word.
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            value: value.into(),
        }
    }

    /// Returns the key, e.g. `gear.backlash_m`.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Returns the value as TOML: a word without quotes is a string, and so is any value of a key for text.
    pub(super) fn toml(&self) -> String {
        let holds_text =
            key(&self.key).is_some_and(|row| matches!(row.kind, Kind::Text | Kind::Choice(..)));
        match toml::Value::from_str(&self.value) {
            Ok(value) if !holds_text || value.is_str() => self.value.clone(),
            _ => toml::Value::from(self.value.as_str()).to_string(),
        }
    }

    pub(super) fn place(&self) -> Location {
        Location::Set(format!("{}={}", self.key, self.value))
    }
}

impl FromStr for Override {
    type Err = SceneError;

    fn from_str(text: &str) -> Result<Self, SceneError> {
        let fault = |what| SceneError::Override {
            text: text.to_owned(),
            what,
        };
        if text.len() > MOST_BYTES {
            return Err(SceneError::Override {
                text: String::new(),
                what: "is far too long",
            });
        }
        let (key, value) = text.split_once('=').ok_or_else(|| fault("has no `=`"))?;
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() {
            return Err(fault("has no key"));
        }
        if value.is_empty() {
            return Err(fault("has no value"));
        }
        Ok(Self::new(key, value))
    }
}
