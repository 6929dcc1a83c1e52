//! Numbers in contact formulas, so that each formula is written once for scalars, for lanes and for derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number: a double, a group of doubles in vector registers ([`Lanes`](crate::Lanes)), or a double with derivatives
/// ([`Dual`](crate::Dual)).
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Constant `x`, in all lanes.
    fn like(self, x: f64) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Power.
    fn powf(self, exponent: f64) -> Self;

    /// Natural logarithm of a positive, normal number.
    fn ln(self) -> Self;

    /// Larger of two.
    fn max(self, other: Self) -> Self;

    /// Smaller of two.
    fn min(self, other: Self) -> Self;

    /// Returns self * factor + term, fused in lanes where that is one instruction; a double is rounded twice.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Selects `yes` where self < limit, `no` elsewhere.
    fn below(self, limit: Self, yes: Self, no: Self) -> Self;
}

/// Single number, whose value may select a branch of a formula.
pub trait Scalar: Real {
    /// Value, without its derivatives.
    fn value(self) -> f64;

    /// Sine and cosine.
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
