//! Weighted sums of stages in registers, without a look-up of the stages at every component.

use std::array::from_fn;
use std::iter::zip;

/// Nonzero entries in a row of a tableau: (stage, weight).
pub(super) type Row = &'static [(usize, f64)];

/// Passes the weighted sum of stages of each of `n` components to `take`; `N` is the row's length.
#[inline(always)]
pub(super) fn each_sum<const N: usize>(
    row: Row,
    stages: &[Vec<f64>],
    n: usize,
    mut take: impl FnMut(usize, f64),
) {
    debug_assert_eq!(row.len(), N);
    let weights: [f64; N] = from_fn(|i| row[i].1);
    let stages: [&[f64]; N] = from_fn(|i| &stages[row[i].0][..n]);
    for c in 0..n {
        let sum = zip(weights, stages).map(|(w, stage)| w * stage[c]).sum();
        take(c, sum);
    }
}

/// Computes `out = y + h sum` for a row of one to twelve terms.
pub(super) fn set_sum(out: &mut [f64], y: &[f64], h: f64, row: Row, stages: &[Vec<f64>]) {
    type Set = fn(&mut [f64], &[f64], f64, Row, &[Vec<f64>]);
    const BY_LENGTH: [Set; 12] = [
        set::<1>, set::<2>, set::<3>, set::<4>, set::<5>, set::<6>, set::<7>, set::<8>, set::<9>,
        set::<10>, set::<11>, set::<12>,
    ];
    BY_LENGTH[row.len() - 1](out, y, h, row, stages);
}

/// Computes `out = h sum`. Not inlined: only for arguments the compiler assumes that `out` does not overlap the stages.
#[inline(never)]
pub(super) fn set_scaled<const N: usize>(out: &mut [f64], h: f64, row: Row, stages: &[Vec<f64>]) {
    each_sum::<N>(row, stages, out.len(), |c, sum| out[c] = h * sum);
}

fn set<const N: usize>(out: &mut [f64], y: &[f64], h: f64, row: Row, stages: &[Vec<f64>]) {
    let n = out.len();
    let y = &y[..n];
    each_sum::<N>(row, stages, n, |c, sum| out[c] = y[c] + h * sum);
}
