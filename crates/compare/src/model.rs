//! Stated tolerances of engines whose contact model differs from the native one.
//!
//! These are statements on models, not on scenes: a bed of 4000 springs resolves a contact patch to so much, a
//! polyline disc with one linear spring to so much. They hold for any gear; a scene that breaks one is a finding.

use serde::Serialize;

use crate::limits::{Friction, fits};
use crate::metrics::Metric;
use crate::participant::{Energy, Participant};
use crate::windows::{Window, WindowKind};

/// Predicted difference between an engine and a native run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Prediction {
    /// None: the models aim at the same number.
    Same,
    /// The driver needs less power by what the contact law creates: the remainder of the native energy account as a
    /// share of the larger work. 0 for a law with a potential.
    LawEnergy,
}

/// One statement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ModelTolerance {
    /// Frictionless scenes, those with friction, or all.
    pub friction: Friction,
    /// Window; `None` for all.
    pub window: Option<WindowKind>,
    /// Quantity, a pattern.
    pub quantity: &'static str,
    /// Metric.
    pub metric: Metric,
    /// The difference predicted.
    pub predicted: Prediction,
    /// Tolerance around the prediction, beside numerical uncertainty.
    pub tolerance: f64,
    /// Why.
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

/// The account of the part of the run that a window is, or that overlaps it most; `None` without an account.
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

/// The difference of the mean driver torques predicted from both energy accounts, signed as
/// [`signed_mean_difference`](crate::metrics::PairMetrics::signed_mean_difference): energy that a law creates the
/// driver need not bring. An engine without an account is taken to create none; `None` if neither keeps one.
#[doc(hidden)]
pub fn predicted(a: &Participant, b: &Participant, window: &Window) -> Option<f64> {
    let share = |p: &Participant| account(p, window)?.remainder_share;
    match (share(a), share(b)) {
        (None, None) => None,
        (of_a, of_b) => Some(of_b.unwrap_or(0.0) - of_a.unwrap_or(0.0)),
    }
}
