//! Interface of a normal law to the contact loops.

use crate::Real;

/// Penalty law F_n(K, delta, d(delta)/dt) for delta > 0, of one contact or of several in lanes. Lanes without contact (delta <=
/// 0) have undefined results.
///
/// Laws are small copyable values without history: a law that depends on the impact speed takes a reference speed from its
/// settings.
pub trait NormalLaw: Copy {
    /// Returns the normal force, N, never negative. `stiffness` K in N/m^1.5, `penetration` in m (> 0), `rate` in m/s.
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R;

    /// Returns the stored energy of a pair, J: the integral of the force at rate 0 over the penetration.
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R;

    /// Returns the force against an increase of K along the profile, per unit of its slope: dU/dK, J/(N/m^1.5), of laws whose
    /// force is the full gradient of U(K, delta). A law returns `None` always or never: its force is normal only.
    #[inline(always)]
    fn along<R: Real>(&self, _stiffness: R, _penetration: R) -> Option<R> {
        None
    }

    /// Returns the law's stiffness where Hertz's is `hertz`; its unit differs where the exponent is not 1.5.
    #[inline]
    fn stiffness(&self, hertz: f64) -> f64 {
        hertz
    }

    /// Returns the exponent n of laws whose force at rest, above a ramp, is stiffness times delta^n.
    #[inline]
    fn exponent(&self) -> f64 {
        1.5
    }

    /// Returns the force at rest, N, above a ramp, at the penetration `depth` (m), where Hertz's stiffness is `hertz`.
    fn elastic(&self, hertz: f64, depth: f64) -> f64 {
        self.stiffness(hertz) * depth.powf(self.exponent())
    }

    /// Returns the penetration, m, at which [`elastic`](Self::elastic) is `force`, N.
    fn depth(&self, hertz: f64, force: f64) -> f64 {
        (force / self.stiffness(hertz)).powf(self.exponent().recip())
    }

    /// Returns the derivative of [`elastic`](Self::elastic) by the penetration, N/m.
    fn tangent(&self, hertz: f64, depth: f64) -> f64 {
        self.exponent() * self.stiffness(hertz) * depth.powf(self.exponent() - 1.0)
    }

    /// Returns the force at `rate` and at rest, N, and the stored energy, J, which share their roots.
    #[inline(always)]
    fn observed<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
        [
            self.force(stiffness, penetration, rate),
            self.force(stiffness, penetration, rate.like(0.0)),
            self.stored(stiffness, penetration),
        ]
    }
}
