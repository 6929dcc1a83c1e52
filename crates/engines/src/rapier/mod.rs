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

/// One of the three.
pub(crate) struct Rapier {
    info: &'static EngineInfo<'static>,
    prepare: fn(&Gearbox) -> Result<Prepared<'static>, Halt>,
}

pub(crate) static SHARED_LAW: Rapier = Rapier {
    info: &registry::RAPIER_SHARED_LAW,
    prepare: shared_law::prepare,
};

pub(crate) static HOOK: Rapier = Rapier {
    info: &registry::RAPIER_HOOK,
    prepare: contact_hook::prepare,
};

pub(crate) static COLLIDERS: Rapier = Rapier {
    info: &registry::RAPIER_COLLIDERS,
    prepare: colliders::prepare,
};

impl Engine for Rapier {
    fn info(&self) -> EngineInfo<'_> {
        *self.info
    }

    fn version(&self) -> String {
        format!("rapier2d-f64 {}", rapier2d_f64::VERSION)
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        (self.prepare)(gearbox)
    }
}
