//! LU factors of a small dense matrix.

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::internals::Lu;
use proptest::prelude::*;

proptest! {
    #[test]
    fn solves_what_nalgebra_solves(
        n in 1_usize..9, values in prop::collection::vec(-1.0..1.0_f64, 81), zero_first: bool,
    ) {
        let mut a = DMatrix::from_row_slice(n, n, &values[..n * n]);
        if zero_first {
            a[(0, 0)] = 0.0; // asks for a pivot
        }
        let b = DVector::from_row_slice(&values[values.len() - n..]);
        let expected = a.clone().full_piv_lu().solve(&b);
        let mut lu = Lu::new(n);
        lu.entries_mut().copy_from_slice(a.transpose().as_slice());
        let condition = a.clone().svd(false, false).singular_values;
        prop_assume!(condition.min() > 1e-6);
        prop_assert!(lu.factor());
        let mut x = b.as_slice().to_vec();
        lu.solve(&mut x);
        let expected = expected.expect("regular");
        for (x, e) in x.iter().zip(expected.iter()) {
            prop_assert!((x - e).abs() < 1e-13 / condition.min() * (1.0 + expected.amax()), "{x} {e}");
        }
    }
}

#[test]
fn singular_and_infinite_matrices_are_refused() {
    for entries in [
        [1.0, 2.0, 2.0, 4.0],
        [0.0; 4],
        [1.0, f64::NAN, 0.0, f64::NAN],
    ] {
        let mut lu = Lu::new(2);
        lu.entries_mut().copy_from_slice(&entries);
        assert!(!lu.factor(), "{entries:?}");
    }
}
