//! Functions of lanes against the standard library, by every instruction set there is.

use pinwheel_contact::{Complex, ComplexLanes, Lanes};
use pulp::Simd;

struct Functions<'a>(&'a [f64]);

impl pulp::WithSimd for Functions<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for group in self.0.chunks(Lanes::<S>::COUNT) {
            let x = Lanes::load(simd, group);
            let (unit, root) = (ComplexLanes::unit(x), x.abs().inverse_sqrt());
            for (k, &x) in group.iter().enumerate() {
                let off = (unit.lane(k) - Complex::unit(x)).norm();
                assert!(off < 4e-16, "e^i {x}: off by {off:e}");
                let off = root.as_slice()[k] * x.abs().sqrt() - 1.0;
                assert!(off.abs() < 5e-16, "1/sqrt({x}): off by {off:e}");
            }
        }
    }
}

/// Angles of some turns and of many, and beyond what the reduction in lanes is exact for.
#[test]
fn units_and_roots_are_those_of_the_library() {
    let mut values = Vec::new();
    for k in 1..4000 {
        let x = 0.001 + f64::from(k) * 0.017_3;
        values.extend([x, -x, 1e-4 * x, 731.0 * x, 4e4 * x, -3e7 * x]);
    }
    values.extend((1..200).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2));
    values.extend((-40..40).map(|k| 2.0_f64.powi(8 * k)));
    for arch in [pulp::Arch::new(), pulp::Arch::Scalar] {
        arch.dispatch(Functions(&values));
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        pulp::Arch::V3(avx2).dispatch(Functions(&values));
    }
}
