//! Contacts between wheels and sleeves: detection, law and friction put together for a scene.

mod detection;
mod field;
mod pairs;

use pinwheel_contact::{NormalLaw, PaperLaw};

pub use field::{ContactField, PairContact};

use crate::GearboxError;
use crate::geometry::Geometry;
use crate::scene::{Detection, Scene};
use detection::{Exact, Points};
use pairs::Pairs;

/// The contact field of a scene. Laws are told apart here, once, and not per contact.
pub(crate) fn field(
    scene: &Scene,
    geometry: &Geometry,
) -> Result<Box<dyn ContactField>, GearboxError> {
    let contact = &scene.contact;
    match contact.law.as_str() {
        "paper" => with_law(
            scene,
            geometry,
            PaperLaw {
                damping: contact.damping_n_s_m,
                ramp: contact.ramp_m,
            },
        ),
        other => Err(GearboxError::UnknownLaw(other.to_owned())),
    }
}

fn with_law<L: NormalLaw>(
    scene: &Scene,
    geometry: &Geometry,
    law: L,
) -> Result<Box<dyn ContactField>, GearboxError> {
    Ok(match scene.contact.detection {
        Detection::Exact => Box::new(Pairs::new(
            scene,
            geometry,
            law,
            Exact::new(scene, geometry),
        )),
        Detection::Points => Box::new(Pairs::new(
            scene,
            geometry,
            law,
            Points::new(scene, geometry)?,
        )),
    })
}
