//! rapier2d (double precision) as a peer, in three engines.
//!
//! - `rapier-shared-law`: its bodies, joints and time integration under Pinwheel's contact forces;
//! - `rapier-own-contact-hook`: Pinwheel's normal force, its implicit Coulomb friction;
//! - `rapier-own-contact-colliders`: its own collision detection and contact spring.

pub mod colliders;
pub mod contact_hook;
pub mod march;
pub mod outlines;
pub mod reactions;
mod shared_law;
pub mod sums;
pub mod world;

use pinwheel_gearbox::Gearbox;

use crate::engine::{Engine, Halt, Prepared};
use crate::info::EngineInfo;
use crate::known::rapier as facts;

/// Engine based on rapier: its facts, and the function that prepares it.
struct Rapier(
    &'static EngineInfo<'static>,
    fn(&Gearbox) -> Result<Prepared<'static>, Halt>,
);

/// Returns rapier as an engine; `None` if the facts belong to another engine.
pub(crate) fn engine(info: &EngineInfo<'_>) -> Option<Box<dyn Engine>> {
    let all = [
        Rapier(&facts::SHARED_LAW, shared_law::prepare),
        Rapier(&facts::HOOK, contact_hook::prepare),
        Rapier(&facts::COLLIDERS, colliders::prepare),
    ];
    let rapier = all.into_iter().find(|rapier| rapier.0 == info)?;
    Some(Box::new(rapier))
}

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
