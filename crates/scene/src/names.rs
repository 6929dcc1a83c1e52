//! The names a scene may use for its law and its integrator, from where they are registered.

use pinwheel_contact::laws::LAWS;
use pinwheel_mbs::integrators::METHODS;

/// The integrator that stands for the choice by the solver itself.
pub const AUTO: &str = "auto";

/// Normal contact laws.
#[must_use]
pub fn laws() -> Vec<&'static str> {
    LAWS.iter().map(|law| law.name).collect()
}

/// Integrators.
#[must_use]
pub fn integrators() -> Vec<&'static str> {
    let methods = METHODS.iter().map(|method| method.name);
    std::iter::once(AUTO).chain(methods).collect()
}

/// Values of `drive.start`.
#[must_use]
pub fn starts() -> Vec<&'static str> {
    vec!["kinematic", "equilibrium"]
}

/// Values of `contact.friction_law`.
#[must_use]
pub fn friction_laws() -> Vec<&'static str> {
    vec!["regularised", "adams"]
}

/// Values of `contact.detection`.
#[must_use]
pub fn detections() -> Vec<&'static str> {
    vec!["exact", "points"]
}

/// Values of `solver.formulation`.
#[must_use]
pub fn formulations() -> Vec<&'static str> {
    vec!["reduced", "lagrange"]
}

/// Values of `solver.stabilisation`.
#[must_use]
pub fn stabilisations() -> Vec<&'static str> {
    vec!["projection", "baumgarte", "none"]
}
