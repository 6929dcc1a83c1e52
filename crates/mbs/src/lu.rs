//! LU factors of a small dense matrix, in memory that is allocated once.

use serde::{Deserialize, Serialize};

/// Returns the scalar product of two vectors.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Factorisation P A = L U with the largest pivot of each column.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Lu {
    n: usize,
    /// Matrix A, row by row, then both factors.
    entries: Vec<f64>,
    /// Inverses of the pivots.
    inverse: Vec<f64>,
    /// Row that was swapped to each place.
    swaps: Vec<usize>,
}

impl Lu {
    /// Creates an `n` x `n` matrix of zeros.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            entries: vec![0.0; n * n],
            inverse: vec![0.0; n],
            swaps: vec![0; n],
        }
    }

    /// Returns the entries of A, row by row, to be written before [`factor`](Self::factor).
    pub fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Factors the matrix. Returns false if it is singular or not finite.
    pub fn factor(&mut self) -> bool {
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
    pub fn solve(&self, x: &mut [f64]) {
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
