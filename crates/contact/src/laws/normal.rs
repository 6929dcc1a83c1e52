//! What a normal law is to the contact loops.

use pulp::Simd;

use crate::lanes::Lanes;

/// A penalty law F_n(K, delta, d(delta)/dt) for delta > 0.
///
/// Laws are small copyable values; the contact loop is compiled for each of them. They know no
/// history: what depends on the speed of an impact takes a reference speed from its settings.
pub trait NormalLaw: Copy + Send + Sync + 'static {
    /// Normal force, N, never negative. `stiffness` K in N/m^1.5, `penetration` in m (> 0), `rate` in m/s.
    fn force(&self, stiffness: f64, penetration: f64, rate: f64) -> f64;

    /// Stored energy of a pair, J: the integral of the force at rate 0 over the penetration.
    fn stored(&self, stiffness: f64, penetration: f64) -> f64;

    /// Force against an increase of K along the profile, per unit of its slope: dU/dK, J/(N/m^1.5), of laws whose
    /// force is the whole gradient of U(K, delta). `None`, always or never: the force is normal only.
    ///
    /// Every law has to say which: one that forgot would lose this force in silence.
    fn along(&self, penetration: f64) -> Option<f64>;

    /// The stiffness the law works with where Hertz's is `hertz`; its own unit where the exponent is not 1.5.
    #[inline]
    fn stiffness(&self, hertz: f64) -> f64 {
        hertz
    }

    /// Forces of several contacts, N; lanes without contact (penetration <= 0) may hold anything.
    ///
    /// Lane by lane unless a law knows better: right for any law, and enough for most.
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

    /// Energies stored by several contacts, J; lanes without contact may hold anything.
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

    /// Of several contacts the forces at these rates and at rest, N, and the energies stored, J, whose roots are the same.
    #[must_use]
    #[inline(always)]
    fn observed_lanes<S: Simd>(
        &self,
        stiffness: Lanes<S>,
        penetration: Lanes<S>,
        rate: Lanes<S>,
    ) -> [Lanes<S>; 3] {
        [
            self.force_lanes(stiffness, penetration, rate),
            self.force_lanes(stiffness, penetration, rate.like(0.0)),
            self.stored_lanes(stiffness, penetration),
        ]
    }

    /// [`along`](Self::along) of several contacts; lanes without contact may hold anything.
    #[must_use]
    #[inline(always)]
    fn along_lanes<S: Simd>(&self, penetration: Lanes<S>) -> Option<Lanes<S>> {
        let mut along = penetration;
        for along in along.as_mut_slice() {
            *along = self.along(*along)?;
        }
        Some(along)
    }
}
