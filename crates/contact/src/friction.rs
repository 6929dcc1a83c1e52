//! Friction: regularised Coulomb (Eq. 21, made symmetric), and Adams' form with two velocities.
//!
//! The paper: |F_t| = mu F_n clamp(|v_t|/v_s, 0, 1), against the sliding. Eq. 22 as printed is 0 for v_t < 0, which would leave
//! that direction without friction.
//!
//! Adams: mu(v) rises through STEP from -mu_s at -v_s to mu_s at v_s and falls to mu_d at v_d (stiction
//! transition and friction transition velocity); source: MSC Adams documentation, CONTACT, Coulomb friction.

use crate::Real;
use crate::laws::step;

/// Coulomb friction that rises linearly up to the sliding speed `ramp`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularisedCoulomb {
    /// Coefficient of friction mu.
    pub coefficient: f64,
    /// Sliding speed v_s at which the full force is reached, m/s.
    pub ramp: f64,
}

impl RegularisedCoulomb {
    /// Returns the tangential force, N, positive in the positive direction of `sliding` (m/s).
    #[inline]
    pub fn force<R: Real>(&self, normal: R, sliding: R) -> R {
        let c = |x: f64| normal.like(x);
        let share = (sliding / c(self.ramp)).max(c(-1.0)).min(c(1.0));
        c(-self.coefficient) * normal * share
    }
}

/// Coulomb friction with a static peak and a dynamic plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamsFriction {
    /// Static coefficient mu_s, at `static_speed`.
    pub static_coefficient: f64,
    /// Dynamic coefficient mu_d, from `dynamic_speed` on.
    pub dynamic_coefficient: f64,
    /// Sliding speed v_s of the static peak, m/s.
    pub static_speed: f64,
    /// Sliding speed v_d > v_s of the dynamic plateau, m/s.
    pub dynamic_speed: f64,
}

impl AdamsFriction {
    /// Returns the tangential force, N, positive in the positive direction of `sliding` (m/s).
    #[inline]
    pub fn force<R: Real>(&self, normal: R, sliding: R) -> R {
        let (mu_s, mu_d) = (self.static_coefficient, self.dynamic_coefficient);
        let (zero, speed) = (sliding.like(0.0), sliding.max(-sliding));
        let rising = step(sliding, -self.static_speed, -mu_s, self.static_speed, mu_s);
        let falling = step(speed, self.static_speed, mu_s, self.dynamic_speed, mu_d);
        let falling = sliding.below(zero, -falling, falling);
        let mu = speed.below(sliding.like(self.static_speed), rising, falling);
        -mu * normal
    }
}

/// Friction of a scene.
///
/// ```
/// use pinwheel_contact::{Friction, RegularisedCoulomb};
///
/// let friction = Friction::Regularised(RegularisedCoulomb { coefficient: 0.1, ramp: 5e-5 });
/// // 10 N pressed, sliding faster than the ramp: 1 N against the motion; half of it at half the ramp.
/// assert_eq!(friction.force(10.0, 0.3), -1.0);
/// assert_eq!(friction.force(10.0, -2.5e-5), 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// Regularised Coulomb friction, Eq. 21.
    Regularised(RegularisedCoulomb),
    /// Friction of Adams with two velocities.
    Adams(AdamsFriction),
}

impl Friction {
    /// Returns the tangential force, N, positive in the positive direction of `sliding` (m/s).
    #[inline]
    pub fn force<R: Real>(&self, normal: R, sliding: R) -> R {
        match self {
            Self::Regularised(law) => law.force(normal, sliding),
            Self::Adams(law) => law.force(normal, sliding),
        }
    }
}
