//! Limits that users state, with patterns for their quantities and engines.
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

/// Limit that the owner of measured data states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedLimit {
    /// Name of the participant.
    pub engine: String,
    /// Window.
    pub window: WindowKind,
    /// Pattern of quantities.
    pub quantity: String,
    /// Metric.
    pub metric: Metric,
    /// Largest permitted value of the metric.
    pub limit: f64,
    /// Reason of the limit, in the owner's words.
    pub reason: String,
}

/// Share of the scene's scale below which forces and torques are rounding and are not judged: 1e-16 times the ten thousand
/// roundings that 28 bodies and a solver add up.
pub const NEGLIGIBLE_SHARE: f64 = 1e-11;

/// True if `text` fits one of the alternatives of `pattern`.
pub fn fits(pattern: &str, text: &str) -> bool {
    let mut each = pattern.split('|');
    each.any(|one| pinwheel_files::fits(one, text))
}
