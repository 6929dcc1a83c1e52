//! Stated tolerances of engines whose contact model differs from the native one.
//!
//! Tolerances belong to models, not to scenes: they state how far a bed of 4000 springs, or a polyline disc with one linear
//! spring, is from the native contact. They apply to any gear; a scene that exceeds one is a finding.

use serde::Serialize;

use crate::limits::{Friction, fits};
use crate::metrics::Metric;
use crate::participant::{Energy, Participant};
use crate::windows::{Window, WindowKind};

/// Predicted difference between an engine and a native run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Prediction {
    /// No predicted difference: both models compute the same value.
    Same,
    /// Energy created by the contact law, which the driver need not supply: the remainder of the native energy account as a
    /// share of the larger work; 0 for a law with a potential.
    LawEnergy,
}

/// Stated tolerance of an engine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ModelTolerance {
    /// Frictionless scenes, those with friction, or all.
    pub friction: Friction,
    /// Window; `None` for all.
    pub window: Option<WindowKind>,
    /// Pattern of quantities.
    pub quantity: &'static str,
    /// Metric.
    pub metric: Metric,
    /// Predicted difference.
    pub predicted: Prediction,
    /// Tolerance around the prediction, in addition to numerical uncertainty.
    pub tolerance: f64,
    /// Reason of the tolerance.
    pub reason: &'static str,
}

impl ModelTolerance {
    /// True if the tolerance applies to this friction, window and quantity.
    pub fn applies(&self, friction: bool, window: WindowKind, quantity: &str) -> bool {
        let suits = match self.friction {
            Friction::Any => true,
            Friction::With => friction,
            Friction::Without => !friction,
        };
        suits && self.window.is_none_or(|w| w == window) && fits(self.quantity, quantity)
    }
}

/// Returns the energy account of the window, or of the part of the run that overlaps it most; `None` without an account.
#[doc(hidden)]
pub fn account<'a>(participant: &'a Participant, window: &Window) -> Option<&'a Energy> {
    let overlap = |e: &Energy| e.overlap(window.from_s, window.to_s);
    participant
        .cost
        .energy
        .iter()
        .filter(|e| overlap(e) > 0.5 && e.remainder_share.is_some_and(f64::is_finite))
        .max_by(|a, b| overlap(a).total_cmp(&overlap(b)))
}

/// Returns the difference of the mean driver torques predicted from both energy accounts, signed as
/// [`signed_mean_difference`](crate::metrics::PairMetrics::signed_mean_difference): the driver need not supply energy that a
/// law creates. An engine without an account counts as creating none; `None` if neither engine has one.
#[doc(hidden)]
pub fn predicted(a: &Participant, b: &Participant, window: &Window) -> Option<f64> {
    let share = |p: &Participant| account(p, window)?.remainder_share;
    match (share(a), share(b)) {
        (None, None) => None,
        (of_a, of_b) => Some(of_b.unwrap_or(0.0) - of_a.unwrap_or(0.0)),
    }
}
