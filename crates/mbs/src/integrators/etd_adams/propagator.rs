//! The linear part of a system over a step: exact exponentials and the integrals of polynomials under them.
//!
//! ```text
//! x' = L x + g(t),    g(t + s h) = sum_k b_k s^k/k!
//! x(t + tau) = phi_0(tau L) x + tau sum_k (tau/h)^k phi_k+1(tau L) b_k,
//! phi_k(A) = sum_i A^i/(i + k)!,    phi_k = phi_k+1 A + I/k!
//! ```
//! The highest phi is a Taylor sum in Horner's form, the others follow by the recurrence [Hochbruck & Ostermann 2010, 2.1].
//! Steps with |tau| |L| up to 3 or so lose no digits, and those up to 12 five.

use serde::{Deserialize, Serialize};

use super::columns::{Columns, Factors, Predict};
use crate::jacobian::{Jacobian, Structure};

/// Taylor sums end where the next term is below this share of the first.
const ROUNDING: f64 = 1e-17;
/// And after so many terms at the latest.
const MOST_TERMS: usize = 60;

/// Backward differences become coefficients of powers: `s (s + 1) ... (s + j - 1)/j! = sum_k powers[j][k] s^k/k!`.
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

/// Differences at most.
pub(super) const MOST: usize = 9;
pub(super) const POWERS: [[f64; MOST]; MOST] = powers();

/// L, of systems of second order with the unit matrix in the first rows, which have no remainder g.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Linear {
    /// Of x.
    pub(super) dimension: usize,
    /// First row with a remainder.
    pub(super) first: usize,
    /// Rows from the first on.
    rows: Columns,
    /// What brings their entries to units in which all components are alike.
    alike: Columns,
    /// Bound of |L| in these units, in which positions and rates are alike too, 1/s.
    pub(super) size: f64,
}

impl Linear {
    /// `scale`: errors of the components that weigh alike.
    pub(super) fn new(structure: &Structure, scale: &[f64]) -> Self {
        let dimension = scale.len();
        let first = match structure {
            Structure::FirstOrder => 0,
            Structure::SecondOrder { is_leaf } => dimension - is_leaf.len(),
        };
        let rows = Columns::zero(dimension - first, dimension);
        let mut alike = rows.clone();
        for i in 0..dimension - first {
            for j in 0..dimension {
                // Of a position's row and column both are measured as positions, of a rate's both as rates.
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

    /// Length of a remainder.
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

    /// Largest difference of two, as a share of the larger one's entries, positions and rates apart.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let (mut moved, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (column, [alike, a, b]) in self.alike.beside([&self.rows, &other.rows]) {
            let kind = usize::from(column >= self.first);
            moved[kind] = moved[kind].max((a - b).abs() * alike);
            largest[kind] = largest[kind].max(a.abs().max(b.abs()) * alike);
        }
        // Rates count by what they do within an oscillation.
        let rates = moved[1] / self.size.max(largest[1]).max(f64::MIN_POSITIVE);
        rates.max(moved[0] / largest[0].max(f64::MIN_POSITIVE))
    }

    /// L x, rows with a remainder; padded.
    #[inline(always)]
    pub(super) fn product(&self, x: &[f64], out: &mut [f64]) {
        self.rows.multiply(0, &x[..self.dimension], out);
    }

    /// Its columns by a factor, rows with a remainder, one after the other.
    fn write_scaled(&self, factor: f64, out: &mut [f64]) {
        for (j, column) in out.chunks_exact_mut(self.remainders()).enumerate() {
            for (i, out) in column.iter_mut().enumerate() {
                *out = factor * self.rows.entry(i, j);
            }
        }
    }

    /// out = factor x L + diagonal, of square matrices; `scaled` is L by the factor.
    fn multiply(&self, factor: f64, scaled: &[f64], x: &Columns, diagonal: f64, out: &mut Columns) {
        for (j, weights) in scaled.chunks_exact(self.remainders()).enumerate() {
            // q' = v.
            let rate = j.checked_sub(self.first).filter(|_| self.first > 0);
            let one = rate.map(|k| (k, factor));
            out.set_sum(j, x, one, self.first, weights);
            *out.entry_mut(j, j) += diagonal;
        }
    }
}

/// What a time `tau` makes of a state and of a polynomial remainder.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Propagator {
    /// s; NaN: none.
    pub(super) tau: f64,
    /// Coefficients of the remainder, b_0 and so on.
    terms: usize,
    /// What multiplies x, then what multiplies b_0, b_1 and so on.
    matrix: Columns,
    /// phi_k+1 and phi_k: scratch.
    above: Columns,
    here: Columns,
    /// tau L: scratch.
    scaled: Vec<f64>,
}

impl Propagator {
    pub(super) fn new(linear: &Linear, terms: usize) -> Self {
        let n = linear.dimension;
        let square = Columns::zero(n, n);
        Self {
            tau: f64::NAN,
            terms,
            matrix: Columns::zero(n, n + terms * linear.remainders()),
            above: square.clone(),
            here: square,
            scaled: vec![0.0; n * linear.remainders()],
        }
    }

    /// Becomes that of `tau`, for polynomials in the time over `unit`.
    pub(super) fn build(&mut self, linear: &Linear, tau: f64, unit: f64) {
        let (n, first, count) = (linear.dimension, linear.first, linear.remainders());
        // 1/(i + terms)!, until |tau L|^i of them is nothing beside the first.
        let mut inverse = [0.0; MOST_TERMS];
        inverse[0] = (1..=self.terms).fold(1.0, |f, k| f / k as f64);
        let (mut size, mut used) = (1.0, 1);
        while used < MOST_TERMS && size > ROUNDING {
            inverse[used] = inverse[used - 1] / (used + self.terms) as f64;
            size *= linear.size * tau.abs() / (used + self.terms) as f64;
            used += 1;
        }
        linear.write_scaled(tau, &mut self.scaled);
        self.above.fill(0.0);
        for i in 0..n {
            *self.above.entry_mut(i, i) = inverse[used - 1];
        }
        for &diagonal in inverse[..used - 1].iter().rev() {
            linear.multiply(tau, &self.scaled, &self.above, diagonal, &mut self.here);
            std::mem::swap(&mut self.above, &mut self.here);
        }
        let mut factorial = (1..self.terms).fold(1.0, |f, k| f / k as f64);
        for k in (0..self.terms).rev() {
            // `above` is phi_k+1.
            let weight = tau * (tau / unit).powi(k as i32);
            for c in 0..count {
                let to = n + k * count + c;
                let one = Some((first + c, weight));
                self.matrix.set_sum(to, &self.above, one, 0, &[]);
            }
            linear.multiply(tau, &self.scaled, &self.above, factorial, &mut self.here);
            std::mem::swap(&mut self.above, &mut self.here);
            factorial *= k as f64;
        }
        for i in 0..n {
            self.matrix.set_sum(i, &self.above, Some((i, 1.0)), 0, &[]);
        }
        self.tau = tau;
    }

    /// From now on it is not the coefficients b_k that are known but backward differences at the distance of the unit:
    /// what multiplies the j-th of them is h Gamma_j.
    pub(super) fn take_differences(&mut self, linear: &Linear) {
        let (n, count) = (linear.dimension, linear.remainders());
        for j in (1..self.terms).rev() {
            for c in 0..count {
                let to = n + j * count + c;
                self.matrix.combine(to, &POWERS[j][..=j], n + c, count);
            }
        }
    }

    /// The state `tau` later: `known` holds x and then as many of what is known of the remainder as there are.
    pub(super) fn advance(&self, known: &[f64], x: &mut [f64]) {
        self.matrix.multiply(0, known, x);
    }

    /// What makes of the k-th difference `d` what its term alone does.
    pub(super) fn term<'a>(&'a self, linear: &Linear, k: usize, d: &'a [f64]) -> Factors<'a> {
        (&self.matrix, linear.dimension + k * d.len(), d)
    }

    /// [`advance`](Self::advance), and then L of the state without its line.
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

    /// out = what the term after the k-th does, less what the k-th does.
    pub(super) fn difference_of_terms(&self, linear: &Linear, k: usize, out: &mut Columns) {
        let (n, count) = (linear.dimension, linear.remainders());
        for c in 0..count {
            let at = n + k * count + c;
            out.set_sum(c, &self.matrix, Some((at + count, 1.0)), at, &[-1.0]);
        }
    }
}
