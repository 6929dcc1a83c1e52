//! A contact in series with the bending of the pin that its sleeve sits on.
//!
//! The pin has no mass and follows the force at rest: of the approach delta the contact takes x and the pin the rest,
//!
//! ```text
//! F_e(x) = k (delta - x),   s = x/delta
//! F = F_e(x) + s (F_n(x, s v) - F_e(x)),   U = U_n(x) + F_e^2/(2 k)
//! ```
//! The contact closes at its share s of the rate, and what it loses at that rate is what the pair loses at the whole one: the
//! energy account closes. To first order in the rate that is the spring's and damper's own motion where F_e is linear; of other
//! laws the true share is that of the tangents, which jumps where a law has a kink, and forces would jump with it.
//!
//! x is the root of a rising function in [0, delta], by the secant method: from delta/(1 + sqrt(F_e(delta)/(k delta))) ten
//! steps reach rounding for pins up to 10^4 times as soft as the contact, through ramps too. Inverse functions of the laws would
//! not know their ramps.

use pulp::{Simd, WithSimd};

use super::{Law, NormalLaw};
use crate::{Lanes, Real};

const STEPS: usize = 10;
/// Shorter steps, as a share of x, tell no slope.
const TELLING: f64 = 1e-7;

/// The normal law of a gear, and what the pins of its output pins add to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinLaw {
    /// Law of every contact without the pin's bending.
    pub law: Law,
    /// k of a pin, N/m; `None`: rigid.
    pub pin_n_m: Option<f64>,
}

impl PinLaw {
    /// The law of pins that sit on nothing that bends, as external ones do.
    #[must_use]
    #[inline(always)]
    pub fn on_rigid_pin(self) -> Self {
        let pin_n_m = None;
        Self { pin_n_m, ..self }
    }

    /// As [`NormalLaw::force`], of a sleeve on such a pin; `penetration` and `rate` are those of contact and pin together.
    #[must_use]
    #[inline(always)]
    pub fn force<R: OnPin>(&self, stiffness: R, penetration: R, rate: R) -> R {
        match self.pin_n_m {
            None => self.law.force(stiffness, penetration, rate),
            Some(_) => self.observed(stiffness, penetration, rate)[0],
        }
    }

    /// As [`NormalLaw::observed`].
    #[must_use]
    #[inline(always)]
    pub fn observed<R: OnPin>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
        R::observed(self, [stiffness, penetration, rate])
    }
}

/// Numbers that know a contact on its pin. A function of its own: it is large and called from many places.
pub trait OnPin: Real {
    /// Force at a rate and at rest, N, and energy stored, J, at a stiffness, a penetration and a rate.
    fn observed(law: &PinLaw, contact: [Self; 3]) -> [Self; 3];
}

impl OnPin for f64 {
    #[inline(never)]
    fn observed(law: &PinLaw, contact: [Self; 3]) -> [Self; 3] {
        observed(law, contact)
    }
}

impl<S: Simd> OnPin for Lanes<S> {
    #[inline(always)]
    fn observed(law: &PinLaw, contact: [Self; 3]) -> [Self; 3] {
        contact[0].simd().vectorize(Observed { law, contact })
    }
}

struct Observed<'a, S: Simd> {
    law: &'a PinLaw,
    contact: [Lanes<S>; 3],
}

impl<S: Simd> WithSimd for Observed<'_, S> {
    type Output = [Lanes<S>; 3];

    #[inline(always)]
    fn with_simd<T: Simd>(self, _simd: T) -> Self::Output {
        observed(self.law, self.contact)
    }
}

#[inline(always)]
fn observed<R: Real>(law: &PinLaw, [stiffness, penetration, rate]: [R; 3]) -> [R; 3] {
    match law.pin_n_m {
        None => law.law.observed(stiffness, penetration, rate),
        Some(pin) => series(&law.law, pin, [stiffness, penetration, rate]),
    }
}

/// See the module.
#[inline(always)]
fn series<R: Real>(law: &Law, pin: f64, [stiffness, whole, rate]: [R; 3]) -> [R; 3] {
    let c = |x: f64| whole.like(x);
    let (zero, one, k) = (c(0.0), c(1.0), c(pin));
    let (mut low, mut high) = (zero, whole);
    let mut last = [whole, law.force(stiffness, whole, zero)];
    let ratio = last[1] / (k * whole);
    let mut slope = k * (one + ratio);
    let mut x = whole / (one + ratio.sqrt());
    for _ in 0..STEPS {
        let excess = k.mul_add(x - whole, law.force(stiffness, x, zero));
        low = excess.below(zero, x, low);
        high = excess.below(zero, high, x);
        let step = x - last[0];
        // It rises with k at least.
        let secant = ((excess - last[1]) / step).max(k);
        let told = step.max(-step);
        slope = told.below(x * c(TELLING), slope, secant);
        last = [x, excess];
        let next = x - excess / slope;
        let middle = (low + high) * c(0.5);
        let capped = high.below(next, middle, next);
        x = next.below(low, middle, capped);
    }
    let share = x / whole;
    let [force, elastic, stored] = law.observed(stiffness, x, share * rate);
    [
        share.mul_add(force - elastic, elastic),
        elastic,
        (elastic * elastic).mul_add(c(0.5 / pin), stored),
    ]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::LawParameters;
    use crate::laws::LAWS;

    fn on_pin(name: &str, pin: f64) -> PinLaw {
        PinLaw {
            law: Law::named(name, &LawParameters::default()).unwrap(),
            pin_n_m: Some(pin),
        }
    }

    /// Springs in series: 1/k = 1/k1 + 1/k2, and the damper sees the square of its share.
    #[test]
    fn published_springs_in_series() {
        let law = on_pin("linear", 5e7);
        let (stiffness, depth, rate) = (1e8, 5e-5, 0.01);
        let [force, elastic, stored] = law.observed(stiffness, depth, rate);
        let series = 1.0 / (1.0 / 1e8 + 1.0 / 5e7);
        assert!(
            (elastic / (series * depth) - 1.0).abs() < 1e-14,
            "{elastic}"
        );
        assert!((stored / (0.5 * series * depth * depth) - 1.0).abs() < 1e-14);
        let share = series / 1e8;
        let lost = law.law.force(stiffness, share * depth, share * rate) - elastic;
        assert!((force - elastic - share * lost).abs() < 1e-12, "{force}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// Contact and pin carry the same force, together they take the whole approach, forces rise and are the slope of the
        /// energy; lanes say the same.
        #[test]
        fn the_force_is_that_of_contact_and_pin(
            number in 0..LAWS.len(), depth in -7.0..-3.3_f64, hertz in 7.0..10.5_f64, softer in -6.0..4.0_f64,
            rate in -0.1..0.1_f64,
        ) {
            let (depth, hertz) = (10f64.powf(depth), 10f64.powf(hertz));
            let name = LAWS[number].name;
            let plain = on_pin(name, 1.0).law;
            let pin = plain.force(hertz, depth, 0.0) / depth / 10f64.powf(softer);
            let law = on_pin(name, pin);
            let [force, elastic, stored] = law.observed(hertz, depth, rate);
            let x = depth - elastic / pin;
            if softer < 1.0 {
                // Where most of the approach is the pin's, the rest is known less well.
                prop_assert!((plain.force(hertz, x, 0.0) / elastic - 1.0).abs() < 1e-11, "{name} {x}");
            }
            prop_assert!(force.is_finite() && (force - elastic) * rate >= 0.0);
            let (h, by) = (1e-6 * depth, 1e-6 * x);
            // Deeper than a line contact can be the law is a spring without an energy of its own.
            let rise = (plain.stored(hertz, x + by) - plain.stored(hertz, x - by)) / (2.0 * by);
            prop_assume!((rise / plain.force(hertz, x, 0.0) - 1.0).abs() < 1e-6);
            let beside = |h: f64| law.observed(hertz, depth + h, 0.0);
            let slope = (beside(h)[2] - beside(-h)[2]) / (2.0 * h);
            prop_assert!((slope / elastic - 1.0).abs() < 1e-6, "{name}: {slope} {elastic}");
            prop_assert!(beside(h)[0] > elastic && elastic > 0.0 && stored > 0.0);
            prop_assert!(elastic <= pin * depth && elastic <= plain.force(hertz, depth, 0.0) * (1.0 + 1e-12));
            pulp::Arch::new().dispatch(Same(law, [hertz, depth, rate]));
        }
    }

    #[derive(Debug, Clone, Copy)]
    struct Same(PinLaw, [f64; 3]);

    impl WithSimd for Same {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let [k, d, v] = self.1.map(|x| Lanes::splat(simd, x));
            let (lanes, [k1, d1, v1]) = (self.0.observed(k, d, v), self.1);
            let one = self.0.observed(k1, d1, v1);
            // A force that has almost parted is a difference from the one at rest.
            for ((lanes, value), size) in
                lanes
                    .iter()
                    .zip(one)
                    .zip([one[0].max(one[1]), one[1], one[2]])
            {
                for lane in lanes.as_slice() {
                    assert!(
                        (lane - value).abs() <= 1e-12 * size,
                        "{lane} {value} {self:?}"
                    );
                }
            }
        }
    }
}
