//! Adams' IMPACT law: `F_n = max(0, k delta^1.5 + STEP(delta, 0, 0, d_max, c_max) v)`.
//!
//! Adams states it with the gap q and its rate: `max(0, k (q1 - q)^e - STEP(q, q1 - d, c_max, q1, 0) dq/dt)`. The exponent e is
//! 1.5 here; the damping reaches c_max at the depth d.

use super::{LawInfo, LawParameters, NormalLaw, Shape, step};
use crate::Real;

/// IMPACT with exponent 1.5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamsImpact {
    /// Stiffness k, N/m^1.5.
    pub stiffness: f64,
    /// Largest damping c_max, N s/m.
    pub damping: f64,
    /// Depth d at which the damping reaches c_max, m.
    pub depth: f64,
}

impl NormalLaw for AdamsImpact {
    #[inline(always)]
    fn force<R: Real>(&self, _hertz: R, penetration: R, rate: R) -> R {
        let elastic = rate.like(self.stiffness) * penetration * penetration.sqrt();
        let damping = step(penetration, 0.0, 0.0, self.depth, self.damping);
        (elastic + damping * rate).max(rate.like(0.0))
    }

    #[inline(always)]
    fn stored<R: Real>(&self, _hertz: R, penetration: R) -> R {
        let power = penetration.like(self.stiffness) * penetration * penetration;
        power * penetration.sqrt() / power.like(2.5)
    }

    #[inline]
    fn stiffness(&self, _hertz: f64) -> f64 {
        self.stiffness
    }
}

pub(super) fn new(parameters: &LawParameters) -> AdamsImpact {
    AdamsImpact {
        stiffness: parameters.constant_stiffness,
        damping: parameters.damping,
        depth: parameters.ramp,
    }
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "adams-impact",
    summary: "the IMPACT function of MSC Adams: constant stiffness, damping stepped in with depth",
    formula: "max(0, k delta^1.5 + STEP(delta, 0, 0, d_max, c_max) v)",
    source: "MSC Adams documentation, function IMPACT and STEP; the paper's Adams model uses it",
    domain: "penetrations far below the radii; loads are shared as if all curvatures were equal",
    slow_impact: "regular: does not depend on the impact speed, and the damping starts without a kink",
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
