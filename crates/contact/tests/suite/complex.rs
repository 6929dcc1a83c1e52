//! Complex numbers: series and powers.

use pinwheel_contact::Complex;

#[test]
fn series_is_exact_to_rounding() {
    for k in -1000..=1000 {
        let angle = f64::from(k) * 2e-5;
        let (a, b) = (Complex::unit_near_zero(angle), Complex::unit(angle));
        assert!((a - b).norm() < 3e-16, "{angle}: {a:?} {b:?}");
        // Small angles keep their digits.
        assert!((a.im - b.im).abs() <= 3e-16 * b.im.abs(), "{angle}");
        let (a, b) = (
            Complex::unit_near_zero(30.0 * angle),
            Complex::unit(30.0 * angle),
        );
        assert!((a - b).norm() < 3e-16, "{a:?} {b:?}");
    }
    assert_eq!(-Complex::new(1.0, -2.0), Complex::new(-1.0, 2.0));
}

#[test]
fn powers_are_multiple_angles() {
    for n in 0..70 {
        let difference = Complex::unit(0.1234).powu(n) - Complex::unit(0.1234 * f64::from(n));
        assert!(difference.norm() < 1e-14, "{n}");
    }
}
