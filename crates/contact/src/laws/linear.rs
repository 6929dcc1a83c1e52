//! Linear springs, one stiffness for each stage: `F_n = max(0, k delta + S(delta) C v_n)`.
//!
//! It represents contact in rigid-body engines. Curvature does not enter: k replaces K.

use super::{LawInfo, LawParameters, NormalLaw, Ramp, Shape};
use crate::{HertzStiffness, Real};

/// Linear springs with the paper's damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearSprings {
    damping: f64,
    ramp: Ramp,
}

impl NormalLaw for LinearSprings {
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        let c = |x: f64| rate.like(x);
        let damping = self.ramp.at(penetration) * c(self.damping);
        damping.mul_add(rate, stiffness * penetration).max(c(0.0))
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        stiffness.like(0.5) * stiffness * penetration * penetration
    }

    #[inline]
    fn exponent(&self) -> f64 {
        1.0
    }
}

pub(super) fn new(parameters: &LawParameters) -> LinearSprings {
    LinearSprings {
        damping: parameters.damping,
        ramp: Ramp::new(parameters.ramp),
    }
}

fn stages(hertz: HertzStiffness, parameters: &LawParameters) -> HertzStiffness {
    hertz.of_stages(parameters.springs)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "linear",
    summary: "linear springs, one stiffness for external and one for internal contacts",
    formula: "max(0, k delta + S(delta) C v)",
    source: "Hooke's law, as rigid-body engines have it in place of a contact law",
    domain: "loads are shared as if all contacts of a stage were equal; without play no force depends on k",
    slow_impact: "regular: does not depend on the impact speed",
    keys: &[
        "contact.external_spring_n_m",
        "contact.internal_spring_n_m",
        "contact.damping_n_s_m",
        "contact.ramp_m",
    ],
    restitution_factor: None,
    conservative: true,
    shape: Shape::Fitted,
    materials: "that of the given stiffness",
    stiffness: Some(stages),
};
