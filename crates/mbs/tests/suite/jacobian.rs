//! Jacobians with hubs and leaves.

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::{Jacobian, Structure};
use proptest::prelude::*;

const N: usize = 7;

proptest! {
    /// Any partition into hubs and leaves, of first and second order, against the full matrix.
    #[test]
    fn solves_like_the_full_matrix(
        is_leaf in prop::collection::vec(any::<bool>(), N), second: bool,
        entries in prop::collection::vec(-1.0..1.0_f64, 2 * N * N),
        rhs in prop::collection::vec(-1.0..1.0_f64, 2 * N), shift in 3.0..1e3_f64,
    ) {
        let (structure, dimension) = if second {
            (Structure::SecondOrder { is_leaf: is_leaf.clone() }, 2 * N)
        } else {
            (Structure::FirstOrder, N)
        };
        let mut jacobian = Jacobian::new(&structure, dimension);
        let mut matrix = DMatrix::identity(dimension, dimension) * shift;
        let first = dimension - N;
        let Jacobian { position, rate, .. } = &mut jacobian;
        for (k, &value) in entries.iter().enumerate() {
            let (row, column) = (k / N % N, k % N);
            let joins_leaves = second && row != column && is_leaf[row] && is_leaf[column];
            if k < N * N {
                rate.add(row, column, value);
                if !joins_leaves {
                    matrix[(first + row, first + column)] -= value;
                }
            } else if let Some(position) = position {
                position.add(row, column, value);
                if !joins_leaves {
                    matrix[(first + row, column)] -= value;
                }
            }
        }
        for k in 0..first {
            matrix[(k, first + k)] -= 1.0;
        }
        let expected = matrix.lu().solve(&DVector::from_row_slice(&rhs[..dimension]));
        prop_assume!(jacobian.factor(shift) && expected.is_some());
        let mut x = rhs[..dimension].to_vec();
        jacobian.solve(&mut x);
        let expected = expected.expect("assumed");
        for (x, e) in x.iter().zip(expected.iter()) {
            // Leaves are not pivoted: digits are lost if one of them nearly vanishes.
            prop_assert!((x - e).abs() < 1e-9 * (1.0 + expected.amax()), "{x} {e}");
        }
    }
}

/// Entries are read back as written, none between two leaves, and scaled by the factor of their row.
#[test]
fn entries_and_rows() {
    let is_leaf = [false, true, false, true, true];
    let structure = Structure::SecondOrder {
        is_leaf: is_leaf.to_vec(),
    };
    let value = |row: usize, column: usize| (1 + 5 * row + column) as f64;
    let mut jacobian = Jacobian::new(&structure, 10);
    let position = jacobian.position.as_mut().expect("of second order");
    for (row, time) in jacobian.time.iter_mut().enumerate() {
        *time = -value(row, 0);
        for column in 0..5 {
            position.add(row, column, value(row, column));
            jacobian.rate.add(row, column, 2.0 * value(row, column));
        }
    }
    let factors = [2.0, 3.0, 5.0, 7.0, 11.0];
    for scaled in [false, true] {
        if scaled {
            jacobian.scale_rows(&factors);
        }
        for (row, factor) in factors.into_iter().enumerate() {
            let factor = if scaled { factor } else { 1.0 };
            assert_eq!(jacobian.time[row], -factor * value(row, 0));
            for column in 0..5 {
                let joins_leaves = row != column && is_leaf[row] && is_leaf[column];
                let share = if joins_leaves { 0.0 } else { factor };
                let wanted = share * value(row, column);
                let position = jacobian.position.as_ref().expect("of second order");
                assert_eq!(position.entry(row, column), wanted);
                assert_eq!(jacobian.rate.entry(row, column), 2.0 * wanted);
            }
        }
    }
}
