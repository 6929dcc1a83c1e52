//! Contacts between discs and pins: detection, law and friction combined for a scene.

pub(crate) mod bearing_load;
pub(crate) mod cranks;
pub(crate) mod detection;
pub(crate) mod eccentric_bearings;
mod field;
pub(crate) mod flanks;
mod lanes;
mod motion;
pub(crate) mod pair;
mod pairs;
mod pin_friction;
mod seals;
mod shared_pins;

use pinwheel_contact::NormalLaw as _;
use pinwheel_scene::scales::{law_parameters, pin_law};

pub use bearing_load::BearingLoad;
pub use cranks::CrankSet;
pub use eccentric_bearings::EccentricBearings;
pub use field::ContactField;
use field::HeldPins;
pub use pair::{PairContact, PairField};
pub use pinwheel_mbs::ContactEnergy;

use crate::GearboxError;
use crate::carrier::Carrier;
use crate::geometry::Geometry;
use crate::scene::{Detection, FrictionLaw, Scene};
use detection::{Exact, Points};
use lanes::LaneField;
use pairs::Pairs;
use pin_friction::PinFriction;
pub(crate) use seals::Seals;

/// Contact loop for exact detection. All loops give equal forces to 1e-13 relative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// Eight pairs at a time with the processor's vector instructions.
    #[default]
    Lanes,
    /// Pairs in lanes with AVX2 at most, as on a processor without AVX-512.
    Avx2,
    /// Pairs in lanes without vector instructions.
    Portable,
    /// One pair after the other: the readable form, the reference for the lanes.
    Scalar,
}

impl Kernel {
    /// All contact loops.
    pub const ALL: [Self; 4] = [Self::Lanes, Self::Avx2, Self::Portable, Self::Scalar];

    /// Returns the vector instructions of the loop: the processor's best, or fewer.
    fn arch(self) -> pulp::Arch {
        match self {
            Self::Lanes => pulp::Arch::new(),
            Self::Avx2 => at_most_avx2(),
            Self::Portable | Self::Scalar => pulp::Arch::Scalar,
        }
    }

    /// Returns the name of the vector instructions in use on this processor: `avx512`, `avx2`, `portable`, or `other`.
    #[must_use]
    pub fn vectors(self) -> &'static str {
        match self.arch() {
            pulp::Arch::Scalar => "portable",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            pulp::Arch::V3(_) => "avx2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            pulp::Arch::V4(_) => "avx512",
            #[allow(unreachable_patterns, reason = "other processors have other variants")]
            _ => "other",
        }
    }
}

fn at_most_avx2() -> pulp::Arch {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(v3) = pulp::x86::V3::try_new() {
        return pulp::Arch::V3(v3);
    }
    pulp::Arch::Scalar
}

/// Returns the contacts only, without bearings and seals.
#[doc(hidden)]
pub fn contacts(
    scene: &Scene,
    geometry: &Geometry,
    kernel: Kernel,
) -> Result<ContactField, GearboxError> {
    let law = pin_law(scene).ok_or_else(|| GearboxError::UnknownLaw(scene.contact.law.clone()))?;
    // Cranks replace the pins in holes.
    let without;
    let (scene, geometry) = match scene.cranks {
        Some(_) => {
            let gear = scene.gear.without_internal_sleeves();
            // Parameters of the law that depend on holes are kept.
            let known = law_parameters(scene);
            let mut scene = Scene {
                gear,
                ..scene.clone()
            };
            let contact = &mut scene.contact;
            contact.disc_depth_m = Some(known.disc_depth).filter(|depth| *depth > 0.0);
            contact.external_spring_n_m = Some(known.springs[0]);
            contact.internal_spring_n_m = Some(known.springs[1]);
            without = (scene, geometry.without_internal_sleeves());
            (&without.0, &without.1)
        }
        None => (scene, geometry),
    };
    // Lanes assume that all pins are equal, and all holes, and take discs one by one.
    let in_lanes = kernel != Kernel::Scalar
        && scene.structure.output_pin_diameter_m.is_none()
        && scene.contact.friction_law == FrictionLaw::Regularised
        && geometry.is_uniform(&scene.gear);
    let pins = PinFriction::of(scene);
    let contacts: Box<dyn PairField> = match scene.contact.detection {
        Detection::Exact if in_lanes => {
            Box::new(LaneField::new(scene, geometry, law, kernel.arch()))
        }
        Detection::Exact => {
            let exact = Exact::new(scene, geometry, &law.law);
            Box::new(Pairs::new(scene, geometry, law, exact))
        }
        // A force along the profile needs the slope of K, which points do not have.
        Detection::Points if law.law.along(1.0, 1.0).is_some() => {
            return Err(GearboxError::Geometry(format!(
                "contact.detection = \"points\" has no slope of the stiffness, which the law `{}` needs; \
                 use contact.detection = \"exact\"",
                law.law.info().name
            )));
        }
        Detection::Points => {
            let points = Points::new(scene, geometry)?;
            Box::new(Pairs::new(scene, geometry, law, points))
        }
    };
    Ok(ContactField {
        contacts,
        law,
        pins,
        held: HeldPins::of(scene),
        carrier: Carrier::Rigid,
        seals: None,
        ring: None,
    })
}
