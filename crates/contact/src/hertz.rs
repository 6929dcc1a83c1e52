//! Hertzian stiffness from the local curvature (Eq. 23, 24).
//!
//! ```text
//! K = 4 H / (3 pi (h_c + h_p)) sqrt(R_c R_p / (R_c + R_p)),   h = (1 - nu^2)/(pi E)
//! ```
//! R_c is signed (negative in a pit, where the sleeve lies inside the wheel's curve). For a
//! profile that is the inward offset of C by the sleeve radius q, R_c = 1/kappa_C - q and the
//! radicand is q (1 - q kappa_C): no singularity at the inflections.

use pinwheel_faults::{Fault, factor};

/// K as a function of the effective radius.
///
/// ```
/// use pinwheel_contact::HertzStiffness;
///
/// let steel = HertzStiffness::new(2e11, 0.3, 1.0);
/// // A sleeve of 6 mm in a hole of 8.8 mm is stiffer than one on a plane: R_c R_p/(R_c + R_p) is 18.9 mm and not 6 mm.
/// let ratio = steel.of_hole(0.006, 0.0088) / steel.of_edge(0.006, 0.006, 0.0);
/// assert!((ratio - (0.0088_f64 / 0.0028).sqrt()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzStiffness {
    coefficient: f64,
}

impl HertzStiffness {
    /// Both bodies of one material: Young's modulus (Pa), Poisson's ratio, multiplier H.
    #[must_use]
    pub fn new(young: f64, poisson: f64, multiplier: f64) -> Self {
        let multiplier = multiplier * factor(Fault::Stiffness, 1.01);
        let h = (1.0 - poisson * poisson) / (std::f64::consts::PI * young);
        Self {
            coefficient: 4.0 * multiplier / (3.0 * std::f64::consts::PI * 2.0 * h),
        }
    }

    /// K, N/m^1.5, for R_c R_p/(R_c + R_p) = `radius`, m (> 0).
    #[must_use]
    #[inline]
    pub fn of_radius(&self, radius: f64) -> f64 {
        self.coefficient * radius.sqrt()
    }

    /// K of a sleeve of radius `sleeve` on the inward offset by `offset` of a curve that bends by `kappa`: with
    /// R_c = 1/kappa - offset the radicand is `sleeve (1 - offset kappa)/(1 + (sleeve - offset) kappa)`.
    #[must_use]
    #[inline]
    pub fn of_edge(&self, sleeve: f64, offset: f64, kappa: f64) -> f64 {
        self.of_radius(sleeve * (1.0 - offset * kappa) / (1.0 + (sleeve - offset) * kappa))
    }

    /// K of a sleeve of radius `sleeve` in a hole of radius `hole` (R_c = -hole).
    #[must_use]
    pub fn of_hole(&self, sleeve: f64, hole: f64) -> f64 {
        self.of_radius(hole * sleeve / (hole - sleeve))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn profile_form_is_equation_23() {
        let steel = HertzStiffness::new(2.0e11, 0.3, 0.01);
        let (q, kappa): (f64, f64) = (0.006, 65.96);
        let rc: f64 = 1.0 / kappa - q;
        let h: f64 = 0.91 / (std::f64::consts::PI * 2.0e11);
        let k = 4.0 * 0.01 / (3.0 * std::f64::consts::PI * 2.0 * h) * (rc * q / (rc + q)).sqrt();
        assert_relative_eq!(steel.of_edge(q, q, kappa), k, max_relative = 1e-14);
        // A sleeve that did not make the profile.
        let rp = 0.0061;
        let k = k * (rc * rp / (rc + rp) / (rc * q / (rc + q))).sqrt();
        assert_relative_eq!(steel.of_edge(rp, q, kappa), k, max_relative = 1e-14);
        assert_relative_eq!(
            steel.of_hole(0.006, 0.0088),
            steel.of_radius(0.018_857_142_857_142_857),
            max_relative = 1e-14
        );
    }
}
