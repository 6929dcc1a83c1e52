//! Dual numbers: derivatives of a formula, exact to rounding, by evaluating it.
//!
//! ```text
//! (x + x' d)(y + y' d) = x y + (x' y + x y') d,    f(x + x' d) = f(x) + f'(x) x' d,    d^2 = 0
//! ```
//! with one d for each variable. At a kink the derivative is that of the branch that the value takes.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Real, Scalar};

/// Value with its derivatives by `N` variables.
///
/// ```
/// use pinwheel_contact::{Dual, Real};
///
/// let [x, y] = Dual::variables([4.0, 3.0]);
/// let z = x.sqrt() * y;
/// assert_eq!((z.value, z.by), (6.0, [0.75, 2.0]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    /// Value.
    pub value: f64,
    /// Derivative by each variable.
    pub by: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// Returns a number that depends on no variable.
    #[inline(always)]
    pub fn constant(value: f64) -> Self {
        Self {
            value,
            by: [0.0; N],
        }
    }

    /// Returns the variables at these values.
    #[inline(always)]
    pub fn variables(values: [f64; N]) -> [Self; N] {
        let mut variables = values.map(Self::constant);
        for (k, variable) in variables.iter_mut().enumerate() {
            variable.by[k] = 1.0;
        }
        variables
    }

    /// Chain rule: returns this function with its variables replaced by the functions `own` of other variables.
    #[inline(always)]
    pub fn through<const M: usize>(&self, own: &[Dual<M>; N]) -> Dual<M> {
        let by = |m: usize| {
            self.by
                .iter()
                .zip(own)
                .map(|(by, own)| by * own.by[m])
                .sum()
        };
        Dual {
            value: self.value,
            by: each(by),
        }
    }

    /// Returns a function of this number, from its value and its slope there.
    #[inline(always)]
    fn map(self, value: f64, slope: f64) -> Self {
        let by = each(|k| slope * self.by[k]);
        Self { value, by }
    }
}

/// Returns a formula's value for each variable. The standard library's `from_fn` calls the formula instead of inlining it.
#[inline(always)]
fn each<const N: usize>(formula: impl Fn(usize) -> f64) -> [f64; N] {
    let mut values = [0.0; N];
    for (k, value) in values.iter_mut().enumerate() {
        *value = formula(k);
    }
    values
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            by: each(|k| self.by[k] + other.by[k]),
        }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            by: each(|k| self.by[k] - other.by[k]),
        }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule")]
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            by: each(|k| self.by[k] * other.value + self.value * other.by[k]),
        }
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (value, inverse) = (self.value / other.value, 1.0 / other.value);
        Self {
            value,
            by: each(|k| (self.by[k] - value * other.by[k]) * inverse),
        }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

impl<const N: usize> Real for Dual<N> {
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        Self::constant(x)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, 0.5 / root)
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let power = self.value.powf(exponent);
        let slope = match self.value == 0.0 {
            true => exponent * self.value.powf(exponent - 1.0),
            false => exponent * power / self.value,
        };
        self.map(power, slope)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.map(self.value.ln(), 1.0 / self.value)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        other.below(self, self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.below(other, self, other)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn below(self, limit: Self, yes: Self, no: Self) -> Self {
        if self.value < limit.value { yes } else { no }
    }
}

impl<const N: usize> Scalar for Dual<N> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.map(sin, cos), self.map(cos, -sin))
    }
}
