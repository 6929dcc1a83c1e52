//! rapier2d (double precision) as a peer, three ways.
//!
//! - `rapier-shared-law`: its bodies, joints and time integration under our contact forces;
//! - `rapier-own-contact-hook`: our normal force, its implicit Coulomb friction;
//! - `rapier-own-contact-colliders`: its own collision detection and contact spring.

mod colliders;
mod contact_hook;
mod march;
mod outlines;
mod reactions;
mod shared_law;
mod spring;
mod sums;
mod world;

pub(crate) use colliders::Colliders;
pub(crate) use contact_hook::ContactHook;
pub(crate) use shared_law::SharedLaw;

/// Name and version of the library behind all three.
fn version() -> String {
    format!("rapier2d-f64 {}", rapier2d_f64::VERSION)
}
