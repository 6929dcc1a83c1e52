//! The linear part of a system over a step: exact exponentials and the integrals of polynomials under them.
//!
//! ```text
//! x' = L x + g(t),    g(t + s h) = sum_k b_k s^k/k!
//! x(t + tau) = phi_0(tau L) x + tau sum_k (tau/h)^k phi_k+1(tau L) b_k,
//! phi_k(A) = sum_i A^i/(i + k)!,    phi_k = A phi_k+1 + I/k!
//! ```
//! The highest phi is a Taylor sum in Horner's form, the others follow by the recurrence [Hochbruck & Ostermann 2010, 2.1].
//! Steps with |tau| |L| up to 3 or so lose no digits, and methods take no longer ones.

use serde::{Deserialize, Serialize};

use crate::jacobian::{Jacobian, Structure};

/// Taylor sums end where the next term is below this share of the first.
const ROUNDING: f64 = 1e-17;
/// And after so many terms at the latest.
const MOST_TERMS: usize = 60;

/// L, of systems of second order with the unit matrix in the first rows, which have no remainder g.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Linear {
    /// Of x.
    pub(super) dimension: usize,
    /// First row with a remainder.
    pub(super) first: usize,
    /// Rows from the first on.
    rows: Vec<f64>,
    /// Bound of |L| in units in which positions and rates are alike, 1/s.
    pub(super) size: f64,
}

impl Linear {
    pub(super) fn new(structure: &Structure, dimension: usize) -> Self {
        let first = match structure {
            Structure::FirstOrder => 0,
            Structure::SecondOrder { is_leaf } => dimension - is_leaf.len(),
        };
        Self {
            dimension,
            first,
            rows: vec![0.0; dimension * (dimension - first)],
            size: 0.0,
        }
    }

    /// Length of a remainder.
    pub(super) fn remainders(&self) -> usize {
        self.dimension - self.first
    }

    pub(super) fn read(&mut self, jacobian: &Jacobian) {
        let (first, count) = (self.first, self.remainders());
        let (mut stiffest, mut quickest): (f64, f64) = (0.0, 0.0);
        for (i, row) in self.rows.chunks_exact_mut(self.dimension).enumerate() {
            let (positions, rates) = row.split_at_mut(first);
            for (j, entry) in positions.iter_mut().enumerate() {
                *entry = jacobian.position().map_or(0.0, |k| k.entry(i, j));
            }
            for (j, entry) in rates.iter_mut().enumerate().take(count) {
                *entry = jacobian.rate().entry(i, j);
            }
            stiffest = stiffest.max(positions.iter().map(|x| x.abs()).sum());
            quickest = quickest.max(rates.iter().map(|x| x.abs()).sum());
        }
        self.size = stiffest.sqrt() + quickest;
    }

    /// Largest difference of two, as a share of the larger one's entries, positions and rates apart.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let (mut moved, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (k, (a, b)) in self.rows.iter().zip(&other.rows).enumerate() {
            let kind = usize::from(k % self.dimension >= self.first);
            moved[kind] = moved[kind].max((a - b).abs());
            largest[kind] = largest[kind].max(a.abs()).max(b.abs());
        }
        // Rates count by what they do within an oscillation.
        let rates = moved[1] / self.size.max(largest[1]).max(f64::MIN_POSITIVE);
        rates.max(moved[0] / largest[0].max(f64::MIN_POSITIVE))
    }

    /// Row `i` of L x, of those with a remainder.
    #[inline]
    pub(super) fn product(&self, i: usize, x: &[f64]) -> f64 {
        let n = self.dimension;
        dot(&self.rows[i * n..(i + 1) * n], x)
    }

    /// out = factor L x + diagonal, of square matrices.
    fn multiply(&self, factor: f64, x: &[f64], diagonal: f64, out: &mut [f64]) {
        let n = self.dimension;
        for (i, out) in out.chunks_exact_mut(n).enumerate() {
            match i.checked_sub(self.first) {
                // q' = v.
                None => {
                    let row = &x[(self.first + i) * n..(self.first + i + 1) * n];
                    for (out, x) in out.iter_mut().zip(row) {
                        *out = factor * x;
                    }
                }
                Some(i) => {
                    out.fill(0.0);
                    for (l, x) in self.rows[i * n..(i + 1) * n].iter().zip(x.chunks_exact(n)) {
                        let l = factor * l;
                        for (out, x) in out.iter_mut().zip(x) {
                            *out += l * x;
                        }
                    }
                }
            }
            out[i] += diagonal;
        }
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What a time `tau` makes of a state and of a polynomial remainder.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Propagator {
    /// s; NaN: none.
    pub(super) tau: f64,
    /// Coefficients of the remainder, b_0 and so on.
    pub(super) terms: usize,
    /// By row: what multiplies x, then what multiplies b_0, b_1 and so on.
    rows: Vec<f64>,
    /// phi_k+1 and phi_k: scratch.
    above: Vec<f64>,
    here: Vec<f64>,
}

impl Propagator {
    pub(super) fn new(linear: &Linear, terms: usize) -> Self {
        let n = linear.dimension;
        Self {
            tau: f64::NAN,
            terms,
            rows: vec![0.0; n * (n + terms * linear.remainders())],
            above: vec![0.0; n * n],
            here: vec![0.0; n * n],
        }
    }

    fn width(&self, linear: &Linear) -> usize {
        linear.dimension + self.terms * linear.remainders()
    }

    /// Becomes that of `tau`, for polynomials in the time over `unit`.
    pub(super) fn build(&mut self, linear: &Linear, tau: f64, unit: f64) {
        let (n, first, count) = (linear.dimension, linear.first, linear.remainders());
        let width = self.width(linear);
        // 1/(i + terms)!, until |tau L|^i of them is nothing beside the first.
        let mut inverse = [0.0; MOST_TERMS];
        inverse[0] = (1..=self.terms).fold(1.0, |f, k| f / k as f64);
        let (mut size, mut used) = (1.0, 1);
        while used < MOST_TERMS && size > ROUNDING {
            inverse[used] = inverse[used - 1] / (used + self.terms) as f64;
            size *= linear.size * tau.abs() / (used + self.terms) as f64;
            used += 1;
        }
        self.above.fill(0.0);
        for i in 0..n {
            self.above[i * n + i] = inverse[used - 1];
        }
        for &diagonal in inverse[..used - 1].iter().rev() {
            linear.multiply(tau, &self.above, diagonal, &mut self.here);
            std::mem::swap(&mut self.above, &mut self.here);
        }
        let mut factorial = (1..self.terms).fold(1.0, |f, k| f / k as f64);
        for k in (0..self.terms).rev() {
            // `above` is phi_k+1.
            let weight = tau * (tau / unit).powi(k as i32);
            let at = n + k * count;
            for i in 0..n {
                let from = &self.above[i * n + first..(i + 1) * n];
                let to = &mut self.rows[i * width + at..][..count];
                for (to, from) in to.iter_mut().zip(from) {
                    *to = weight * from;
                }
            }
            linear.multiply(tau, &self.above, factorial, &mut self.here);
            std::mem::swap(&mut self.above, &mut self.here);
            factorial *= k as f64;
        }
        for i in 0..n {
            self.rows[i * width..][..n].copy_from_slice(&self.above[i * n..(i + 1) * n]);
        }
        self.tau = tau;
    }

    /// The state `tau` later: `known` holds x and then as many coefficients of the remainder as there are.
    #[inline]
    pub(super) fn advance(&self, linear: &Linear, known: &[f64], x: &mut [f64]) {
        let width = self.width(linear);
        for (row, x) in self.rows.chunks_exact(width).zip(x) {
            *x = dot(row, known);
        }
    }

    /// Adds to a matrix of states by remainders: `factor` times what b_k does.
    pub(super) fn add_term(&self, linear: &Linear, k: usize, factor: f64, out: &mut [f64]) {
        let (width, count) = (self.width(linear), linear.remainders());
        let at = linear.dimension + k * count;
        for (row, out) in self
            .rows
            .chunks_exact(width)
            .zip(out.chunks_exact_mut(count))
        {
            for (out, x) in out.iter_mut().zip(&row[at..at + count]) {
                *out += factor * x;
            }
        }
    }
}
