//! Hysteresis laws: `F_n = max(0, K delta^1.5 (1 + chi v/v0))`.
//!
//! v0 is the speed at which the bodies met; chi follows from the restitution c and differs between the laws. The true v0
//! differs from contact to contact and is history, which a field of forces does not have. Here v0 is **one reference speed of
//! the scene**. An impact at that speed has the restitution c; a slower one loses less, as with the damping `K chi delta^1.5
//! v/v0` of Hunt and Crossley's own paper. The reference speed also bounds the damping: with the true v0, which tends to 0 at a
//! smooth entry, the damping has no bound.
//!
//! For a mass m the resulting restitution has a closed form and depends on chi only. From m v dv/d(delta) = -K delta^n (1 + chi
//! v/v0), both ways between equal penetrations:
//!
//! ```text
//! chi - ln(1 + chi) = -chi c - ln(1 - chi c)
//! ```

use super::NormalLaw;
use crate::Real;

/// Law of the hysteresis family.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hysteresis {
    /// Factor chi/v0, s/m.
    per_speed: f64,
}

impl Hysteresis {
    /// Creates a law from `factor` chi and the reference impact speed v0, m/s (> 0).
    pub fn new(factor: f64, impact_speed: f64) -> Self {
        Self {
            per_speed: factor / impact_speed,
        }
    }
}

impl NormalLaw for Hysteresis {
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        let c = |x: f64| rate.like(x);
        let elastic = stiffness * penetration * penetration.sqrt();
        (elastic * (c(1.0) + c(self.per_speed) * rate)).max(c(0.0))
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        stiffness * penetration * penetration * penetration.sqrt() / stiffness.like(2.5)
    }
}
