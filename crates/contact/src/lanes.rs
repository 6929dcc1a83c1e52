//! Several values side by side, so that the compiler puts them into vector registers.
//!
//! Plain arrays and element-wise loops: the same source becomes SSE2, AVX2 or AVX-512 code by the
//! features of the function it is inlined into. Nothing here is faster or different by itself.

use std::ops::{Add, Mul, Neg, Sub};

/// Values a lane group holds: two AVX2 registers, whose work overlaps.
pub const LANES: usize = 8;

/// Eight values.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; LANES]);

/// Eight truth values, 1 or 0, kept as numbers so that they stay in vector registers.
pub type Mask = Lanes;

impl Lanes {
    /// All lanes 0.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// All lanes alike.
    #[must_use]
    #[inline(always)]
    pub fn splat(x: f64) -> Self {
        Self([x; LANES])
    }

    /// Element-wise function.
    #[must_use]
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut out = self.0;
        for x in &mut out {
            *x = f(*x);
        }
        Self(out)
    }

    /// Element-wise function of two.
    #[must_use]
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self.0;
        for (x, y) in out.iter_mut().zip(other.0) {
            *x = f(*x, y);
        }
        Self(out)
    }

    /// Square roots.
    #[must_use]
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Inverses.
    #[must_use]
    #[inline(always)]
    pub fn recip(self) -> Self {
        self.map(|x| 1.0 / x)
    }

    /// Absolute values.
    #[must_use]
    #[inline(always)]
    pub fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// 1 where `self < other`; 0 elsewhere, for NaN as well.
    #[must_use]
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask {
        self.zip(other, |a, b| if a < b { 1.0 } else { 0.0 })
    }

    /// `self` where the mask is set, else `other`.
    #[must_use]
    #[inline(always)]
    pub fn or_where_not(self, mask: Mask, other: Self) -> Self {
        let mut out = self.0;
        for ((x, m), y) in out.iter_mut().zip(mask.0).zip(other.0) {
            *x = if m != 0.0 { *x } else { y };
        }
        Self(out)
    }

    /// True if any lane of a mask is set.
    #[must_use]
    #[inline(always)]
    pub fn any(self) -> bool {
        self.sum() != 0.0
    }

    /// Sum of all lanes, in a fixed order.
    #[must_use]
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (b + f)) + ((c + g) + (d + h))
    }
}

macro_rules! element_wise {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    };
}
element_wise!(Add, add, +);
element_wise!(Sub, sub, -);
element_wise!(Mul, mul, *);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

/// Eight planar vectors or rotations; see [`Complex`](crate::Complex).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplexLanes {
    /// Real parts.
    pub re: Lanes,
    /// Imaginary parts.
    pub im: Lanes,
}

impl ComplexLanes {
    /// From parts.
    #[must_use]
    #[inline(always)]
    pub fn new(re: Lanes, im: Lanes) -> Self {
        Self { re, im }
    }

    /// All lanes alike.
    #[must_use]
    #[inline(always)]
    pub fn splat(z: crate::Complex) -> Self {
        Self { re: Lanes::splat(z.re), im: Lanes::splat(z.im) }
    }

    /// One lane.
    #[must_use]
    #[inline(always)]
    pub fn lane(self, k: usize) -> crate::Complex {
        crate::Complex::new(self.re.0[k], self.im.0[k])
    }

    /// Replaces one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, k: usize, z: crate::Complex) {
        (self.re.0[k], self.im.0[k]) = (z.re, z.im);
    }

    /// Turned by +90 degrees.
    #[must_use]
    #[inline(always)]
    pub fn turned(self) -> Self {
        Self { re: -self.im, im: self.re }
    }

    /// Scalar products.
    #[must_use]
    #[inline(always)]
    pub fn dot(self, o: Self) -> Lanes {
        self.re * o.re + self.im * o.im
    }

    /// Vector products.
    #[must_use]
    #[inline(always)]
    pub fn cross(self, o: Self) -> Lanes {
        self.re * o.im - self.im * o.re
    }

    /// Scaled lane by lane.
    #[must_use]
    #[inline(always)]
    pub fn scale(self, factor: Lanes) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    /// Power by squaring.
    #[must_use]
    #[inline(always)]
    pub fn powu(self, mut exponent: u32) -> Self {
        let one = Self { re: Lanes::splat(1.0), im: Lanes::ZERO };
        let (mut base, mut power) = (self, one);
        while exponent > 1 {
            if exponent & 1 == 1 {
                power = power * base;
            }
            base = base * base;
            exponent >>= 1;
        }
        if exponent == 1 { power * base } else { power }
    }
}

impl Add for ComplexLanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { re: self.re + o.re, im: self.im + o.im }
    }
}

impl Sub for ComplexLanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { re: self.re - o.re, im: self.im - o.im }
    }
}

impl Mul for ComplexLanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }
}
