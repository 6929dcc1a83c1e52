//! Interface of a normal law to the contact loops.

use crate::Real;

/// A penalty law F_n(K, delta, d(delta)/dt) for delta > 0, of one contact or of several side by side; lanes without contact
/// (delta <= 0) may hold anything.
///
/// Laws are small copyable values. They know no history: what depends on the speed of an impact takes a reference
/// speed from its settings.
pub trait NormalLaw: Copy {
    /// Normal force, N, never negative. `stiffness` K in N/m^1.5, `penetration` in m (> 0), `rate` in m/s.
    #[must_use]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R;

    /// Stored energy of a pair, J: the integral of the force at rate 0 over the penetration.
    #[must_use]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R;

    /// Force against an increase of K along the profile, per unit of its slope: dU/dK, J/(N/m^1.5), of laws whose
    /// force is the whole gradient of U(K, delta). `None`, always or never: the force is normal only.
    #[must_use]
    #[inline(always)]
    fn along<R: Real>(&self, _stiffness: R, _penetration: R) -> Option<R> {
        None
    }

    /// The stiffness the law works with where Hertz's is `hertz`; its own unit where the exponent is not 1.5.
    #[inline]
    fn stiffness(&self, hertz: f64) -> f64 {
        hertz
    }

    /// n of laws whose force at rest, above a ramp, is stiffness times delta^n.
    #[inline]
    fn exponent(&self) -> f64 {
        1.5
    }

    /// Force at rest, N, above a ramp, where Hertz's stiffness is `hertz`.
    #[must_use]
    fn elastic(&self, hertz: f64, depth: f64) -> f64 {
        self.stiffness(hertz) * depth.powf(self.exponent())
    }

    /// The depth, m, of that force, N.
    #[must_use]
    fn depth(&self, hertz: f64, force: f64) -> f64 {
        (force / self.stiffness(hertz)).powf(self.exponent().recip())
    }

    /// Its slope, N/m.
    #[must_use]
    fn tangent(&self, hertz: f64, depth: f64) -> f64 {
        self.exponent() * self.stiffness(hertz) * depth.powf(self.exponent() - 1.0)
    }

    /// The force at this rate and at rest, N, and the energy stored, J, whose roots are the same.
    #[must_use]
    #[inline(always)]
    fn observed<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
        [
            self.force(stiffness, penetration, rate),
            self.force(stiffness, penetration, rate.like(0.0)),
            self.stored(stiffness, penetration),
        ]
    }
}
