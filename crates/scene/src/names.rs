//! Names of registered laws, integrators and materials for scenes.

use pinwheel_contact::laws::LAWS;
use pinwheel_mbs::integrators::METHODS;

use crate::materials::MATERIALS;

/// Name of the automatic choice of the integrator.
pub const AUTO: &str = "auto";

/// Returns the names of normal contact laws.
pub fn laws() -> Vec<&'static str> {
    LAWS.iter().map(|law| law.name).collect()
}

/// Returns the names of integrators.
pub fn integrators() -> Vec<&'static str> {
    let methods = METHODS.iter().map(|method| method.name);
    std::iter::once(AUTO).chain(methods).collect()
}

/// Returns the names of materials.
pub fn materials() -> Vec<&'static str> {
    MATERIALS.iter().map(|material| material.name).collect()
}
