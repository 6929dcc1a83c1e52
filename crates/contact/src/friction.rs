//! Regularised Coulomb friction (Eq. 21, made symmetric).
//!
//! |F_t| = mu F_n clamp(|v_t|/v_s, 0, 1), against the sliding. Eq. 22 as printed is 0 for v_t < 0
//! and would leave that direction without friction.

/// Coulomb friction that rises linearly up to the sliding speed `ramp`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularisedCoulomb {
    /// mu
    pub coefficient: f64,
    /// v_s, m/s.
    pub ramp: f64,
}

impl RegularisedCoulomb {
    /// Tangential force, N, along the direction in which `sliding` (m/s) is counted.
    #[must_use]
    #[inline]
    pub fn force(&self, normal: f64, sliding: f64) -> f64 {
        -self.coefficient * normal * (sliding / self.ramp).clamp(-1.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposes_sliding_both_ways_and_saturates() {
        let friction = RegularisedCoulomb {
            coefficient: 0.1,
            ramp: 5e-5,
        };
        assert_eq!(friction.force(10.0, 1.0), -1.0);
        assert_eq!(friction.force(10.0, -1.0), 1.0);
        assert!((friction.force(10.0, 2.5e-5) + 0.5).abs() < 1e-15);
    }
}
