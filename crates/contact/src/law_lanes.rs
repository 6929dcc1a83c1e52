//! Normal laws for several contacts at once.

use pulp::Simd;

use crate::lanes::Lanes;
use crate::laws::{NormalLaw, PaperLaw};

/// A [`NormalLaw`] that the contact loop in lanes can use.
///
/// The default calls the scalar law lane by lane: right for any law, and enough for most.
pub trait LanesLaw: NormalLaw {
    /// Forces, N; lanes without contact (penetration <= 0) may hold anything.
    #[must_use]
    #[inline(always)]
    fn force_lanes<S: Simd>(
        &self,
        stiffness: Lanes<S>,
        penetration: Lanes<S>,
        rate: Lanes<S>,
    ) -> Lanes<S> {
        let mut force = stiffness;
        for ((force, &penetration), &rate) in force
            .as_mut_slice()
            .iter_mut()
            .zip(penetration.as_slice())
            .zip(rate.as_slice())
        {
            *force = self.force(*force, penetration, rate);
        }
        force
    }
}

impl LanesLaw for PaperLaw {
    #[inline(always)]
    fn force_lanes<S: Simd>(
        &self,
        stiffness: Lanes<S>,
        penetration: Lanes<S>,
        rate: Lanes<S>,
    ) -> Lanes<S> {
        let c = |x: f64| rate.like(x);
        let elastic = stiffness * penetration * penetration.sqrt();
        let ramp = (penetration * c(1.0 / self.ramp)).max(c(0.0)).min(c(1.0));
        (ramp * rate.mul_add(c(self.damping), elastic)).max(c(0.0))
    }
}
