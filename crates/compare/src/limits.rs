//! Limits that users state, and which quantities and engines they are about.
//!
//! Patterns: `*` stands for any characters, `|` separates alternatives.

use serde::Serialize;

use crate::metrics::Metric;
use crate::windows::WindowKind;

/// Scenes to which a tolerance applies, by their friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Friction {
    /// Scenes with and without friction.
    Any,
    /// mu = 0.
    Without,
    /// mu > 0.
    With,
}

/// A limit that the owner of measured data states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedLimit {
    /// Name of the participant.
    pub engine: String,
    /// Window.
    pub window: WindowKind,
    /// Quantity, a pattern.
    pub quantity: String,
    /// Metric.
    pub metric: Metric,
    /// The limit itself.
    pub limit: f64,
    /// Why it is what it is.
    pub reason: String,
}

/// Forces and torques below this share of the scene's own scale are rounding, and are not judged: 16 digits, times
/// some ten thousand for what 28 bodies and a solver add.
pub const NEGLIGIBLE_SHARE: f64 = 1e-11;

/// True if `text` fits one of the alternatives of `pattern`.
#[must_use]
pub fn fits(pattern: &str, text: &str) -> bool {
    pattern
        .split('|')
        .any(|one| pinwheel_files::fits(one, text))
}
