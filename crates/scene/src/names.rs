//! The names a scene may use for its law, its integrator and its materials, from where they are registered.

use pinwheel_contact::laws::LAWS;
use pinwheel_mbs::integrators::METHODS;

use crate::materials::MATERIALS;

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

/// Materials.
#[must_use]
pub fn materials() -> Vec<&'static str> {
    MATERIALS.iter().map(|material| material.name).collect()
}
