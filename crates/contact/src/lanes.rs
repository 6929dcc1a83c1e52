//! Several values side by side in vector registers, for any instruction set.
//!
//! `S` is the instruction set, which pulp selects at run time. A [`Lanes`] is two of its registers, whose latencies overlap: 8
//! doubles with AVX2, 2 on a machine without vectors.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;
use pulp::bytemuck::cast;

use crate::{Complex, Real};

/// Two registers of doubles.
///
/// ```
/// use pinwheel_contact::{Lanes, Real};
/// use pulp::Simd;
///
/// /// Root of every value, several at a time, by the vector instructions of the processor.
/// struct Roots<'a>(&'a mut [f64]);
///
/// impl pulp::WithSimd for Roots<'_> {
///     type Output = ();
///
///     #[inline(always)]
///     fn with_simd<S: Simd>(self, simd: S) {
///         for group in self.0.chunks_exact_mut(Lanes::<S>::COUNT) {
///             Lanes::load(simd, group).sqrt().store(group);
///         }
///     }
/// }
///
/// let mut values = [4.0; 16];
/// pulp::Arch::new().dispatch(Roots(&mut values));
/// assert_eq!(values, [2.0; 16]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    v: [S::f64s; 2],
}

/// Truth value for each lane.
#[derive(Debug, Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    m: [S::m64s; 2],
}

/// Applies one expression to both registers, of numbers (`Lanes`, `v`) or of truth values (`Mask`, `m`). A closure may end up
/// outside of the function with the vector instructions, so that each operation becomes a call.
macro_rules! both {
    ($self:ident, $k:ident, $value:expr) => {
        both!(Lanes.v, $self, $k, $value)
    };
    ($type:ident.$field:ident, $self:ident, $k:ident, $value:expr) => {{
        let register = [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
        ];
        $type {
            simd: $self.simd,
            $field: register,
        }
    }};
}

impl<S: Simd> Lanes<S> {
    /// Number of values in one group.
    pub const COUNT: usize = 2 * S::F64_LANES;

    /// Sets all lanes to one value.
    #[inline(always)]
    pub fn splat(simd: S, x: f64) -> Self {
        Self {
            simd,
            v: [simd.splat_f64s(x); 2],
        }
    }

    /// Returns the instruction set.
    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    /// Loads the first [`Lanes::COUNT`] values of a slice; lanes beyond its end are 0.
    #[inline(always)]
    pub fn load(simd: S, values: &[f64]) -> Self {
        if let ([a, b, ..], _) = S::as_simd_f64s(values) {
            return Self { simd, v: [*a, *b] };
        }
        let (head, tail) = values.split_at(S::F64_LANES.min(values.len()));
        Self {
            simd,
            v: [simd.partial_load_f64s(head), simd.partial_load_f64s(tail)],
        }
    }

    /// Sets each register to one of two values.
    #[inline(always)]
    pub fn splat_pair(simd: S, [a, b]: [f64; 2]) -> Self {
        Self {
            simd,
            v: [simd.splat_f64s(a), simd.splat_f64s(b)],
        }
    }

    /// Loads one register from the front of each of two slices; lanes beyond their ends are 0.
    #[inline(always)]
    pub fn load_pair(simd: S, [a, b]: [&[f64]; 2]) -> Self {
        Self {
            simd,
            v: [Self::register(simd, a), Self::register(simd, b)],
        }
    }

    #[inline(always)]
    fn register(simd: S, values: &[f64]) -> S::f64s {
        match S::as_simd_f64s(values).0 {
            [first, ..] => *first,
            [] => simd.partial_load_f64s(values),
        }
    }

    /// Loads one register from the front of a slice and sets the other to 0; operations on the first alone cost nothing extra.
    #[inline(always)]
    pub fn load_first(simd: S, values: &[f64]) -> Self {
        Self {
            simd,
            v: [Self::register(simd, values), simd.splat_f64s(0.0)],
        }
    }

    /// Writes the first register to the front of a slice of at least as many values.
    #[inline(always)]
    pub fn store_first(self, values: &mut [f64]) {
        if let [first, ..] = S::as_mut_simd_f64s(values).0 {
            *first = self.v[0];
        }
    }

    /// Adds one of the two registers to the front of a slice of at least as many values.
    #[inline(always)]
    pub fn add_register(&self, which: usize, values: &mut [f64]) {
        if let [first, ..] = S::as_mut_simd_f64s(values).0 {
            *first = self.simd.add_f64s(*first, self.v[which]);
        }
    }

    /// Sum of each register, in a fixed order.
    #[inline(always)]
    pub fn sums(self) -> [f64; 2] {
        [
            self.simd.reduce_sum_f64s(self.v[0]),
            self.simd.reduce_sum_f64s(self.v[1]),
        ]
    }

    /// Writes all lanes to the front of a slice of at least [`Lanes::COUNT`] values.
    #[inline(always)]
    pub fn store(self, values: &mut [f64]) {
        if let [a, b, ..] = S::as_mut_simd_f64s(values).0 {
            [*a, *b] = self.v;
        }
    }

    /// Returns the lanes as numbers.
    #[inline(always)]
    pub fn as_slice(&self) -> &[f64] {
        pulp::bytemuck::cast_slice(&self.v)
    }

    /// Returns the lanes as mutable numbers.
    #[inline(always)]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        pulp::bytemuck::cast_slice_mut(&mut self.v)
    }

    /// Inverse square roots of positive numbers, to 2 units of the last place: half of the exponent by integers, then Newton's
    /// steps of third order. Dividers and roots take several times as long as these products.
    #[inline(always)]
    pub fn inverse_sqrt(self) -> Self {
        const GUESS: u32 = 0x5fe6_eb50;
        if const { size_of::<S::u32s>() != size_of::<S::f64s>() } {
            return self.sqrt().recip();
        }
        let (guess, one) = (self.simd.splat_u32s(GUESS), self.simd.splat_u32s(1));
        let mut root = both!(self, k, {
            let half = self.simd.wrapping_dyn_shr_u32s(cast(self.v[k]), one);
            cast(self.simd.sub_u32s(guess, half))
        });
        for _ in 0..3 {
            let off = (self * root).mul_add(-root, self.like(1.0));
            let more = off.mul_add(self.like(0.375), self.like(0.5));
            root = (off * root).mul_add(more, root);
        }
        root
    }

    /// Inverses.
    #[inline(always)]
    pub fn recip(self) -> Self {
        let one = self.simd.splat_f64s(1.0);
        both!(self, k, self.simd.div_f64s(one, self.v[k]))
    }

    /// Absolute values.
    #[inline(always)]
    pub fn abs(self) -> Self {
        // pulp's own abs is not always inlined.
        let rest = self.simd.splat_f64s(f64::from_bits(!(1 << 63)));
        both!(self, k, self.simd.and_f64s(self.v[k], rest))
    }

    /// Mask of `self < other`; false for NaN.
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask<S> {
        both!(
            Mask.m,
            self,
            k,
            self.simd.less_than_f64s(self.v[k], other.v[k])
        )
    }

    /// Returns `self` where the mask is set and 0 elsewhere, also for NaN.
    #[inline(always)]
    pub fn only(self, mask: Mask<S>) -> Self {
        let zero = self.like(0.0);
        self.or_where(mask, zero)
    }

    /// Returns `self` where the mask is set, `other` elsewhere.
    #[inline(always)]
    pub fn or_where(self, mask: Mask<S>, other: Self) -> Self {
        // pulp's own selection of numbers is not always inlined, that of integers is.
        both!(self, k, {
            let (yes, no) = (cast(self.v[k]), cast(other.v[k]));
            cast(self.simd.select_u64s(mask.m[k], yes, no))
        })
    }

    /// Sum of all lanes, in a fixed order.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        self.simd
            .reduce_sum_f64s(self.simd.add_f64s(self.v[0], self.v[1]))
    }
}

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        both!(self, k, self.simd.sqrt_f64s(self.v[k]))
    }

    #[inline(always)]
    fn powf(mut self, exponent: f64) -> Self {
        for x in self.as_mut_slice() {
            *x = x.powf(exponent);
        }
        self
    }

    /// Computes the logarithm to 2 units of the last place: exponent and mantissa m in [1/sqrt 2, sqrt 2] by integers, then ln
    /// m = 2 artanh((m - 1)/(m + 1)).
    #[inline(always)]
    fn ln(mut self) -> Self {
        const MANTISSA: u64 = (1 << 52) - 1;
        // The exponent begins at bit 20 of the upper half; there the lowest bit of a number of 2^20 is 1.
        const UNIT: f64 = 1_048_576.0;
        const UPPER: u64 = 0x7ff << 32;
        // ln 2 in two parts: one of 32 bits, whose multiples are exact, and the remainder.
        const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
        if const { size_of::<S::u32s>() != size_of::<S::f64s>() } {
            for x in self.as_mut_slice() {
                *x = x.ln();
            }
            return self;
        }
        let c = |x: f64| self.like(x);
        let bits = |x: u64| self.simd.splat_f64s(f64::from_bits(x));
        let (upper, unit) = (bits(UPPER), bits(UNIT.to_bits()));
        let (mantissa, one) = (bits(MANTISSA), bits(1.0_f64.to_bits()));
        let twenty = self.simd.splat_u32s(20);
        let exponent = both!(self, k, {
            let moved = self.simd.wrapping_dyn_shr_u32s(cast(self.v[k]), twenty);
            self.simd
                .or_f64s(self.simd.and_f64s(cast(moved), upper), unit)
        }) - c(UNIT + 1023.0);
        let m = both!(self, k, {
            self.simd
                .or_f64s(self.simd.and_f64s(self.v[k], mantissa), one)
        });
        let large = c(std::f64::consts::SQRT_2).less(m);
        let m = (m * c(0.5)).or_where(large, m);
        let exponent = (exponent + c(1.0)).or_where(large, exponent);
        let s = (m - c(1.0)) / (m + c(1.0));
        let s2 = s * s;
        let mut series = c(1.0 / 21.0);
        for k in 1..10 {
            series = series.mul_add(s2, c(1.0 / f64::from(21 - 2 * k)));
        }
        let s = s + s;
        let low = exponent.mul_add(c(LN_2[1]), s * s2 * series);
        exponent.mul_add(c(LN_2[0]), s + low)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        both!(self, k, self.simd.max_f64s(self.v[k], other.v[k]))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        both!(self, k, self.simd.min_f64s(self.v[k], other.v[k]))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        both!(self, k, {
            self.simd.mul_add_e_f64s(self.v[k], factor.v[k], term.v[k])
        })
    }

    #[inline(always)]
    fn below(self, limit: Self, yes: Self, no: Self) -> Self {
        yes.or_where(self.less(limit), no)
    }
}

impl<S: Simd> Mask<S> {
    /// Returns lanes in which both masks are set.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        both!(Mask.m, self, k, self.simd.and_m64s(self.m[k], other.m[k]))
    }

    /// Returns lanes in which this mask is set and the other is not.
    #[inline(always)]
    pub fn without(self, other: Self) -> Self {
        both!(Mask.m, self, k, {
            let not = self.simd.not_m64s(other.m[k]);
            self.simd.and_m64s(self.m[k], not)
        })
    }

    /// Returns lanes in which at least one mask is set.
    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        both!(Mask.m, self, k, self.simd.or_m64s(self.m[k], other.m[k]))
    }

    /// True if any lane is set.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.first_set() < Lanes::<S>::COUNT
    }

    /// Returns the index of the first set lane; [`Lanes::COUNT`] if none is.
    #[inline(always)]
    pub fn first_set(self) -> usize {
        let (first, second) = (self.first_of(0), self.first_of(1));
        if first < S::F64_LANES {
            first
        } else {
            S::F64_LANES + second
        }
    }

    /// Returns the index of the first set lane of a register; its number of lanes if none is.
    #[inline(always)]
    fn first_of(self, register: usize) -> usize {
        let mask = self.m[register];
        // pulp 0.22 counts bits from the wrong end where a lane is one bit.
        if const { size_of::<S::m64s>() == 1 && S::F64_LANES == 8 } {
            return cast::<S::m64s, u8>(mask).trailing_zeros() as usize;
        }
        self.simd.first_true_m64s(mask)
    }

    /// Returns one lane.
    #[inline(always)]
    pub fn lane(self, k: usize) -> bool {
        Lanes::splat(self.simd, 1.0).only(self).as_slice()[k] != 0.0
    }

    /// Sets the first `count` lanes.
    #[inline(always)]
    pub fn first(simd: S, count: usize) -> Self {
        let mut numbers = Lanes::splat(simd, 1.0);
        for (k, x) in numbers.as_mut_slice().iter_mut().enumerate() {
            *x = if k < count { 0.0 } else { 1.0 };
        }
        numbers.less(Lanes::splat(simd, 0.5))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $function:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                both!(self, k, self.simd.$function(self.v[k], other.v[k]))
            }
        }
    };
}
operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // pulp's own neg is not always inlined.
        let sign = self.simd.splat_f64s(-0.0);
        both!(self, k, self.simd.xor_f64s(self.v[k], sign))
    }
}

/// Taylor coefficients of (cos x - 1)/x^2 and (sin x - x)/x^3 in x^2, highest first: on [-pi/2, pi/2] the remainder is below
/// 1e-17.
const COS: [f64; 10] = inverse_factorials(20);
const SIN: [f64; 10] = inverse_factorials(21);

/// Inverse factorials of `last`, `last` - 2, ..., with alternating signs that end in -.
const fn inverse_factorials(last: u32) -> [f64; 10] {
    let mut of = [0.0; 10];
    let mut k = 0;
    while k < 10 {
        let (mut n, mut product) = (last - 2 * k, 1.0);
        while n > 1 {
            product *= n as f64;
            n -= 1;
        }
        of[k as usize] = if k % 2 == 0 { 1.0 } else { -1.0 } / product;
        k += 1;
    }
    of
}

/// Planar vectors or rotations, several side by side.
pub type ComplexLanes<S> = Complex<Lanes<S>>;

impl<S: Simd> ComplexLanes<S> {
    /// Sets all lanes to one vector.
    #[inline(always)]
    pub fn splat(simd: S, z: Complex) -> Self {
        Self::new(Lanes::splat(simd, z.re), Lanes::splat(simd, z.im))
    }

    /// Returns one lane.
    #[inline(always)]
    pub fn lane(&self, k: usize) -> Complex {
        Complex::new(self.re.as_slice()[k], self.im.as_slice()[k])
    }

    /// Replaces one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, k: usize, z: Complex) {
        self.re.as_mut_slice()[k] = z.re;
        self.im.as_mut_slice()[k] = z.im;
    }

    /// Sets each register to one of two vectors.
    #[inline(always)]
    pub fn splat_pair(simd: S, [a, b]: [Complex; 2]) -> Self {
        Self::new(
            Lanes::splat_pair(simd, [a.re, b.re]),
            Lanes::splat_pair(simd, [a.im, b.im]),
        )
    }

    /// e^{i angle}, to 2e-16: both series on [-pi/2, pi/2], turned by pi for odd multiples of it.
    #[inline(always)]
    pub fn units(angle: Lanes<S>) -> Self {
        // Largest multiple whose products with the first two parts of pi are exact: parts of 32 bits [Cody & Waite 1980].
        const MOST: f64 = 3e6;
        const PI: [f64; 3] = [
            3.141_592_653_468_251_2,
            1.215_420_101_260_793_2e-10,
            4.044_532_497_591_901e-21,
        ];
        // Adding and subtracting this rounds to an integer.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let c = |x: f64| angle.like(x);
        let rounded = |x: Lanes<S>| (x + c(ROUND)) - c(ROUND);
        if c(MOST).less(angle.abs()).any() {
            return Self::unit_by_lane(angle);
        }
        let n = rounded(angle * c(std::f64::consts::FRAC_1_PI));
        let odd = n - rounded(n * c(0.5)) * c(2.0);
        let sign = (odd * odd).mul_add(c(-2.0), c(1.0));
        let x = ((angle - n * c(PI[0])) - n * c(PI[1])) - n * c(PI[2]);
        let x2 = x * x;
        let (mut cos, mut sin) = (c(COS[0]), c(SIN[0]));
        for (&a, &b) in COS[1..].iter().zip(&SIN[1..]) {
            cos = cos.mul_add(x2, c(a));
            sin = sin.mul_add(x2, c(b));
        }
        Self::new(
            sign * x2.mul_add(cos, c(1.0)),
            sign * (x * x2).mul_add(sin, x),
        )
    }

    #[cold]
    #[inline(never)]
    fn unit_by_lane(angle: Lanes<S>) -> Self {
        let mut unit = Self::new(angle, angle);
        for (k, &x) in angle.as_slice().iter().enumerate() {
            unit.set_lane(k, Complex::unit(x));
        }
        unit
    }

    /// Returns `self` where the mask is set, 0 elsewhere.
    #[inline(always)]
    pub fn only(self, mask: Mask<S>) -> Self {
        Self::new(self.re.only(mask), self.im.only(mask))
    }
}
