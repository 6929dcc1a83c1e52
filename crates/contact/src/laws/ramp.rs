//! Ramp S of Eq. 22, over which forces set in at small penetrations.

use crate::Real;

/// Ramp S: 0 at 0, 1 above its width, linear between. It stores the quotients and roots that the contact loops need.
///
/// ```
/// use pinwheel_contact::laws::Ramp;
///
/// let ramp = Ramp::new(1e-5);
/// assert!((ramp.at(5e-6) - 0.5_f64).abs() < 1e-15);
/// assert_eq!(ramp.at(1e-4), 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    width: f64,
    inverse: f64,
    /// Difference of the integral of x^1.5 from 0 to the width and that of S x^1.5, m^2.5.
    missing: f64,
}

impl Ramp {
    /// Creates a ramp of the given width, m.
    pub fn new(width: f64) -> Self {
        Self {
            width,
            inverse: width.recip(),
            missing: width * width * width.sqrt() * (1.0 / 2.5 - 1.0 / 3.5),
        }
    }

    /// Returns S at a penetration `x` > 0, m.
    #[inline(always)]
    pub fn at<R: Real>(&self, x: R) -> R {
        (x * x.like(self.inverse)).min(x.like(1.0))
    }

    /// Returns the integral of S x^1.5 from 0 to `x` >= 0, m^2.5.
    #[inline(always)]
    pub(crate) fn integral<R: Real>(&self, x: R) -> R {
        let power = x * x.sqrt() * x;
        let risen = power * (self.at(x) * x.like(1.0 / 3.5));
        let beyond = power.mul_add(x.like(1.0 / 2.5), x.like(-self.missing));
        x.below(x.like(self.width), risen, beyond)
    }
}
