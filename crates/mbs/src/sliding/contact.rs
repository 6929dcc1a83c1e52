//! Data of a touching pair, and its rates as functions of generalised velocities.

use crate::BodyId;

/// Contact of two bodies, with the data for an implicit treatment of its friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The two bodies; the normal points from the first into the second.
    pub bodies: [BodyId; 2],
    /// Point at which both forces act, ground frame, m.
    pub point: [f64; 2],
    /// Unit vector n from the first body into the second, ground frame. The tangent is R90 n.
    pub normal: [f64; 2],
    /// Normal force F_n >= 0, N: pushes the first body along -n.
    pub normal_force: f64,
    /// Coefficient of friction mu.
    pub coefficient: f64,
    /// Sliding speed at which friction reaches mu F_n, m/s.
    pub ramp: f64,
}

/// Rate that is linear in the generalised velocities: `offset + sum coefficients v`.
///
/// A contact of two bodies, one free in the plane and one carried by another, depends on five velocities at most.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Row {
    dofs: [u32; 5],
    coefficients: [f64; 5],
    count: u8,
    /// Contribution of driven bodies.
    pub offset: f64,
}

impl Row {
    /// Adds `coefficient` x velocity `dof`. At most five velocities; a sixth makes the row NaN.
    #[inline]
    pub fn push(&mut self, dof: usize, coefficient: f64) {
        for k in 0..usize::from(self.count) {
            if self.dofs[k] as usize == dof {
                self.coefficients[k] += coefficient;
                return;
            }
        }
        let k = usize::from(self.count);
        if k == self.dofs.len() {
            self.offset = f64::NAN;
            return;
        }
        self.dofs[k] = dof as u32;
        self.coefficients[k] = coefficient;
        self.count += 1;
    }

    /// Returns the (velocity, coefficient) pairs.
    #[inline]
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (0..usize::from(self.count)).map(|k| (self.dofs[k] as usize, self.coefficients[k]))
    }

    /// Returns the part that depends on the velocities.
    #[inline]
    pub fn dot(&self, v: &[f64]) -> f64 {
        self.entries().map(|(dof, c)| c * v[dof]).sum()
    }

    /// Returns the rate at `v`.
    #[inline]
    pub fn value(&self, v: &[f64]) -> f64 {
        self.offset + self.dot(v)
    }

    /// Adds a multiple of the row: `v += scale row`.
    #[inline]
    pub fn add_to(&self, scale: f64, v: &mut [f64]) {
        for (dof, c) in self.entries() {
            v[dof] += scale * c;
        }
    }
}
