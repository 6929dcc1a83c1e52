//! Newton matrix of sliding contacts and its solution.
//!
//! Velocities are *hubs* or *leaves*; no contact joins two leaves. With the hubs last,
//!
//! ```text
//! H = [ D  B' ]    D diagonal, one entry a leaf
//!     [ B  S  ]    S hubs x hubs
//! ```
//! Leaves are eliminated one by one and the Schur complement `S - B D^-1 B'` is factored by
//! Cholesky. H is a positive diagonal plus positive rank-one terms, so no pivoting is needed.

use super::contact::Row;
use crate::jacobian::Place;
use crate::lu::dot;

/// Arrowhead matrix with the places of its velocities and memory for one factorisation.
#[derive(Debug, Clone)]
pub struct Arrowhead {
    /// Place of each velocity among hubs or leaves.
    place: Vec<Place>,
    hubs: usize,
    /// Diagonal D of the leaves.
    leaf_diagonal: Vec<f64>,
    /// Border B', one row of hubs for each leaf.
    border: Vec<f64>,
    /// Hub block S, then its Cholesky factor (lower triangle, row major).
    hub: Vec<f64>,
    hub_rhs: Vec<f64>,
}

impl Arrowhead {
    /// Creates a matrix for as many velocities as `is_leaf` has entries.
    pub fn new(is_leaf: &[bool]) -> Self {
        let (place, hubs, leaves) = Place::all(is_leaf);
        Self {
            place,
            hubs,
            leaf_diagonal: vec![0.0; leaves],
            border: vec![0.0; leaves * hubs],
            hub: vec![0.0; hubs * hubs],
            hub_rhs: vec![0.0; hubs],
        }
    }

    /// Returns the number of velocities.
    pub fn dimension(&self) -> usize {
        self.place.len()
    }

    /// Sets H = diag(`inertia`).
    pub fn reset(&mut self, inertia: &[f64]) {
        self.border.fill(0.0);
        self.hub.fill(0.0);
        for (place, &m) in self.place.iter().zip(inertia) {
            match *place {
                Place::Hub(i) => self.hub[i * self.hubs + i] = m,
                Place::Leaf(l) => self.leaf_diagonal[l] = m,
            }
        }
    }

    /// Adds a term: H += weight row row'. Returns false if the row joins two leaves, as H is then no arrowhead.
    #[inline]
    pub fn add(&mut self, weight: f64, row: &Row) -> bool {
        let mut leaf = None;
        for (dof, c) in row.entries() {
            match self.place[dof] {
                Place::Leaf(l) if leaf.is_none() => {
                    leaf = Some((l, c));
                    self.leaf_diagonal[l] += weight * c * c;
                }
                Place::Leaf(_) => return false,
                Place::Hub(i) => {
                    for (other, d) in row.entries() {
                        if let Place::Hub(j) = self.place[other] {
                            self.hub[i * self.hubs + j] += weight * c * d;
                        }
                    }
                }
            }
        }
        if let Some((l, c)) = leaf {
            for (dof, d) in row.entries() {
                if let Place::Hub(i) = self.place[dof] {
                    self.border[l * self.hubs + i] += weight * c * d;
                }
            }
        }
        true
    }

    /// Overwrites `x` (the right-hand side) with the solution of H x = rhs; destroys H.
    pub fn solve(&mut self, x: &mut [f64]) {
        let m = self.hubs;
        for (place, &value) in self.place.iter().zip(x.iter()) {
            if let Place::Hub(i) = *place {
                self.hub_rhs[i] = value;
            }
        }
        for (place, &value) in self.place.iter().zip(x.iter()) {
            let Place::Leaf(l) = *place else { continue };
            let row = &self.border[l * m..(l + 1) * m];
            let inverse = 1.0 / self.leaf_diagonal[l];
            for i in 0..m {
                let factor = row[i] * inverse;
                if factor == 0.0 {
                    continue;
                }
                for (s, &b) in self.hub[i * m..=i * m + i].iter_mut().zip(row) {
                    *s -= factor * b;
                }
                self.hub_rhs[i] -= factor * value;
            }
        }
        self.solve_hubs();
        for (place, x) in self.place.iter().zip(x.iter_mut()) {
            match *place {
                Place::Hub(i) => *x = self.hub_rhs[i],
                Place::Leaf(l) => {
                    let row = &self.border[l * m..(l + 1) * m];
                    *x = (*x - dot(row, &self.hub_rhs)) / self.leaf_diagonal[l];
                }
            }
        }
    }

    /// Factors the lower triangle by Cholesky, then substitutes forwards and backwards.
    fn solve_hubs(&mut self) {
        let (m, l) = (self.hubs, &mut self.hub);
        for i in 0..m {
            for j in 0..=i {
                let (upper, row) = l.split_at_mut(i * m);
                let left = if j == i {
                    &row[..j]
                } else {
                    &upper[j * m..j * m + j]
                };
                let sum = row[j] - dot(left, row);
                row[j] = if j == i {
                    sum.sqrt()
                } else {
                    sum / upper[j * m + j]
                };
            }
        }
        let x = &mut self.hub_rhs;
        for i in 0..m {
            x[i] = (x[i] - dot(&l[i * m..i * m + i], x)) / l[i * m + i];
        }
        for i in (0..m).rev() {
            let known: f64 = (i + 1..m).map(|k| l[k * m + i] * x[k]).sum();
            x[i] = (x[i] - known) / l[i * m + i];
        }
    }
}
