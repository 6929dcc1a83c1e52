//! LU factors of a small dense matrix, in memory that is allocated once.

use serde::{Deserialize, Serialize};

/// Returns the scalar product of two vectors.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// P A = L U with the largest pivot of each column.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Lu {
    n: usize,
    /// A, row by row, then both factors.
    entries: Vec<f64>,
    /// Inverses of the pivots.
    inverse: Vec<f64>,
    /// Row that came to each place.
    swaps: Vec<usize>,
}

impl Lu {
    pub(crate) fn new(n: usize) -> Self {
        Self {
            n,
            entries: vec![0.0; n * n],
            inverse: vec![0.0; n],
            swaps: vec![0; n],
        }
    }

    /// A, row by row, to be written before [`factor`](Self::factor).
    pub(crate) fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// False if the matrix is singular or not finite.
    pub(crate) fn factor(&mut self) -> bool {
        let n = self.n;
        for k in 0..n {
            let (mut best, mut largest) = (k, 0.0);
            for row in k..n {
                let size = self.entries[row * n + k].abs();
                if size > largest {
                    (best, largest) = (row, size);
                }
            }
            self.swaps[k] = best;
            let (head, tail) = self.entries.split_at_mut((k + 1) * n);
            let pivot_row = &mut head[k * n..];
            if best != k {
                let other = &mut tail[(best - k - 1) * n..][..n];
                pivot_row.swap_with_slice(other);
            }
            let inverse = pivot_row[k].recip();
            if !(largest > 0.0 && inverse.is_finite() && inverse != 0.0) {
                return false;
            }
            self.inverse[k] = inverse;
            for row in tail.chunks_exact_mut(n) {
                let factor = row[k] * inverse;
                row[k] = factor;
                if factor != 0.0 {
                    for (x, p) in row[k + 1..].iter_mut().zip(&pivot_row[k + 1..]) {
                        *x -= factor * p;
                    }
                }
            }
        }
        true
    }

    /// Overwrites `x` (the right-hand side) with the solution.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let n = self.n;
        for (k, &swap) in self.swaps.iter().enumerate() {
            x.swap(k, swap);
        }
        for k in 1..n {
            let row = &self.entries[k * n..k * n + k];
            x[k] -= dot(row, x);
        }
        for k in (0..n).rev() {
            let row = &self.entries[k * n + k + 1..(k + 1) * n];
            x[k] = (x[k] - dot(row, &x[k + 1..])) * self.inverse[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    use super::*;

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
}
