//! Planar vectors and rotations as complex numbers.
//!
//! Angles enter the hot path only as unit numbers: a rotation by a small angle is a short series, a multiple angle a power, and
//! no sine is evaluated per contact. (num-complex would do except for its `norm`: a `hypot`, several times slower than a root.)

use std::ops::{Add, Mul, Neg, Sub};

use crate::{Real, Scalar};

/// Complex number x + i y, of scalars or of lanes ([`ComplexLanes`](crate::ComplexLanes)).
///
/// ```
/// use pinwheel_contact::Complex;
///
/// let quarter = Complex::unit(std::f64::consts::FRAC_PI_2);
/// assert!((Complex::new(3.0, 4.0) * quarter - Complex::new(-4.0, 3.0)).norm() < 1e-15);
/// // The moment of a force (0, 2) at the arm (3, 4).
/// assert_eq!(Complex::new(3.0, 4.0).cross(Complex::new(0.0, 2.0)), 6.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Complex<R = f64> {
    /// Real part, x.
    pub re: R,
    /// Imaginary part, y.
    pub im: R,
}

impl<R> Complex<R> {
    /// x + i y.
    #[inline(always)]
    pub const fn new(re: R, im: R) -> Self {
        Self { re, im }
    }
}

impl<R: Copy> Complex<R> {
    /// Converts to `[x, y]`.
    #[inline]
    pub const fn to_array(self) -> [R; 2] {
        [self.re, self.im]
    }
}

impl<R: Real> Complex<R> {
    /// Conjugate x - i y: the inverse of a rotation.
    #[inline(always)]
    pub fn conj(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// Rotation by +90 degrees.
    #[inline(always)]
    pub fn turned(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// Scalar product of two vectors.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.re.mul_add(other.re, self.im * other.im)
    }

    /// z component of the vector product: the moment of the force `other` at the arm `self`.
    #[inline(always)]
    pub fn cross(self, other: Self) -> R {
        self.re * other.im - self.im * other.re
    }

    /// Product with the conjugate of `other`.
    #[inline(always)]
    pub fn times_conj(self, other: Self) -> Self {
        Self::new(self.dot(other), other.cross(self))
    }

    /// Product with a real factor.
    #[inline(always)]
    pub fn scale(self, factor: R) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }

    /// Returns self * factor + term.
    #[inline(always)]
    pub fn scale_add(self, factor: R, term: Self) -> Self {
        Self::new(
            self.re.mul_add(factor, term.re),
            self.im.mul_add(factor, term.im),
        )
    }

    /// Power by squaring; for a unit number the rotation by `exponent` times its angle.
    #[inline(always)]
    pub fn powu(self, mut exponent: u32) -> Self {
        let mut base = self;
        let mut power: Option<Self> = None;
        loop {
            if exponent & 1 == 1 {
                power = Some(power.map_or(base, |p| p * base));
            }
            exponent >>= 1;
            if exponent == 0 {
                return power.unwrap_or(Self::new(self.re.like(1.0), self.re.like(0.0)));
            }
            base = base * base;
        }
    }
}

impl<R: Scalar> Complex<R> {
    /// Unit number e^{i angle}.
    #[inline]
    pub fn unit(angle: R) -> Self {
        let (im, re) = angle.sin_cos();
        Self { re, im }
    }

    /// Squared length.
    #[inline]
    pub fn norm2(self) -> R {
        self.dot(self)
    }

    /// Length.
    #[inline]
    pub fn norm(self) -> R {
        self.norm2().sqrt()
    }
}

impl Complex {
    /// Unity: the rotation by zero.
    pub const ONE: Self = Self { re: 1.0, im: 0.0 };

    /// Converts a constant vector to numbers of the kind of `number`, with zero derivatives.
    #[inline(always)]
    pub fn like<R: Real>(self, number: R) -> Complex<R> {
        Complex::new(number.like(self.re), number.like(self.im))
    }

    /// Returns e^{i angle}; below 2^-6 rad by a series that is exact to rounding.
    #[inline]
    pub fn unit_near_zero(angle: f64) -> Self {
        if angle.abs() > 0.015_625 {
            return Self::unit(angle);
        }
        let x2 = angle * angle;
        Self {
            re: 1.0 - x2 * (0.5 - x2 * (1.0 / 24.0 - x2 * (1.0 / 720.0))),
            im: angle * (1.0 - x2 * (1.0 / 6.0 - x2 * (1.0 / 120.0 - x2 * (1.0 / 5040.0)))),
        }
    }

    /// Argument in (-pi, pi].
    #[inline]
    pub fn arg(self) -> f64 {
        self.im.atan2(self.re)
    }
}

impl<R> From<[R; 2]> for Complex<R> {
    #[inline]
    fn from([re, im]: [R; 2]) -> Self {
        Self { re, im }
    }
}

impl<R: Real> Add for Complex<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.re + o.re, self.im + o.im)
    }
}

impl<R: Real> Sub for Complex<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.re - o.re, self.im - o.im)
    }
}

impl<R: Real> Mul for Complex<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self::new(
            self.re.mul_add(o.re, -(self.im * o.im)),
            self.re.mul_add(o.im, self.im * o.re),
        )
    }
}

impl<R: Real> Neg for Complex<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}
