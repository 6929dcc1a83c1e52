//! Line contact after Palmgren: `F_n = max(0, K_L delta^(10/9) + S(delta) C v)`.
//!
//! Pins and discs are cylinders. Palmgren measured steel rollers: delta = 3.84e-5 F^0.9/L^0.8 with delta and L in mm and F in
//! N, so `K_L = H (1000/3.84e-5)^(10/9) L^(8/9)`, N/m^(10/9), for all radii; H as for the other laws.

use super::{LawInfo, LawParameters, NormalLaw, Ramp, Shape};
use crate::Real;

/// Power law of the depth fitted to rollers, with the paper's damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineContact {
    stiffness: f64,
    exponent: f64,
    damping: f64,
    ramp: Ramp,
}

impl LineContact {
    /// Creates the law of the fit delta = `approach` F^(1/`exponent`)/L^(`length`/`exponent`) with delta and L in mm and F in
    /// N.
    pub(super) fn fitted(
        approach: f64,
        exponent: f64,
        length: f64,
        parameters: &LawParameters,
    ) -> Self {
        let length_mm = 1000.0 * parameters.line_length;
        let stiffness = (1000.0 / approach).powf(exponent) * length_mm.powf(length);
        Self {
            stiffness: parameters.stiffness_multiplier * stiffness,
            exponent,
            damping: parameters.damping,
            ramp: Ramp::new(parameters.ramp),
        }
    }
}

impl NormalLaw for LineContact {
    #[inline(always)]
    fn force<R: Real>(&self, _hertz: R, penetration: R, rate: R) -> R {
        let c = |x: f64| rate.like(x);
        let elastic = c(self.stiffness) * penetration.powf(self.exponent);
        (elastic + self.ramp.at(penetration) * c(self.damping) * rate).max(c(0.0))
    }

    #[inline(always)]
    fn stored<R: Real>(&self, _hertz: R, penetration: R) -> R {
        let c = |x: f64| penetration.like(x);
        let power = self.exponent + 1.0;
        c(self.stiffness) * penetration.powf(power) * c(1.0 / power)
    }

    #[inline]
    fn stiffness(&self, _hertz: f64) -> f64 {
        self.stiffness
    }

    #[inline]
    fn exponent(&self) -> f64 {
        self.exponent
    }
}

pub(super) fn new(parameters: &LawParameters) -> LineContact {
    LineContact::fitted(3.84e-5, 10.0 / 9.0, 8.0 / 9.0, parameters)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "line-contact",
    summary: "cylinders on a line after Palmgren, exponent 10/9, with the paper's damping",
    formula: "max(0, K_L delta^(10/9) + S(delta) C v), K_L = H (1000/3.84e-5)^(10/9) L_mm^(8/9)",
    source: "A. Palmgren, Ball and Roller Bearing Engineering, 3rd ed., 1959: delta = 3.84e-5 F^0.9/L^0.8 (mm, N)",
    domain: "steel cylinders of equal length; the radii do not enter",
    slow_impact: "regular: does not depend on the impact speed",
    keys: &[
        "contact.line_length_m",
        "contact.damping_n_s_m",
        "contact.ramp_m",
    ],
    restitution_factor: None,
    conservative: true,
    shape: Shape::Line,
    materials: "steel: Palmgren measured bearings",
    stiffness: None,
};
