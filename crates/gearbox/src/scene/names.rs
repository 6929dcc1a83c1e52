//! The names a scene may use for its law and its integrator, from where they are registered.

use pinwheel_mbs::integrators::METHODS;

/// Normal contact laws.
#[must_use]
pub fn laws() -> Vec<&'static str> {
    vec!["paper"]
}

/// Integrators.
#[must_use]
pub fn integrators() -> Vec<&'static str> {
    METHODS.iter().map(|method| method.name).collect()
}
