//! The names a scene may use for its law and its integrator.
//!
//! One function each, so that the lists can come from wherever laws and integrators are registered.

/// Normal contact laws.
#[must_use]
pub fn laws() -> &'static [&'static str] {
    &["paper"]
}

/// Integrators.
#[must_use]
pub fn integrators() -> &'static [&'static str] {
    &["rk2", "rk2-midpoint", "rk4"]
}
