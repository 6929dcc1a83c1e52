//! The paper's law exactly as printed (Eq. 20): `F_n = S(delta) (K delta^1.5 + C v_n)`.
//!
//! Without the clamp at 0 a contact that parts faster than `K delta^1.5 / C` pulls. The law serves to study the published
//! model; use the law `paper` for results.

use super::{LawInfo, LawParameters, NormalLaw, PaperLaw, paper};
use crate::Real;

/// Law of Eq. 20 without the maximum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperPrinted(PaperLaw);

impl NormalLaw for PaperPrinted {
    /// Returns the normal force, N, which may be negative, unlike that of every other law.
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        let PaperLaw { damping, ramp } = self.0;
        let elastic = stiffness * penetration * penetration.sqrt();
        ramp.at(penetration) * (elastic + rate.like(damping) * rate)
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        self.0.stored(stiffness, penetration)
    }
}

pub(super) fn new(parameters: &LawParameters) -> PaperPrinted {
    PaperPrinted(paper::new(parameters))
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "paper-printed",
    summary: "the paper's law without the clamp at 0: contacts that separate quickly pull",
    formula: "S(delta) (K delta^1.5 + C v)",
    source: "the paper, Eq. 20 as printed",
    domain: "studies of the published model only: the force is adhesive for v < -K delta^1.5/C",
    ..paper::INFO
};
