//! Hertzian stiffness from the local curvature (Eq. 23, 24).
//!
//! ```text
//! K = 4 H / (3 pi (h_c + h_p)) sqrt(R_c R_p / (R_c + R_p)),   h = (1 - nu^2)/(pi E)
//! ```
//! R_c is signed (negative in a pit, where the pin lies inside the disc's curve). For a
//! profile that is the inward offset of C by the pin radius q, R_c = 1/kappa_C - q and the
//! radicand is q (1 - q kappa_C): no singularity at the inflections.

use pinwheel_faults::{Fault, factor};

use crate::Real;

/// Elastic constants of a body in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl Material {
    /// Returns the compliance h = (1 - nu^2)/(pi E), 1/Pa.
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poisson * self.poisson) / (std::f64::consts::PI * self.young)
    }
}

/// Stiffness K as a function of the effective radius.
///
/// ```
/// use pinwheel_contact::{HertzStiffness, Material};
///
/// let steel = Material { young: 2e11, poisson: 0.3 };
/// let k = HertzStiffness::new(steel, steel, 1.0);
/// // A pin of 6 mm in a hole of 8.8 mm is stiffer than one on a plane: R_c R_p/(R_c + R_p) is 18.9 mm and not 6 mm.
/// let ratio = k.of_hole(0.006, 0.0088) / k.on_flat(0.006);
/// assert!((ratio - (0.0088_f64 / 0.0028).sqrt()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzStiffness {
    coefficient: f64,
    /// Pin radius and power of the factor on K, for laws that depend on the pin's radius besides R.
    sleeve: Option<(f64, f64)>,
    /// Factor in holes.
    internal: f64,
    /// Stiffness of external and internal contacts, for laws without curvature.
    stages: Option<[f64; 2]>,
}

impl HertzStiffness {
    /// Creates the stiffness from the materials of pin and disc and the multiplier H.
    pub fn new(sleeve: Material, wheel: Material, multiplier: f64) -> Self {
        let multiplier = multiplier * factor(Fault::Stiffness, 1.01);
        let h = sleeve.compliance() + wheel.compliance();
        Self {
            coefficient: 4.0 * multiplier / (3.0 * std::f64::consts::PI * h),
            sleeve: None,
            internal: 1.0,
            stages: None,
        }
    }

    /// Returns the stiffness with a factor on K in holes.
    #[must_use]
    pub fn with_internal(self, internal: f64) -> Self {
        Self { internal, ..self }
    }

    /// Returns the stiffness with fixed K of ring and output pins, for all radii.
    #[must_use]
    pub fn of_stages(self, stages: [f64; 2]) -> Self {
        Self {
            stages: Some(stages),
            ..self
        }
    }

    /// True if K changes with the curvature.
    pub fn is_curved(&self) -> bool {
        self.stages.is_none()
    }

    /// Returns the stiffness with a factor (`radius`/sleeve)^`power` on K: pins of that radius (m) have Hertz's K.
    #[must_use]
    pub fn with_sleeve(self, radius: f64, power: f64) -> Self {
        Self {
            sleeve: Some((radius, power)),
            ..self
        }
    }

    /// Returns K/sqrt(R), N/m^2.
    pub fn coefficient(&self) -> f64 {
        self.coefficient
    }

    /// Returns K, N/m^1.5, of a pin of radius `sleeve` where R_c R_p/(R_c + R_p) = `radius`, m (both > 0).
    #[inline]
    pub fn of<R: Real>(&self, sleeve: f64, radius: R) -> R {
        let c = |x: f64| radius.like(x);
        let k = c(self.coefficient) * radius.sqrt();
        match (self.stages, self.sleeve) {
            (Some([external, _]), _) => c(external),
            (None, Some((usual, power))) if sleeve != usual => k * c((usual / sleeve).powf(power)),
            _ => k,
        }
    }

    /// Returns K of a pin on a flat, N/m^1.5.
    pub fn on_flat(&self, sleeve: f64) -> f64 {
        self.of(sleeve, sleeve)
    }

    /// Returns K of a pin of radius `sleeve` on the inward offset by `offset` of a curve with curvature `kappa`: with R_c =
    /// 1/kappa - offset the radicand is `sleeve (1 - offset kappa)/(1 + (sleeve - offset) kappa)`.
    #[inline]
    pub fn of_edge<R: Real>(&self, sleeve: f64, offset: f64, kappa: R) -> R {
        let c = |x: f64| kappa.like(x);
        let radius =
            c(sleeve) * (c(1.0) - c(offset) * kappa) / (c(1.0) + c(sleeve - offset) * kappa);
        self.of(sleeve, radius)
    }

    /// Returns K of a pin of radius `sleeve` in a hole of radius `hole` (R_c = -hole).
    pub fn of_hole(&self, sleeve: f64, hole: f64) -> f64 {
        match self.stages {
            Some([_, internal]) => internal,
            None => self.internal * self.of(sleeve, hole * sleeve / (hole - sleeve)),
        }
    }
}
