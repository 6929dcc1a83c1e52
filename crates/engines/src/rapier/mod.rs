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

use pinwheel_gearbox::Gearbox;

use crate::engine::{Engine, Halt, Prepared};
use crate::registry::{self, EngineInfo};

/// One of the three: what is known of it, and how it is made ready.
pub(crate) struct Rapier(
    &'static EngineInfo<'static>,
    fn(&Gearbox) -> Result<Prepared<'static>, Halt>,
);

pub(crate) const SHARED_LAW: Rapier = Rapier(&registry::RAPIER_SHARED_LAW, shared_law::prepare);
pub(crate) const HOOK: Rapier = Rapier(&registry::RAPIER_HOOK, contact_hook::prepare);
pub(crate) const COLLIDERS: Rapier = Rapier(&registry::RAPIER_COLLIDERS, colliders::prepare);

impl Engine for Rapier {
    fn info(&self) -> EngineInfo<'_> {
        *self.0
    }

    fn version(&self) -> String {
        format!("rapier2d-f64 {}", rapier2d_f64::VERSION)
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        self.1(gearbox)
    }
}

/// The linear springs of external and internal contacts that the colliders have, N/m.
///
/// # Errors
/// In words, if the law cannot carry the load.
pub(crate) fn stage_stiffness(gearbox: &Gearbox) -> Result<[f64; 2], String> {
    let mut field = gearbox.contact_field().map_err(|error| error.to_string())?;
    spring::contact_spring(gearbox, &mut *field).map(|spring| spring.stiffness_n_m)
}
