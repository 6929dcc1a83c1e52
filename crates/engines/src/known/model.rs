//! Stated tolerances of engines whose contact model differs from the native one.
//!
//! A tolerance belongs to a model, not to a scene: a bed of 4000 springs resolves a contact patch to a known share. It applies
//! to any gear, and a scene that exceeds it is a finding.

use pinwheel_compare::limits::Friction;
use pinwheel_compare::model::{ModelTolerance, Prediction};
use pinwheel_compare::{Metric, WindowKind};

macro_rules! statements {
    ($($friction:ident, $window:expr, $quantity:literal, $metric:ident, $predicted:ident, $tolerance:literal, $reason:literal;)*) => {
        &[$(ModelTolerance {
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

/// Disc edges as beds of springs, holes by the native law.
pub(super) const BED: &[ModelTolerance] = statements! {
    Without, STEADY, "input_torque_n_m", Mean, LawEnergy, 5e-3,
    "A bed of springs conserves energy; what the law creates is predicted, its edges and damping are not.";
    Without, STEADY, "output_torque_n_m", RelativeL2, Same, 1e-2,
    "Ripple about the same mean.";
    Without, STEADY, "external_sleeve_force_n", RelativeL2, Same, 4.5e-2,
    "Beds conserve energy, the paper's law does not: the pins share the load differently.";
    Without, STEADY, "internal_sleeve_force_n", RelativeL2, Same, 1.5e-2,
    "The law itself but for the ramp S, under external forces that differ.";
};

/// Pinwheel's normal forces in rapier's solver.
pub(super) const HOOK: &[ModelTolerance] = statements! {
    Without, None, "*_sleeve_force_n|*_torque_n_m|output_angle_rad", RelativeL2, Same, 0.0,
    "Pinwheel's normal forces in rapier's solver: without friction no difference of the model is left.";
    With, STEADY, "*_sleeve_force_n|*_torque_n_m|output_angle_rad", RelativeL2, Same, 2e-3,
    "Coulomb friction against its regularised form.";
};

/// rapier's own contacts.
pub(super) const COLLIDERS: &[ModelTolerance] = statements! {
    With, STEADY, "input_torque_n_m", Mean, LawEnergy, 2.5e-2,
    "Linear spring, polyline discs; under Coulomb friction pins stick that creep under the regularised one.";
    Without, STEADY, "input_torque_n_m", Mean, LawEnergy, 1.5e-2,
    "Linear spring of a stiffness that depends on pairs of masses, polyline discs.";
    Any, STEADY, "output_torque_n_m", Mean, Same, 1.5e-2,
    "On average both carry the load; their own samples alias the ripple.";
    Any, STEADY, "*_force_n", Mean, Same, 1e-1,
    "Under a linear spring the pins share the load differently.";
};
