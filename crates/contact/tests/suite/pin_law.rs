//! Contacts in series with a bending pin.

use pinwheel_contact::laws::LAWS;
use pinwheel_contact::{Lanes, Law, LawParameters, NormalLaw as _, PinLaw};
use proptest::prelude::*;
use pulp::{Simd, WithSimd};

fn on_pin(name: &str, pin: f64) -> PinLaw {
    PinLaw {
        law: Law::named(name, &LawParameters::default()).unwrap(),
        pin_n_m: Some(pin),
        ring_n_m: None,
    }
}

/// Springs in series: 1/k = 1/k1 + 1/k2, and the damper acts with the square of its share.
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

    /// Contact and pin have equal forces and share the approach; forces rise and are the slope of the energy; lanes agree.
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
            // The remainder is less accurate if most of the approach is the pin's.
            prop_assert!((plain.force(hertz, x, 0.0) / elastic - 1.0).abs() < 1e-11, "{name} {x}");
        }
        prop_assert!(force.is_finite() && (force - elastic) * rate >= 0.0);
        let (h, by) = (1e-6 * depth, 1e-6 * x);
        // Beyond the depth of a line contact the law is a spring without an energy of its own.
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
        // A nearly vanishing force is a small difference from the force at rest.
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
