//! Contact in series with the bending of the pin that carries the sleeve.
//!
//! The pin has no mass and follows the force at rest: of the approach delta the contact takes x and the pin the remainder,
//!
//! ```text
//! F_e(x) = k (delta - x),   s = x/delta
//! F = F_e(x) + s (F_n(x, s v) - F_e(x)),   U = U_n(x) + F_e^2/(2 k)
//! ```
//! The contact closes at its share s of the rate. Its loss at that rate equals the pair's loss at the full rate, so that the
//! energy account closes. To first order in the rate this is the motion of spring and damper where F_e is linear. For other
//! laws the true share is that of the tangents, which jumps at a kink of the law, and forces would jump with it.
//!
//! x is the root of a rising function in [0, delta], by the secant method. From delta/(1 + sqrt(F_e(delta)/(k delta))) ten
//! steps reach rounding for pins up to 10^4 times as soft as the contact, through ramps too. Inverse functions of the laws
//! would ignore their ramps.

use pulp::{Simd, WithSimd};

use super::{Law, NormalLaw};
use crate::{Dual, Lanes, Real};

const STEPS: usize = 10;
/// Smallest step, relative to x, from which a slope is computed.
const TELLING: f64 = 1e-7;

/// Normal law of a gear, with the bending of its output pins and the seats of its ring pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinLaw {
    /// Law of every contact without the pin's bending.
    pub law: Law,
    /// Stiffness k of a pin, N/m; `None`: rigid.
    pub pin_n_m: Option<f64>,
    /// Stiffness of a ring pin's seat, N/m; `None`: rigid.
    pub ring_n_m: Option<f64>,
}

impl PinLaw {
    /// Returns the law for a pin of this stiffness, N/m.
    #[must_use]
    #[inline(always)]
    pub fn on(self, pin_n_m: Option<f64>) -> Self {
        Self { pin_n_m, ..self }
    }

    /// Returns the force along the profile as [`NormalLaw::along`], of a contact in series with its pin.
    #[inline(always)]
    pub fn along<R: OnPin>(&self, stiffness: R, penetration: R) -> Option<R> {
        let Some(pin) = self.pin_n_m else {
            return self.law.along(stiffness, penetration);
        };
        self.law.along(stiffness, penetration)?;
        let [_, elastic, _] = self.observed(stiffness, penetration, penetration.like(0.0));
        let contact = penetration - elastic * penetration.like(1.0 / pin);
        self.law.along(stiffness, contact)
    }

    /// Returns the normal force as [`NormalLaw::force`], of a sleeve on a bending pin; `penetration` and `rate` are those of
    /// contact and pin together.
    #[inline(always)]
    pub fn force<R: OnPin>(&self, stiffness: R, penetration: R, rate: R) -> R {
        match self.pin_n_m {
            None => self.law.force(stiffness, penetration, rate),
            Some(_) => self.observed(stiffness, penetration, rate)[0],
        }
    }

    /// Returns forces and energy as [`NormalLaw::observed`].
    #[inline(always)]
    pub fn observed<R: OnPin>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
        match self.pin_n_m {
            None => self.law.observed(stiffness, penetration, rate),
            Some(pin) => R::series(&self.law, pin, [stiffness, penetration, rate]),
        }
    }
}

/// Numbers for which a contact on a bending pin is evaluated. The function is not inlined: it is large and has many callers.
pub trait OnPin: Real {
    /// Returns the force at a rate and at rest, N, and the stored energy, J, at a stiffness, a penetration and a rate, on a pin of
    /// this stiffness, N/m.
    fn series(law: &Law, pin: f64, contact: [Self; 3]) -> [Self; 3];
}

impl OnPin for f64 {
    #[inline(never)]
    fn series(law: &Law, pin: f64, contact: [Self; 3]) -> [Self; 3] {
        series(law, pin, contact)
    }
}

impl<const N: usize> OnPin for Dual<N> {
    #[inline(never)]
    fn series(law: &Law, pin: f64, contact: [Self; 3]) -> [Self; 3] {
        series(law, pin, contact)
    }
}

impl<S: Simd> OnPin for Lanes<S> {
    #[inline(always)]
    fn series(law: &Law, pin: f64, contact: [Self; 3]) -> [Self; 3] {
        contact[0].simd().vectorize(Series { law, pin, contact })
    }
}

struct Series<'a, S: Simd> {
    law: &'a Law,
    pin: f64,
    contact: [Lanes<S>; 3],
}

impl<S: Simd> WithSimd for Series<'_, S> {
    type Output = [Lanes<S>; 3];

    #[inline(always)]
    fn with_simd<T: Simd>(self, _simd: T) -> Self::Output {
        series(self.law, self.pin, self.contact)
    }
}

/// Solves contact and pin in series; see the module's text.
#[inline(always)]
fn series<R: Real>(law: &Law, pin: f64, [stiffness, depth, rate]: [R; 3]) -> [R; 3] {
    let c = |x: f64| depth.like(x);
    let (zero, one, k) = (c(0.0), c(1.0), c(pin));
    let (mut low, mut high) = (zero, depth);
    let mut last = [depth, law.force(stiffness, depth, zero)];
    let ratio = last[1] / (k * depth);
    let mut slope = k * (one + ratio);
    let mut x = depth / (one + ratio.sqrt());
    for _ in 0..STEPS {
        let excess = k.mul_add(x - depth, law.force(stiffness, x, zero));
        low = excess.below(zero, x, low);
        high = excess.below(zero, high, x);
        let step = x - last[0];
        // The slope is at least k.
        let secant = ((excess - last[1]) / step).max(k);
        let length = step.max(-step);
        slope = length.below(x * c(TELLING), slope, secant);
        last = [x, excess];
        let next = x - excess / slope;
        let middle = (low + high) * c(0.5);
        let capped = high.below(next, middle, next);
        x = next.below(low, middle, capped);
    }
    let share = x / depth;
    let [force, elastic, stored] = law.observed(stiffness, x, share * rate);
    [
        share.mul_add(force - elastic, elastic),
        elastic,
        (elastic * elastic).mul_add(c(0.5 / pin), stored),
    ]
}
