//! How far engines with a contact model of their own may be from ours, as they state it.
//!
//! These are statements on models, not on scenes: a bed of 4000 springs resolves a contact patch to so much, a
//! polyline wheel with one linear spring to so much. They hold for any gear; a scene that breaks one is a finding.

use serde::Serialize;

use crate::limits::{Friction, fits};
use crate::metrics::Metric;
use crate::participant::{Energy, Participant};
use crate::windows::{Window, WindowKind};

/// What difference is predicted between an engine and a native run.
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
    /// Engine, a pattern.
    pub engine: &'static str,
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
    /// How far from the prediction the engine may be, beside numerical uncertainty.
    pub tolerance: f64,
    /// Why.
    pub reason: &'static str,
}

macro_rules! statements {
    ($($engine:literal, $friction:ident, $window:expr, $quantity:literal, $metric:ident, $predicted:ident,
       $tolerance:literal, $reason:literal;)*) => {
        &[$(ModelTolerance {
            engine: $engine,
            friction: Friction::$friction,
            window: $window,
            quantity: $quantity,
            metric: Metric::$metric,
            predicted: Prediction::$predicted,
            tolerance: $tolerance,
            reason: $reason,
        },)*]
    };
}

const STEADY: Option<WindowKind> = Some(WindowKind::Steady);

/// What the engines of this project state. Of each quantity and metric the first that fits counts.
pub const TOLERANCES: &[ModelTolerance] = statements! {
    "mujoco*|exudyn*", Without, STEADY, "input_torque_n_m", Mean, LawEnergy, 5e-3,
    "A bed of springs conserves energy; what the law creates is predicted, its edges and damping are not.";
    "mujoco*|exudyn*", Without, STEADY, "output_torque_n_m", RelativeL2, Same, 1e-2,
    "Ripple about the same mean.";
    "mujoco*|exudyn*", Without, STEADY, "external_sleeve_force_n", RelativeL2, Same, 4.5e-2,
    "A bed of 4000 springs or 8000 segments; falls with their number.";
    "mujoco*|exudyn*", Without, STEADY, "internal_sleeve_force_n", RelativeL2, Same, 1.5e-2,
    "The law itself but for the ramp S, under external forces that differ.";
    "rapier*hook*", Without, None, "*_sleeve_force_n|*_torque_n_m|output_angle_rad", RelativeL2, Same, 0.0,
    "Our normal forces in rapier's solver: without friction no difference of the model is left.";
    "rapier*hook*", With, STEADY, "*_sleeve_force_n|*_torque_n_m|output_angle_rad", RelativeL2, Same, 2e-3,
    "Coulomb friction against its regularised form.";
    "rapier*collider*", With, STEADY, "input_torque_n_m", Mean, LawEnergy, 2.5e-2,
    "Linear spring, polyline wheels; Coulomb friction holds sleeves that the regularised one lets creep.";
    "rapier*collider*", Without, STEADY, "input_torque_n_m", Mean, LawEnergy, 1.5e-2,
    "Linear spring of a stiffness that depends on pairs of masses, polyline wheels.";
    "rapier*collider*", Any, STEADY, "output_torque_n_m", Mean, Same, 1.5e-2,
    "In the mean both carry the load; their own samples alias the ripple.";
    "rapier*collider*", Any, STEADY, "*_force_n", Mean, Same, 1e-1,
    "Under a linear spring the load spreads over the sleeves otherwise.";
};

impl ModelTolerance {
    /// Whether it is about this engine in this place.
    pub(crate) fn applies(
        &self,
        engine: &str,
        friction: bool,
        window: WindowKind,
        quantity: &str,
    ) -> bool {
        let suits = match self.friction {
            Friction::Any => true,
            Friction::With => friction,
            Friction::Without => !friction,
        };
        suits
            && self.window.is_none_or(|w| w == window)
            && fits(self.engine, engine)
            && fits(self.quantity, quantity)
    }
}

/// The account of the part of the run that a window is, or that overlaps it most; `None` without an account.
pub(crate) fn account<'a>(participant: &'a Participant, window: &Window) -> Option<&'a Energy> {
    let overlap = |e: &Energy| {
        let both = e.to_s.min(window.to_s) - e.from_s.max(window.from_s);
        both / (e.to_s.max(window.to_s) - e.from_s.min(window.from_s))
    };
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
pub(crate) fn predicted(a: &Participant, b: &Participant, window: &Window) -> Option<f64> {
    let share = |p: &Participant| account(p, window)?.remainder_share;
    match (share(a), share(b)) {
        (None, None) => None,
        (of_a, of_b) => Some(of_b.unwrap_or(0.0) - of_a.unwrap_or(0.0)),
    }
}
