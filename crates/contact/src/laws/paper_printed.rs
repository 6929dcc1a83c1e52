//! The paper's law exactly as printed (Eq. 20): `F_n = S(delta) (K delta^1.5 + C v_n)`.
//!
//! Without the clamp at 0 a contact that parts faster than `K delta^1.5 / C` pulls. For studying what the
//! published model does; use the law `paper` for results.

use super::{LawInfo, LawParameters, NormalLaw, Ramp};
use crate::Real;

/// Eq. 20 without a maximum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperPrinted {
    /// C, N s/m.
    pub damping: f64,
    /// S.
    pub ramp: Ramp,
}

impl NormalLaw for PaperPrinted {
    /// May be negative, unlike every other law's.
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        let elastic = stiffness * penetration * penetration.sqrt();
        self.ramp.at(penetration) * (elastic + rate.like(self.damping) * rate)
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        stiffness * self.ramp.integral(penetration)
    }

    #[inline(always)]
    fn along<R: Real>(&self, _penetration: R) -> Option<R> {
        None
    }
}

pub(super) fn new(parameters: &LawParameters) -> PaperPrinted {
    PaperPrinted {
        damping: parameters.damping,
        ramp: Ramp::new(parameters.ramp),
    }
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "paper-printed",
    summary: "the paper's law without our clamp: contacts that part quickly pull",
    formula: "S(delta) (K delta^1.5 + C v)",
    source: "the paper, Eq. 20 as printed",
    domain: "studies of the published model only: the force is adhesive for v < -K delta^1.5/C",
    slow_impact: "regular: does not depend on the impact speed",
    keys: &["contact.damping_n_s_m", "contact.ramp_m"],
    restitution_factor: None,
    conservative: false,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulls_where_the_paper_s_law_is_clamped() {
        let law = PaperPrinted {
            damping: 8.0,
            ramp: Ramp::new(1e-5),
        };
        assert_eq!(law.force(1e8, 4e-4, 0.0), 1e8 * 4e-4 * 0.02);
        assert!(law.force(1e8, 1e-5, -10.0) < -70.0);
    }
}
