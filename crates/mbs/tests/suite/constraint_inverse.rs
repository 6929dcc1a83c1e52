//! Blocks of constraints without full rank.

use nalgebra::{Matrix2, Matrix3};
use pinwheel_mbs::internals::constraint_inverse;

/// Returns `[[a, b], [b, d]]` with these eigenvalues, the first along the direction at `angle`.
fn block(first: f64, second: f64, angle: f64) -> Matrix2<f64> {
    let (s, c) = angle.sin_cos();
    let turn = Matrix2::new(c, -s, s, c);
    turn * Matrix2::new(first, 0.0, 0.0, second) * turn.transpose()
}

/// Inverse in one direction and in two: directions with eigenvalues below the least are dropped. Entries outside of the part
/// stay the identity.
#[test]
fn constraints_are_inverted_without_what_does_not_stretch() {
    let inverted = |part: Matrix2<f64>, size: usize| {
        let mut matrix = Matrix3::identity() * 7.0;
        matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&part);
        let (inverse, regular) = constraint_inverse(&matrix, size, 1e-3);
        assert_eq!(inverse[(2, 2)], 1.0);
        let part: Matrix2<f64> = inverse.fixed_view::<2, 2>(0, 0).into();
        (part, regular)
    };
    let of = |x: f64| if x.abs() > 1e-3 { 1.0 / x } else { 0.0 };
    for angle in [0.0, 0.3, 0.8, 1.4, 2.5] {
        for (first, second) in [
            (-2.0, -0.5),
            (-0.5, -0.4),
            (-0.01, -3.0),
            (-1e-3 * 0.99, -0.3),
            (-0.3, -1e-3 * 1.01),
            (-0.3, 0.0),
            (-5.0, -1e-9),
            (-1e-4, -2e-4),
            (0.0, 0.0),
        ] {
            let (actual, regular) = inverted(block(first, second, angle), 2);
            let exact = block(of(first), of(second), angle);
            let off = (actual - exact).norm();
            assert!(
                off < 1e-9 * exact.norm() + 1e-12,
                "{first} {second} {angle}: {off:e}"
            );
            assert_eq!(
                regular,
                of(first) * of(second) != 0.0,
                "{first} {second} {angle}"
            );
        }
    }
    for (stretch, inverse) in [(-4.0, -0.25), (-1e-4, 0.0)] {
        let (actual, regular) = inverted(Matrix2::new(stretch, 0.0, 0.0, 9.0), 1);
        assert_eq!((actual[(0, 0)], actual[(1, 1)]), (inverse, 1.0));
        assert_eq!(regular, inverse != 0.0);
    }
}
