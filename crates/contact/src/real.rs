//! Operations on a number that the formulas of contacts need, so that each formula stands once for one value and for
//! several side by side, and with its derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A double, a group of them in vector registers ([`Lanes`](crate::Lanes)), or one with its derivatives
/// ([`Dual`](crate::Dual)).
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant, in all lanes of such a group.
    #[must_use]
    fn like(self, x: f64) -> Self;

    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Power.
    #[must_use]
    fn powf(self, exponent: f64) -> Self;

    /// Natural logarithm of a positive, normal number.
    #[must_use]
    fn ln(self) -> Self;

    /// Larger of two.
    #[must_use]
    fn max(self, other: Self) -> Self;

    /// Smaller of two.
    #[must_use]
    fn min(self, other: Self) -> Self;

    /// self * factor + term, fused in lanes where that is one instruction; a double is rounded twice.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// `yes` where self < limit, `no` elsewhere.
    #[must_use]
    fn below(self, limit: Self, yes: Self, no: Self) -> Self;
}

/// One number, whose value may decide which way a formula goes.
pub trait Scalar: Real {
    /// Value, without its derivatives.
    #[must_use]
    fn value(self) -> f64;

    /// Sine and cosine.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
}

impl Scalar for f64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
}

impl Real for f64 {
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        self.powf(exponent)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.ln()
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.max(other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.min(other)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn below(self, limit: Self, yes: Self, no: Self) -> Self {
        if self < limit { yes } else { no }
    }
}
