//! The paper's law (Eq. 20): `F_n = max(0, S(delta) (K delta^1.5 + C v_n))`, K from the local curvature.
//!
//! The maximum is an addition: as printed, the law pulls when the bodies part quickly. K varies along the profile while the
//! force is normal only. The law therefore has no potential and creates about 1 % energy on the paper's gear.

use super::{LawInfo, LawParameters, NormalLaw, Ramp, Shape};
use crate::Real;

/// The paper's law, Eq. 20.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperLaw {
    /// Damping C, N s/m.
    pub damping: f64,
    /// Ramp S.
    pub ramp: Ramp,
}

impl NormalLaw for PaperLaw {
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        let c = |x: f64| rate.like(x);
        let elastic = stiffness * (penetration * penetration.sqrt());
        (self.ramp.at(penetration) * rate.mul_add(c(self.damping), elastic)).max(c(0.0))
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        stiffness * self.ramp.integral(penetration)
    }
}

pub(super) fn new(parameters: &LawParameters) -> PaperLaw {
    PaperLaw {
        damping: parameters.damping,
        ramp: Ramp::new(parameters.ramp),
    }
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "paper",
    summary: "the paper's law: Hertzian stiffness of the local curvature, viscous damping, both ramped in",
    formula: "max(0, S(delta) (K delta^1.5 + C v))",
    source: "the paper, Eq. 20 and 22 to 24; the maximum with 0 is Pinwheel's",
    domain: "penetrations far below the radii; creates energy where K varies along the profile (0.95 % on the paper's gear)",
    slow_impact: "regular: does not depend on the impact speed",
    keys: &["contact.damping_n_s_m", "contact.ramp_m"],
    restitution_factor: None,
    conservative: false,
    shape: Shape::Sphere,
    materials: "any elastic one, by modulus and Poisson's ratio",
    stiffness: None,
};
