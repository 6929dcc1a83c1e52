//! S of Eq. 22, by which forces set in over the first bit of a penetration.

use pulp::Simd;

use crate::lanes::Lanes;

/// S: 0 below 0, 1 above its width, linear between. With what the contact loops would divide and take roots for.
///
/// ```
/// use pinwheel_contact::laws::Ramp;
///
/// let ramp = Ramp::new(1e-5);
/// assert_eq!([-1e-6, 5e-6, 1e-4].map(|depth| ramp.at(depth)), [0.0, 0.5, 1.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    width: f64,
    inverse: f64,
    /// By how much the integral of x^1.5 from 0 to what is beyond the width is larger than that of S x^1.5, m^2.5.
    missing: f64,
}

impl Ramp {
    /// Of a width in m.
    #[must_use]
    pub fn new(width: f64) -> Self {
        Self {
            width,
            inverse: width.recip(),
            missing: width * width * width.sqrt() * (1.0 / 2.5 - 1.0 / 3.5),
        }
    }

    /// S at a penetration `x`, m.
    #[must_use]
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        (x / self.width).clamp(0.0, 1.0)
    }

    /// Integral of S x^1.5 from 0 to `x` >= 0, m^2.5.
    #[must_use]
    #[inline]
    pub(crate) fn integral(&self, x: f64) -> f64 {
        let power = x * x * x.sqrt();
        if x < self.width {
            power * x / (3.5 * self.width)
        } else {
            power / 2.5 - self.missing
        }
    }

    /// S of several penetrations above 0.
    #[must_use]
    #[inline(always)]
    pub(crate) fn lanes<S: Simd>(&self, x: Lanes<S>) -> Lanes<S> {
        (x * x.like(self.inverse)).min(x.like(1.0))
    }

    /// The integrals of several, whose x^1.5 is `power`.
    #[must_use]
    #[inline(always)]
    pub(crate) fn integral_lanes<S: Simd>(&self, x: Lanes<S>, power: Lanes<S>) -> Lanes<S> {
        let power = power * x;
        let risen = power * (self.lanes(x) * x.like(1.0 / 3.5));
        let beyond = power.mul_add(x.like(1.0 / 2.5), x.like(-self.missing));
        risen.or_where(x.less(x.like(self.width)), beyond)
    }
}
