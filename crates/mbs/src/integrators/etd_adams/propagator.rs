//! Effect of a system's linear part over a step: exact exponentials and the integrals of polynomials under them.
//!
//! ```text
//! x' = L x + g(t),    g(t + s h) = sum_k b_k s^k/k!
//! x(t + tau) = phi_0(tau L) x + tau sum_k (tau/h)^k phi_k+1(tau L) b_k,
//! phi_k(A) = sum_i A^i/(i + k)!,    phi_k = phi_k+1 A + I/k!
//! ```
//! The highest phi is a Taylor sum in Horner's form, the others follow by recurrence [Hochbruck & Ostermann 2010, 2.1]. For
//! positions q' = v above their rates, only the rows of the positions are summed: L phi = phi L, and the upper rows of L phi
//! are the lower ones of phi. Steps with |tau| |L| up to about 3 lose no digits, and those up to 12 five.

use serde::{Deserialize, Serialize};

use super::columns::{Columns, Factors, Predict, ROWS};
use crate::jacobian::{Jacobian, Structure};
use crate::lu::Lu;

/// Size of the next term, relative to the first, at which Taylor sums end.
const ROUNDING: f64 = 1e-17;
/// Largest number of terms of Taylor sums.
const MOST_TERMS: usize = 60;

/// Matrix from backward differences to coefficients of powers: `s (s + 1) ... (s + j - 1)/j! = sum_k powers[j][k] s^k/k!`.
const fn powers() -> [[f64; MOST]; MOST] {
    let mut out = [[0.0; MOST]; MOST];
    out[0][0] = 1.0;
    let mut j = 1;
    while j < MOST {
        // Times (s + j - 1)/j; s times s^k/k! is (k + 1) s^(k+1)/(k+1)!.
        let mut k = 0;
        while k < j {
            out[j][k] += out[j - 1][k] * (j - 1) as f64 / j as f64;
            out[j][k + 1] += out[j - 1][k] * (k + 1) as f64 / j as f64;
            k += 1;
        }
        j += 1;
    }
    out
}

/// Matrix from powers to backward differences: D^j of s^k/k! at 0, with D s^k/k! = - sum_i (-1)^i/i! s^(k - i)/(k - i)! for i
/// from 1 on.
const fn differences() -> [[f64; MOST]; MOST] {
    let mut out = [[0.0; MOST]; MOST];
    out[0][0] = 1.0;
    let mut j = 1;
    while j < MOST {
        let mut k = j;
        while k < MOST {
            let (mut i, mut weight) = (1, 1.0);
            while i <= k {
                out[j][k] += weight * out[j - 1][k - i];
                i += 1;
                weight /= -(i as f64);
            }
            k += 1;
        }
        j += 1;
    }
    out
}

/// Largest number of differences.
pub(super) const MOST: usize = 9;
pub(super) const DIFFERENCES: [[f64; MOST]; MOST] = differences();
pub(super) const POWERS: [[f64; MOST]; MOST] = powers();

/// Linear part L. Systems of second order have the unit matrix in the first rows, which have no remainder g.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Linear {
    /// Length of x.
    pub(super) dimension: usize,
    /// First row with a remainder.
    pub first: usize,
    /// Rows from the first on.
    pub rows: Columns,
    /// Factors that convert the entries to units in which all components have equal scales.
    alike: Columns,
    /// Bound of |L| in these units, with equal scales of positions and rates, 1/s.
    pub size: f64,
}

impl Linear {
    /// Creates a linear part of zeros. `scale`: scales of the components' errors.
    pub fn new(structure: &Structure, scale: &[f64]) -> Self {
        let dimension = scale.len();
        let first = match structure {
            Structure::FirstOrder => 0,
            Structure::SecondOrder { is_leaf } => dimension - is_leaf.len(),
        };
        let rows = Columns::zero(dimension - first, dimension);
        let mut alike = rows.clone();
        for i in 0..dimension - first {
            for j in 0..dimension {
                // Row and column of a position both have the scale of positions, those of a rate the scale of rates.
                let own = if j < first { i } else { first + i };
                *alike.entry_mut(i, j) = scale[j] / scale[own];
            }
        }
        Self {
            dimension,
            first,
            rows,
            alike,
            size: 0.0,
        }
    }

    /// Returns the length of a remainder.
    pub(super) fn remainders(&self) -> usize {
        self.dimension - self.first
    }

    pub(super) fn read(&mut self, jacobian: &Jacobian) {
        let first = self.first;
        let (mut stiffest, mut quickest): (f64, f64) = (0.0, 0.0);
        for i in 0..self.remainders() {
            let (mut stiff, mut quick) = (0.0, 0.0);
            for j in 0..self.dimension {
                let (sum, value) = match (j.checked_sub(first), &jacobian.position) {
                    (Some(j), _) => (&mut quick, jacobian.rate.entry(i, j)),
                    (None, Some(position)) => (&mut stiff, position.entry(i, j)),
                    (None, None) => (&mut stiff, 0.0),
                };
                *sum += value.abs() * self.alike.entry(i, j);
                *self.rows.entry_mut(i, j) = value;
            }
            stiffest = stiffest.max(stiff);
            quickest = quickest.max(quick);
        }
        self.size = stiffest.sqrt() + quickest;
    }

    /// Returns the largest difference of two linear parts, relative to the larger entries, with positions and rates separate.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let (mut moved, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (column, [alike, a, b]) in self.alike.beside([&self.rows, &other.rows]) {
            let kind = usize::from(column >= self.first);
            moved[kind] = moved[kind].max((a - b).abs() * alike);
            largest[kind] = largest[kind].max(a.abs().max(b.abs()) * alike);
        }
        // Rates count by their effect within an oscillation.
        let rates = moved[1] / self.size.max(largest[1]).max(f64::MIN_POSITIVE);
        rates.max(moved[0] / largest[0].max(f64::MIN_POSITIVE))
    }

    /// Writes L x, rows with a remainder; padded.
    #[inline(always)]
    pub(super) fn product(&self, x: &[f64], out: &mut [f64]) {
        self.rows.multiply(0, &x[..self.dimension], out);
    }

    /// Writes the columns multiplied by a factor, rows with a remainder, one after the other and padded.
    fn write_scaled(&self, factor: f64, out: &mut [[f64; ROWS]]) {
        let blocks = self.remainders().div_ceil(ROWS);
        for (j, column) in out.chunks_exact_mut(blocks).enumerate() {
            let column = column.as_flattened_mut();
            for (i, out) in column.iter_mut().take(self.remainders()).enumerate() {
                *out = factor * self.rows.entry(i, j);
            }
        }
    }

    /// Returns the number of rows of a function of L from which the others follow.
    fn upper(&self) -> usize {
        match self.first {
            0 => self.dimension,
            positions => positions,
        }
    }
}

/// Effect of a time step `tau` on a state and on a polynomial remainder.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Propagator {
    /// Time tau, s; NaN: none.
    pub(super) tau: f64,
    /// Number of differences of the remainder.
    terms: usize,
    /// Factors of x, then those of the differences of the remainder, from the 0th on.
    pub matrix: Columns,
    /// Scratch: upper rows of phi_k+1 and of phi_k, with the rates padded to a multiple of [`ROWS`] columns.
    above: Columns,
    here: Columns,
    /// Scaled matrix tau L: scratch.
    scaled: Vec<[f64; ROWS]>,
}

impl Propagator {
    /// Creates an empty propagator with capacity for `terms` differences.
    pub fn new(linear: &Linear, terms: usize) -> Self {
        let n = linear.dimension;
        let blocks = linear.remainders().div_ceil(ROWS);
        let upper = Columns::zero(linear.upper(), linear.first + blocks * ROWS);
        Self {
            tau: f64::NAN,
            terms,
            matrix: Columns::zero(n, n + terms * linear.remainders()),
            above: upper.clone(),
            here: upper,
            scaled: vec![[0.0; ROWS]; n * blocks],
        }
    }

    /// Builds the propagator of `tau` for a remainder given by its backward differences at a distance of `unit`. The factor of
    /// the j-th difference is h Gamma_j if both are h.
    pub fn build(&mut self, linear: &Linear, tau: f64, unit: f64) {
        pulp::Arch::new().dispatch(Build {
            to: self,
            linear,
            tau,
            unit,
        });
    }

    /// Computes `here` = `above` tau L.
    #[inline(always)]
    fn multiply(&mut self, first: usize) {
        self.above
            .multiply_wide(first, &self.scaled, self.tau, &mut self.here);
    }

    /// Writes columns `to`: `weight` times columns of phi_k+1 from `from` on. Their upper rows are `above`; `here` is phi_k+1
    /// tau L.
    #[inline(always)]
    fn write(&mut self, linear: &Linear, to: std::ops::Range<usize>, from: usize, weight: f64) {
        let lower = weight / self.tau;
        for (c, to) in to.enumerate() {
            let column = from + c;
            self.matrix.set_sum(to, &self.above, [(column, weight)]);
            self.matrix
                .write_below(to, linear.first, &self.here, column, lower);
        }
    }

    /// Computes the state `tau` later: `known` holds x and then the differences.
    pub fn advance(&self, known: &[f64], x: &mut [f64]) {
        self.matrix.multiply(0, known, x);
    }

    /// Factors the propagator's matrix of a state; false: it is singular.
    pub fn factor(&self, linear: &Linear, back: &mut Lu) -> bool {
        let n = linear.dimension;
        for (i, row) in back.entries_mut().chunks_exact_mut(n).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = self.matrix.entry(i, j);
            }
        }
        back.factor()
    }

    /// Computes the state `tau` earlier, for a remainder with the given differences.
    pub fn retreat(&self, back: &Lu, differences: &[f64], x: &mut [f64], out: &mut [f64]) {
        self.matrix.multiply(x.len(), differences, out);
        for (x, gained) in x.iter_mut().zip(out) {
            *x -= *gained;
        }
        back.solve(x);
    }

    /// Returns the factors for the effect of the k-th difference `d` alone.
    pub(super) fn term<'a>(&'a self, linear: &Linear, k: usize, d: &'a [f64]) -> Factors<'a> {
        (&self.matrix, linear.dimension + k * d.len(), d)
    }

    /// Prepares [`advance`](Self::advance) followed by L x, for a state less its line.
    pub(super) fn predict<'a>(
        &'a self,
        linear: &'a Linear,
        known: &'a [f64],
        x: &'a mut [f64],
        product: &'a mut [f64],
    ) -> Predict<'a> {
        Predict {
            matrix: &self.matrix,
            known,
            x,
            rows: &linear.rows,
            product,
        }
    }

    /// Computes `out`: the factors of term k + 1 less those of term k.
    pub(super) fn difference_of_terms(&self, linear: &Linear, k: usize, out: &mut Columns) {
        let (n, count) = (linear.dimension, linear.remainders());
        for c in 0..count {
            let at = n + k * count + c;
            out.set_sum(c, &self.matrix, [(at + count, 1.0), (at, -1.0)]);
        }
    }
}

/// Arguments of [`Propagator::build`], for the vector instructions of the processor.
struct Build<'a> {
    to: &'a mut Propagator,
    linear: &'a Linear,
    tau: f64,
    unit: f64,
}

impl pulp::WithSimd for Build<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self {
            to,
            linear,
            tau,
            unit,
        } = self;
        let (n, first, count, terms) = (
            linear.dimension,
            linear.first,
            linear.remainders(),
            to.terms,
        );
        // Coefficients 1/(i + terms)!, until |tau L|^i of them is negligible relative to the first.
        let mut inverse = [0.0; MOST_TERMS];
        inverse[0] = (1..=terms).fold(1.0, |f, k| f / k as f64);
        let (mut size, mut used) = (1.0, 1);
        while used < MOST_TERMS && size > ROUNDING {
            inverse[used] = inverse[used - 1] / (used + terms) as f64;
            size *= linear.size * tau.abs() / (used + terms) as f64;
            used += 1;
        }
        linear.write_scaled(tau, &mut to.scaled);
        to.tau = tau;
        to.above.fill(0.0);
        let upper = linear.upper();
        to.above.add_to_diagonal(upper, inverse[used - 1]);
        for &diagonal in inverse[..used - 1].iter().rev() {
            to.multiply(first);
            to.here.add_to_diagonal(upper, diagonal);
            std::mem::swap(&mut to.above, &mut to.here);
        }
        let mut factorial = (1..terms).fold(1.0, |f, k| f / k as f64);
        for k in (0..terms).rev() {
            // Here `above` is phi_k+1.
            to.multiply(first);
            let from = n + k * count;
            let weight = tau * (tau / unit).powi(k as i32);
            to.write(linear, from..from + count, first, weight);
            to.here.add_to_diagonal(upper, factorial);
            std::mem::swap(&mut to.above, &mut to.here);
            factorial *= k as f64;
        }
        to.multiply(first);
        to.write(linear, 0..n, 0, 1.0);
        // Factors of the coefficients b_k become factors of differences.
        for j in (1..terms).rev() {
            for c in 0..count {
                let column = n + j * count + c;
                to.matrix.combine(column, &POWERS[j][..=j], n + c, count);
            }
        }
    }
}
