//! One stiffness for every contact: `F_n = max(0, S(delta) (K delta^1.5 + C v_n))` with K given.
//!
//! Common law of engineering software, and the simplest one with a potential.

use super::{LawInfo, LawParameters, NormalLaw, PaperLaw, Shape, paper};
use crate::Real;

/// Law of Eq. 20 with constant K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantStiffness {
    /// Stiffness K, N/m^1.5.
    pub stiffness: f64,
    /// Damping and ramp of the law.
    pub paper: PaperLaw,
}

impl NormalLaw for ConstantStiffness {
    #[inline(always)]
    fn force<R: Real>(&self, _hertz: R, penetration: R, rate: R) -> R {
        let stiffness = rate.like(self.stiffness);
        self.paper.force(stiffness, penetration, rate)
    }

    #[inline(always)]
    fn stored<R: Real>(&self, _hertz: R, penetration: R) -> R {
        let stiffness = penetration.like(self.stiffness);
        self.paper.stored(stiffness, penetration)
    }

    #[inline]
    fn stiffness(&self, _hertz: f64) -> f64 {
        self.stiffness
    }
}

pub(super) fn new(parameters: &LawParameters) -> ConstantStiffness {
    ConstantStiffness {
        stiffness: parameters.constant_stiffness,
        paper: paper::new(parameters),
    }
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "constant",
    summary: "the paper's law with one stiffness for all contacts",
    formula: "max(0, S(delta) (K delta^1.5 + C v)), K constant",
    source: "the paper, Eq. 20, with K as in engineering software, given by the user",
    domain: "penetrations far below the radii; loads are shared as if all curvatures were equal",
    slow_impact: "regular: does not depend on the impact speed",
    keys: &[
        "contact.constant_stiffness_n_m15",
        "contact.damping_n_s_m",
        "contact.ramp_m",
    ],
    restitution_factor: None,
    conservative: true,
    shape: Shape::Fitted,
    materials: "that of the given stiffness",
    stiffness: None,
};
