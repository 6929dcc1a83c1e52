//! Functions of lanes against the standard library, for every available instruction set.

use pinwheel_contact::{Complex, ComplexLanes, Lanes, Mask, Real};
use pulp::Simd;

#[derive(Clone, Copy)]
struct Functions<'a>(&'a [f64]);

impl pulp::WithSimd for Functions<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for group in self.0.chunks(Lanes::<S>::COUNT) {
            let x = Lanes::load(simd, group);
            let (unit, root) = (ComplexLanes::units(x), x.abs().inverse_sqrt());
            for (k, &x) in group.iter().enumerate() {
                let off = (unit.lane(k) - Complex::unit(x)).norm();
                assert!(off < 4e-16, "e^i {x}: off by {off:e}");
                let off = root.as_slice()[k] * x.abs().sqrt() - 1.0;
                assert!(off.abs() < 5e-16, "1/sqrt({x}): off by {off:e}");
            }
        }
    }
}

/// Angles of some turns and of many, and beyond the exact range of the reduction in lanes.
#[test]
fn units_and_roots_are_those_of_the_library() {
    let mut values = Vec::new();
    for k in 1..4000 {
        let x = 0.001 + f64::from(k) * 0.017_3;
        values.extend([x, -x, 1e-4 * x, 731.0 * x, 4e4 * x, -3e7 * x]);
    }
    values.extend((1..200).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2));
    values.extend((-40..40).map(|k| 2.0_f64.powi(8 * k)));
    by_every_set(Functions(&values));
}

fn by_every_set<T: pulp::WithSimd + Copy>(task: T) {
    for arch in [pulp::Arch::new(), pulp::Arch::Scalar] {
        arch.dispatch(task);
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        pulp::Arch::V3(avx2).dispatch(task);
    }
}

/// Operations on two groups of different numbers.
#[derive(Clone, Copy)]
struct Operations;

impl pulp::WithSimd for Operations {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        numbers(simd);
        masks(simd);
        vectors(simd);
    }
}

/// Returns a group of numbers of both signs that depends on `of`.
fn group<S: Simd>(of: f64) -> Vec<f64> {
    let count = Lanes::<S>::COUNT as u32;
    (0..count)
        .map(|k| (of * f64::from(k + 1)).sin() * 3.0)
        .collect()
}

#[inline(always)]
fn numbers<S: Simd>(simd: S) {
    let (x, y) = (group::<S>(1.3), group::<S>(2.1));
    let (a, b) = (Lanes::load(simd, &x), Lanes::load(simd, &y));
    for k in 0..x.len() {
        let (x, y) = (x[k], y[k]);
        for (name, actual, exact) in [
            ("+", a + b, x + y),
            ("-", a - b, x - y),
            ("*", a * b, x * y),
            ("neg", -a, -x),
            ("abs", a.abs(), x.abs()),
            ("sqrt", (a * a).sqrt(), x.abs()),
            ("recip", a.recip(), 1.0 / x),
            ("min", a.min(b), x.min(y)),
            ("max", a.max(b), x.max(y)),
            ("less", a.only(a.less(b)), if x < y { x } else { 0.0 }),
            ("or_where", a.or_where(a.less(b), b), x.min(y)),
            ("like", a.like(0.7), 0.7),
        ] {
            assert_eq!(actual.as_slice()[k], exact, "{name} {x} {y}");
        }
        let fused = a.mul_add(b, a).as_slice()[k];
        assert!((fused - (x * y + x)).abs() < 4e-15, "{fused}");
    }
    let half = x.len() / 2;
    let exact = [x[..half].iter().sum::<f64>(), x[half..].iter().sum()];
    let [first, second] = a.sums();
    assert!((first - exact[0]).abs() < 4e-15 && (second - exact[1]).abs() < 4e-15);
    assert!((a.sum() - exact[0] - exact[1]).abs() < 8e-15);

    // Storing and loading; values beyond the end are 0.
    let mut stored = y.clone();
    a.store(&mut stored);
    assert_eq!(stored, x);
    let short = Lanes::load(simd, &x[1..]);
    assert_eq!(short.as_slice()[..x.len() - 1], x[1..]);
    assert_eq!(short.as_slice()[x.len() - 1], 0.0);
    let pair = Lanes::load_pair(simd, [&y[..half], &x[..half]]);
    assert_eq!(pair.as_slice(), [&y[..half], &x[..half]].concat());
    let pair = Lanes::splat_pair(simd, [2.0, 3.0]);
    assert_eq!(pair.as_slice(), [vec![2.0; half], vec![3.0; half]].concat());
    for which in [0, 1] {
        let mut sum = y.clone();
        a.add_register(which, &mut sum);
        for k in 0..half {
            assert_eq!(sum[k], y[k] + x[which * half + k]);
        }
        assert_eq!(sum[half..], y[half..]);
    }
}

#[inline(always)]
fn masks<S: Simd>(simd: S) {
    let count = Lanes::<S>::COUNT;
    for one in 0..=count {
        for other in 0..=count {
            let (a, b) = (Mask::first(simd, one), Mask::first(simd, other));
            for k in 0..count {
                let (x, y) = (k < one, k < other);
                assert_eq!(a.lane(k), x);
                assert_eq!(a.and(b).lane(k), x && y);
                assert_eq!(a.or(b).lane(k), x || y);
                assert_eq!(a.without(b).lane(k), x && !y);
            }
            assert_eq!(a.any(), one > 0);
            assert_eq!(a.without(b).any(), one > other);
            let first = if one > other { other } else { count };
            assert_eq!(a.without(b).first_set(), first);
        }
    }
}

#[inline(always)]
fn vectors<S: Simd>(simd: S) {
    let lanes = |of: f64| {
        ComplexLanes::new(
            Lanes::load(simd, &group::<S>(of)),
            Lanes::load(simd, &group::<S>(of + 0.37)),
        )
    };
    let (a, b) = (lanes(1.3), lanes(2.1));
    let mask = Mask::first(simd, Lanes::<S>::COUNT / 2);
    for k in 0..Lanes::<S>::COUNT {
        let (x, y) = (a.lane(k), b.lane(k));
        assert_eq!(x, Complex::new(a.re.as_slice()[k], a.im.as_slice()[k]));
        let none = Complex::new(0.0, 0.0);
        for (name, actual, exact) in [
            ("+", a + b, x + y),
            ("-", a - b, x - y),
            ("*", a * b, x * y),
            ("turned", a.turned(), Complex::new(-x.im, x.re)),
            ("times_conj", a.times_conj(b), x * Complex::new(y.re, -y.im)),
            ("scale", a.scale(b.re), x.scale(y.re)),
            ("scale_add", a.scale_add(b.re, b), x.scale(y.re) + y),
            ("only", a.only(mask), if mask.lane(k) { x } else { none }),
            (
                "splat",
                ComplexLanes::splat(simd, Complex::unit(0.3)),
                Complex::unit(0.3),
            ),
        ] {
            let off = (actual.lane(k) - exact).norm();
            assert!(off < 8e-15, "{name} {x:?} {y:?}: off by {off:e}");
        }
        let off = a.dot(b).as_slice()[k] - (x.re * y.re + x.im * y.im);
        assert!(off.abs() < 8e-15, "{off:e}");
        let off = a.cross(b).as_slice()[k] - (x.re * y.im - x.im * y.re);
        assert!(off.abs() < 8e-15, "{off:e}");
        let unit = ComplexLanes::units(a.re);
        for exponent in 1..20 {
            let exact = Complex::unit(f64::from(exponent) * x.re);
            let off = (unit.powu(exponent).lane(k) - exact).norm();
            assert!(off < 4e-14, "{exponent}: off by {off:e}");
        }
    }
    let pair = ComplexLanes::splat_pair(simd, [Complex::unit(0.2), Complex::unit(0.4)]);
    assert_eq!(pair.lane(0), Complex::unit(0.2));
    assert_eq!(pair.lane(Lanes::<S>::COUNT - 1), Complex::unit(0.4));
    let mut changed = a;
    changed.set_lane(1, Complex::unit(0.5));
    assert_eq!(changed.lane(1), Complex::unit(0.5));
    assert_eq!(changed.lane(0), a.lane(0));
}

#[test]
fn operations_are_those_of_each_lane() {
    by_every_set(Operations);
}
