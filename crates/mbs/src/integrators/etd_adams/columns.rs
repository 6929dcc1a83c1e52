//! Small dense matrices by columns: products with vectors as sums of columns.

use serde::{Deserialize, Serialize};

/// Number of rows summed in parallel. Each row's sum takes its columns in order, so that all processors round alike.
pub const ROWS: usize = 8;

/// Returns the length of a vector padded with 0 to full blocks.
pub fn padded(length: usize) -> usize {
    length.next_multiple_of(ROWS)
}

/// Writes one padded vector to another.
#[inline(always)]
pub(super) fn copy(from: &[f64], to: &mut [f64]) {
    let (from, to) = (from.as_chunks::<ROWS>().0, to.as_chunks_mut::<ROWS>().0);
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// Returns the sum of the squares of padded products.
#[inline(always)]
fn squares(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (a.as_chunks::<ROWS>().0, b.as_chunks::<ROWS>().0);
    let b = &b[..a.len()];
    let mut sums = [0.0; ROWS];
    for k in 0..a.len() {
        for i in 0..ROWS {
            let product = a[k][i] * b[k][i];
            sums[i] += product * product;
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Matrix by columns; rows are padded to blocks of [`ROWS`].
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Columns {
    columns: usize,
    /// Entries block by block, the columns of each block one after the other.
    entries: Vec<[f64; ROWS]>,
}

impl Columns {
    /// Creates a matrix of zeros.
    pub fn zero(rows: usize, columns: usize) -> Self {
        Self {
            columns,
            entries: vec![[0.0; ROWS]; rows.div_ceil(ROWS) * columns],
        }
    }

    pub(super) fn fill(&mut self, value: f64) {
        for block in &mut self.entries {
            *block = [value; ROWS];
        }
    }

    /// Returns the entry of a row and a column.
    #[inline(always)]
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        self.entries[row / ROWS * self.columns + column][row % ROWS]
    }

    /// Returns the entry of a row and a column, to be changed.
    #[inline(always)]
    pub fn entry_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[row / ROWS * self.columns + column][row % ROWS]
    }

    /// Returns every entry with those of two other matrices of equal size, and its column.
    pub(super) fn beside<'a>(
        &'a self,
        [a, b]: [&'a Self; 2],
    ) -> impl Iterator<Item = (usize, [f64; 3])> + 'a {
        let others = a.entries.iter().zip(&b.entries);
        let blocks = self.entries.iter().zip(others).enumerate();
        blocks.flat_map(move |(k, (own, (a, b)))| {
            let all = own.iter().zip(a).zip(b);
            all.map(move |((&own, &a), &b)| (k % self.columns, [own, a, b]))
        })
    }

    /// Computes `out`, padded: the columns from `first` on, as many as x has entries, times x.
    #[inline(always)]
    pub fn multiply(&self, first: usize, x: &[f64], out: &mut [f64]) {
        let out = out.as_chunks_mut::<ROWS>().0;
        // No zipped iterators: the compiler may leave them outside of the function with the vector instructions.
        for (b, out) in out.iter_mut().enumerate() {
            let columns = &self.entries[b * self.columns + first..][..x.len()];
            let mut sums = [0.0; ROWS];
            for k in 0..x.len() {
                for i in 0..ROWS {
                    sums[i] += x[k] * columns[k][i];
                }
            }
            *out = sums;
        }
    }

    /// Sets the first columns of `out` to this matrix' columns from `first` on, in full blocks, times the matrix with the
    /// columns `right`. If `first` is not 0, adds this matrix' first columns times `factor` to the columns of `out` from
    /// `first` on.
    #[inline(always)]
    pub(super) fn multiply_wide(
        &self,
        first: usize,
        right: &[[f64; ROWS]],
        factor: f64,
        out: &mut Self,
    ) {
        let blocks = (self.columns - first) / ROWS;
        for b in 0..self.entries.len() / self.columns {
            let own = &self.entries[b * self.columns..][..self.columns];
            let out = &mut out.entries[b * self.columns..][..right.len() / blocks];
            let last = own[first..].as_chunks::<ROWS>().0;
            for j in 0..out.len() {
                let mut sums = [0.0; ROWS];
                if first > 0 && j >= first {
                    add(&mut sums, factor, &own[j - first]);
                }
                for c in 0..blocks {
                    for k in 0..ROWS {
                        add(&mut sums, right[j * blocks + c][k], &last[c][k]);
                    }
                }
                out[j] = sums;
            }
        }
    }

    /// Sets column `to` to the weighted sum of columns of another matrix, in the rows of that matrix.
    #[inline(always)]
    pub(super) fn set_sum<const N: usize>(
        &mut self,
        to: usize,
        other: &Self,
        columns: [(usize, f64); N],
    ) {
        for b in 0..other.entries.len() / other.columns {
            let mut sums = [0.0; ROWS];
            for (column, factor) in columns {
                add(
                    &mut sums,
                    factor,
                    &other.entries[b * other.columns + column],
                );
            }
            self.entries[b * self.columns + to] = sums;
        }
    }

    /// Adds `value` to the first `count` diagonal entries.
    #[inline(always)]
    pub(super) fn add_to_diagonal(&mut self, count: usize, value: f64) {
        for i in 0..count {
            *self.entry_mut(i, i) += value;
        }
    }

    /// Sets rows of column `to` from `row` on to `factor` times the first `row` entries of a column of another matrix.
    #[inline(always)]
    pub(super) fn write_below(
        &mut self,
        to: usize,
        row: usize,
        other: &Self,
        column: usize,
        factor: f64,
    ) {
        for b in 0..row.div_ceil(ROWS) {
            let block = other.entries[b * other.columns + column];
            for (i, entry) in block.iter().take(row - b * ROWS).enumerate() {
                *self.entry_mut(row + b * ROWS + i, to) = factor * entry;
            }
        }
    }

    /// Sets column `to` to the sum of weights[k] times column `from` + k `step`.
    #[inline(always)]
    pub(super) fn combine(&mut self, to: usize, weights: &[f64], from: usize, step: usize) {
        for b in 0..self.entries.len() / self.columns {
            let block = &mut self.entries[b * self.columns..][..self.columns];
            let mut sums = [0.0; ROWS];
            for k in 0..weights.len() {
                add(&mut sums, weights[k], &block[from + k * step]);
            }
            block[to] = sums;
        }
    }
}

/// Adds a multiple of a column: sums += x column.
#[inline(always)]
fn add(sums: &mut [f64; ROWS], x: f64, column: &[f64; ROWS]) {
    for i in 0..ROWS {
        sums[i] += x * column[i];
    }
}

/// Computes x = matrix known, then product = rows x, with the processor's vector instructions. Here and in [`Judge`] no product
/// is fused with a sum, so that all processors round alike.
pub(super) struct Predict<'a> {
    pub(super) matrix: &'a Columns,
    pub(super) known: &'a [f64],
    pub(super) x: &'a mut [f64],
    pub(super) rows: &'a Columns,
    pub(super) product: &'a mut [f64],
}

impl pulp::WithSimd for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.matrix.multiply(0, self.known, self.x);
        let known = &self.x[..self.rows.columns];
        self.rows.multiply(0, known, self.product);
    }
}

/// Matrix, the first of its columns to use, and the vector to multiply them by.
pub(super) type Factors<'a> = (&'a Columns, usize, &'a [f64]);

/// Computes the sums of squares of weighted products, infinite for a missing factor; `out` is the last product.
pub(super) struct Judge<'a> {
    pub(super) factors: [Option<Factors<'a>>; 3],
    pub(super) weights: &'a [f64],
    pub(super) out: &'a mut [f64],
}

impl pulp::WithSimd for Judge<'_> {
    type Output = [f64; 3];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> [f64; 3] {
        let mut sums = [f64::INFINITY; 3];
        for (k, sum) in sums.iter_mut().enumerate() {
            if let Some((matrix, first, x)) = self.factors[k] {
                matrix.multiply(first, x, self.out);
                *sum = squares(self.out, self.weights);
            }
        }
        sums
    }
}
