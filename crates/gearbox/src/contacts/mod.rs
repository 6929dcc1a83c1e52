//! Contacts between wheels and sleeves: detection, law and friction put together for a scene.

mod detection;
mod field;
mod lanes;
mod pairs;

use pinwheel_contact::laws::hysteresis_factor;
use pinwheel_contact::{
    AdamsImpact, ConstantStiffness, Hysteresis, LaneLaw, LineContact, NormalLaw, PaperConservative,
    PaperLaw, PaperPrinted,
};

pub use field::{ContactEnergy, ContactField, PairContact};

use crate::GearboxError;
use crate::geometry::Geometry;
use crate::scene::{Detection, FrictionLaw, Scene};
use detection::{Exact, Points};
use lanes::LaneField;
use pairs::Pairs;

/// Which contact loop evaluates exact detection. All give the same forces to 1e-13 relative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// Eight pairs at a time with the vector instructions that the processor has.
    #[default]
    Lanes,
    /// The same with AVX2 at most, as on a processor without AVX-512.
    Avx2,
    /// The same without any vector instructions of the processor.
    Portable,
    /// One pair after the other: the readable form, kept as the oracle of the other.
    Scalar,
}

impl Kernel {
    /// All loops.
    pub const ALL: [Self; 4] = [Self::Lanes, Self::Avx2, Self::Portable, Self::Scalar];

    /// The vector instructions of its lanes: the processor's best, or fewer.
    fn arch(self) -> pulp::Arch {
        match self {
            Self::Lanes => pulp::Arch::new(),
            Self::Avx2 => at_most_avx2(),
            Self::Portable | Self::Scalar => pulp::Arch::Scalar,
        }
    }

    /// Name of what its lanes run on here: `avx512`, `avx2`, `portable`, or `other`.
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

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn at_most_avx2() -> pulp::Arch {
    pulp::x86::V3::try_new().map_or(pulp::Arch::Scalar, pulp::Arch::V3)
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn at_most_avx2() -> pulp::Arch {
    pulp::Arch::Scalar
}

/// The contact field of a scene. Laws are told apart here, once, and not per contact.
pub(crate) fn field(
    scene: &Scene,
    geometry: &Geometry,
    kernel: Kernel,
) -> Result<Box<dyn ContactField>, GearboxError> {
    let contact = &scene.contact;
    let (damping, ramp) = (contact.damping_n_s_m, contact.ramp_m);
    let stiffness = contact.constant_stiffness_n_m15;
    match contact.law.as_str() {
        "paper" => with_law(scene, geometry, kernel, PaperLaw { damping, ramp }),
        "paper-printed" => with_law(scene, geometry, kernel, PaperPrinted { damping, ramp }),
        "paper-conservative" => {
            let law = PaperConservative { damping, ramp };
            let exact = Exact::with_slope(scene, geometry);
            Ok(Box::new(Pairs::new(scene, geometry, law, exact)))
        }
        "constant" => with_law(
            scene,
            geometry,
            kernel,
            ConstantStiffness {
                stiffness,
                damping,
                ramp,
            },
        ),
        "adams-impact" => with_law(
            scene,
            geometry,
            kernel,
            AdamsImpact {
                stiffness,
                damping,
                depth: ramp,
            },
        ),
        "line-contact" => with_law(
            scene,
            geometry,
            kernel,
            LineContact::new(
                contact.line_length_m,
                contact.stiffness_multiplier,
                damping,
                ramp,
            ),
        ),
        name => match hysteresis_factor(name, contact.restitution) {
            Some(factor) => with_law(
                scene,
                geometry,
                kernel,
                Hysteresis::new(factor, contact.impact_speed_m_s),
            ),
            None => Err(GearboxError::UnknownLaw(name.to_owned())),
        },
    }
}

fn with_law<L: NormalLaw + Into<LaneLaw>>(
    scene: &Scene,
    geometry: &Geometry,
    kernel: Kernel,
    law: L,
) -> Result<Box<dyn ContactField>, GearboxError> {
    Ok(match scene.contact.detection {
        Detection::Exact
            if kernel != Kernel::Scalar
                && scene.contact.friction_law == FrictionLaw::Regularised =>
        {
            let arch = kernel.arch();
            Box::new(LaneField::new(scene, geometry, law.into(), arch))
        }
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
