//! The paper's law made energy-consistent.
//!
//! ```text
//! U(a, delta) = K(a) I(delta),   I = integral of S(x) x^1.5 from 0 to delta
//! normal:      max(0, dU/d(delta) + S C v)                                 as in the paper
//! along:       -dU/da / (|C'| (1 - delta kappa_C))   on the pin, along the profile
//! ```
//! U depends only on the position of the pin's centre in the disc's frame. Its full gradient therefore acts at that centre,
//! with its reaction on the disc at the same point; the paper omits the part along the profile. The law needs dK/da, so it is
//! available for exact detection only.

use super::{LawInfo, LawParameters, NormalLaw, PaperLaw, paper};
use crate::Real;

/// Law of Eq. 20 with the missing part of the gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperConservative(PaperLaw);

impl NormalLaw for PaperConservative {
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        self.0.force(stiffness, penetration, rate)
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        self.0.stored(stiffness, penetration)
    }

    #[inline(always)]
    fn along<R: Real>(&self, _stiffness: R, penetration: R) -> Option<R> {
        Some(self.0.ramp.integral(penetration))
    }
}

pub(super) fn new(parameters: &LawParameters) -> PaperConservative {
    PaperConservative(paper::new(parameters))
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "paper-conservative",
    summary: "the paper's law with the force along the profile that makes it the gradient of an energy",
    formula: "normal: max(0, S(delta) (K delta^1.5 + C v)); along the profile: -dK/ds * integral of S x^1.5",
    source: "derived here from the potential U = K(a) * integral of S(x) x^1.5",
    domain: "as `paper`; exact detection only, because discrete points have no slope of K",
    conservative: true,
    ..paper::INFO
};
