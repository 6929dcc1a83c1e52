//! Normal laws for several contacts at once.

use pulp::Simd;

use crate::lanes::Lanes;
use crate::laws::{
    AdamsImpact, ConstantStiffness, Hysteresis, LineContact, NormalLaw, PaperLaw, PaperPrinted,
};

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

    /// Energies stored, J; lanes without contact may hold anything.
    #[must_use]
    #[inline(always)]
    fn stored_lanes<S: Simd>(&self, stiffness: Lanes<S>, penetration: Lanes<S>) -> Lanes<S> {
        let mut stored = stiffness;
        let each = stored.as_mut_slice().iter_mut();
        for (stored, &penetration) in each.zip(penetration.as_slice()) {
            *stored = self.stored(*stored, penetration);
        }
        stored
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

    #[inline(always)]
    fn stored_lanes<S: Simd>(&self, stiffness: Lanes<S>, penetration: Lanes<S>) -> Lanes<S> {
        let c = |x: f64| penetration.like(x);
        // The integral of S x^1.5: x^3.5 up to the width of S, x^2.5 from there on.
        let inside = penetration.min(c(self.ramp));
        let power = |x: Lanes<S>| x * x * x.sqrt();
        let risen = power(inside);
        let ramped = risen * inside * c(1.0 / (3.5 * self.ramp));
        let beyond = (power(penetration) - risen) * c(1.0 / 2.5);
        stiffness * (ramped + beyond)
    }
}

macro_rules! lane_laws {
    ($($law:ident),*) => {
        /// Any of the laws for lanes, told apart once a group of lanes.
        ///
        /// A contact loop by law would be compiled for every law and every instruction set; this one only for
        /// the latter, and the branch is always taken the same way.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[expect(missing_docs, reason = "the laws speak for themselves")]
        pub enum LaneLaw {
            $($law($law)),*
        }

        $(impl From<$law> for LaneLaw {
            fn from(law: $law) -> Self {
                Self::$law(law)
            }
        })*

        impl NormalLaw for LaneLaw {
            #[inline]
            fn force(&self, stiffness: f64, penetration: f64, rate: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.force(stiffness, penetration, rate)),*
                }
            }

            #[inline]
            fn stored(&self, stiffness: f64, penetration: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.stored(stiffness, penetration)),*
                }
            }

            #[inline]
            fn stiffness(&self, hertz: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.stiffness(hertz)),*
                }
            }
        }

        impl LanesLaw for LaneLaw {
            #[inline(always)]
            fn force_lanes<S: Simd>(
                &self,
                stiffness: Lanes<S>,
                penetration: Lanes<S>,
                rate: Lanes<S>,
            ) -> Lanes<S> {
                match self {
                    $(Self::$law(law) => law.force_lanes(stiffness, penetration, rate)),*
                }
            }

            #[inline(always)]
            fn stored_lanes<S: Simd>(
                &self,
                stiffness: Lanes<S>,
                penetration: Lanes<S>,
            ) -> Lanes<S> {
                match self {
                    $(Self::$law(law) => law.stored_lanes(stiffness, penetration)),*
                }
            }
        }
    };
}
lane_laws!(
    AdamsImpact,
    ConstantStiffness,
    Hysteresis,
    LineContact,
    PaperLaw,
    PaperPrinted
);
