//! Newton matrix of sliding contacts: a positive diagonal plus positive rank-one terms, in which no entry joins two leaves.

use super::contact::Row;
use crate::jacobian::Jacobian;

/// Matrix H with memory for its factorisation.
#[derive(Debug, Clone)]
pub struct Arrowhead {
    /// System s I - D with s = 0 and D = -H.
    system: Jacobian,
}

impl Arrowhead {
    /// Creates a matrix for as many velocities as `is_leaf` has entries.
    pub fn new(is_leaf: &[bool]) -> Self {
        Self {
            system: Jacobian::of(is_leaf, false),
        }
    }

    /// Returns the number of velocities.
    pub fn dimension(&self) -> usize {
        self.system.rate.dimension()
    }

    /// Sets H = diag(`inertia`).
    pub fn reset(&mut self, inertia: &[f64]) {
        self.system.rate.clear();
        for (k, &m) in inertia.iter().enumerate() {
            self.system.rate.add(k, k, -m);
        }
    }

    /// Adds a term: H += weight row row'. Returns false if the row joins two leaves, as H is then no arrowhead.
    #[inline]
    pub fn add(&mut self, weight: f64, row: &Row) -> bool {
        let rate = &mut self.system.rate;
        if row.entries().filter(|(k, _)| rate.is_leaf(*k)).count() > 1 {
            return false;
        }
        for (i, c) in row.entries() {
            for (k, d) in row.entries() {
                rate.add(i, k, -weight * c * d);
            }
        }
        true
    }

    /// Overwrites `x` (the right-hand side) with the solution of H x = rhs; NaN without a solution.
    pub fn solve(&mut self, x: &mut [f64]) {
        match self.system.factor(0.0) {
            true => self.system.solve(x),
            false => x.fill(f64::NAN),
        }
    }
}
