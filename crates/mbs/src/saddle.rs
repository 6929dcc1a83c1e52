//! Saddle-point system (Eq. 2), solved by its Schur complement.
//!
//! ```text
//! [ M  D' ] [ a  ]   [ F     ]
//! [ D  0  ] [ mu ] = [ gamma ]      with mu = -lambda
//!
//! -D W D' mu = gamma - D W F,   a = W (F - D' mu),   W = M^-1
//! ```
//!
//! W is block-diagonal, and the complement -D W D' is negative definite if D has full rank. It is factored by blocks of
//! constraints as L Delta L'. Blocks are 3 x 3, with identity in the unused rows and columns: one code path without branches.
//!
//! D can lose rank in single poses of a mechanism with loops (all rods of a parallelogram on one line). The pivot of a
//! constraint then has an eigenvalue of the size of rounding errors. [`Dependent`] selects the treatment: an error, so that the
//! caller can evaluate a neighbouring pose, or omission of that direction, which gives the least solution of the remaining
//! equations.
//!
//! Bodies held by one revolute on their carrier or on the ground are eliminated before and in closed form ([`pinned`]). A gear
//! has no others. The constraints of linkages are eliminated in the order of least degree: chains have no fill.

mod pinned;

use nalgebra::{Matrix3, Vector3};

use crate::mechanism::{Mechanism, MechanismError};
use crate::state::Wrench;
use crate::tree::Arms;
use pinned::{Pinned, Rest};

/// Singularity threshold of a constraint's pivot: smallest eigenvalue relative to the pivot before the elimination. Rounding
/// errors are about 1e-16. The eigenvalue is the square of a small angle, so 1e-12 is an angle of 1e-6 rad.
const SINGULAR: f64 = 1e-12;

/// Treatment of a constraint that depends on others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dependent {
    /// The factorisation fails and names the constraint.
    Refuse,
    /// The constraint's dependent directions are dropped, with multipliers of 0.
    Drop,
}

/// Factored system.
#[derive(Debug, Clone)]
pub struct SaddlePoint {
    pinned: Pinned,
    rest: Rest,
    /// Right-hand sides, then solutions, of all bodies and all constraints.
    values: [Vec<Vector3<f64>>; 2],
    /// W of the bodies that are left.
    inverse: Vec<Matrix3<f64>>,
    /// D of the constraints that are left, for their child and their parent.
    rows: Vec<[Matrix3<f64>; 2]>,
    /// Rows of L below the diagonal of each column.
    below: Vec<Vec<usize>>,
    /// Lower triangle of the complement, row by row; after `factor` L, with the inverse of Delta on the diagonal. Only the
    /// blocks of `below` and the diagonal are used.
    lower: Vec<Matrix3<f64>>,
}

/// Returns the place of a block in the lower triangle.
const fn place(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

impl SaddlePoint {
    /// Creates the system of a mechanism; constraints are its revolutes, then its drivers.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (pinned, mut rest) = Pinned::new(mechanism);
        let below = rest.order();
        let count = rest.constraints.len();
        Self {
            values: [
                vec![Vector3::zeros(); mechanism.bodies.len()],
                vec![Vector3::zeros(); mechanism.revolutes.len() + mechanism.drivers.len()],
            ],
            inverse: vec![Matrix3::zeros(); rest.bodies.len()],
            rows: vec![[Matrix3::zeros(); 2]; count],
            lower: vec![Matrix3::zeros(); place(count, 0)],
            below,
            pinned,
            rest,
        }
    }

    /// Returns the number of 3 x 3 blocks of the complement, 0 if all bodies are eliminated in closed form.
    pub fn blocks(&self) -> usize {
        self.lower.len()
    }

    /// Assembles M and the rows of D with the revolutes' `arms`, and factors the system:
    ///
    /// ```text
    /// D_parent = [-1 0 s_y; 0 -1 -s_x],   D_child = [1 0 -s_y; 0 1 s_x];   of a driver [0 0 -1] and [0 0 1]
    /// ```
    ///
    /// # Errors
    /// Fails with the index of the first constraint that depends on the others, if these are refused.
    pub(crate) fn factor(&mut self, dependent: Dependent, arms: &[Arms]) -> Result<(), usize> {
        self.pinned.place(arms);
        for (inverse, &body) in self.inverse.iter_mut().zip(&self.rest.bodies) {
            let matrix = self.pinned.inertia[body].matrix();
            *inverse = matrix.try_inverse().unwrap_or_default();
        }
        for (rows, &c) in self.rows.iter_mut().zip(&self.rest.constraints) {
            let of = |arm: Option<[f64; 2]>| match arm {
                Some([x, y]) => Matrix3::new(1.0, 0.0, -y, 0.0, 1.0, x, 0.0, 0.0, 0.0),
                None => Matrix3::new(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            };
            let arms = arms.get(c);
            let parent = of(arms.map(|arms| arms.parent));
            *rows = [of(arms.map(|arms| arms.child)), -parent];
        }
        for column in 0..self.rows.len() {
            self.lower[place(column, column)] = self.complement(column, column);
            for &row in &self.below[column] {
                self.lower[place(row, column)] = self.complement(row, column);
            }
        }
        self.eliminate(dependent)
    }

    /// Returns a block of the complement.
    fn complement(&self, row: usize, column: usize) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for (&one, by_one) in self.rest.ends[row].iter().zip(&self.rows[row]) {
            for (&other, by_other) in self.rest.ends[column].iter().zip(&self.rows[column]) {
                if let Some(body) = one.filter(|_| one == other) {
                    sum -= by_one * self.inverse[body] * by_other.transpose();
                }
            }
        }
        if row == column {
            for unused in self.size(row)..3 {
                sum[(unused, unused)] = 1.0;
            }
        }
        sum
    }

    /// Returns the number of equations of a constraint.
    fn size(&self, constraint: usize) -> usize {
        match self.rest.constraints[constraint] < self.rest.revolutes {
            true => 2,
            false => 1,
        }
    }

    fn eliminate(&mut self, dependent: Dependent) -> Result<(), usize> {
        let count = self.rows.len();
        let size = |block: &Matrix3<f64>| block[(0, 0)].abs().max(block[(1, 1)].abs());
        let diagonal = (0..count).map(|k| size(&self.lower[place(k, k)]));
        let least: Vec<f64> = diagonal.map(|size| SINGULAR * size).collect();
        for (k, least) in least.into_iter().enumerate() {
            let block = &self.lower[place(k, k)];
            let (inverse, regular) = constraint_inverse(block, self.size(k), least);
            if !regular && dependent == Dependent::Refuse {
                return Err(self.rest.constraints[k]);
            }
            self.lower[place(k, k)] = inverse;
            // From the last row on, because a row's update needs those before it unscaled.
            for (last, &row) in self.below[k].iter().enumerate().rev() {
                let scaled = self.lower[place(row, k)] * inverse;
                for &column in &self.below[k][..=last] {
                    let change = scaled * self.lower[place(column, k)].transpose();
                    self.lower[place(row, column)] -= change;
                }
                self.lower[place(row, k)] = scaled;
            }
        }
        Ok(())
    }

    /// Solves for the right-hand side in [`bodies`](Self::bodies) and [`constraints`](Self::constraints).
    pub fn solve(&mut self) {
        let [bodies, constraints] = &mut self.values;
        self.pinned.eliminate(bodies, constraints);
        self.solve_rest();
        let [bodies, constraints] = &mut self.values;
        self.pinned.finish(bodies, constraints);
    }

    /// Solves for the bodies and constraints that are not eliminated in closed form.
    fn solve_rest(&mut self) {
        let (rest, count, lower) = (&self.rest, self.rows.len(), &self.lower);
        let [bodies, constraints] = &mut self.values;
        let ends = |k: usize| rest.ends[k].iter().zip(&self.rows[k]);
        let of = |k: usize| rest.constraints[k];
        for k in 0..count {
            for (&end, rows) in ends(k) {
                if let Some(body) = end {
                    let free = self.inverse[body] * bodies[rest.bodies[body]];
                    constraints[of(k)] -= rows * free;
                }
            }
        }
        for k in 0..count {
            for &row in &self.below[k] {
                let change = lower[place(row, k)] * constraints[of(k)];
                constraints[of(row)] -= change;
            }
        }
        for k in (0..count).rev() {
            let mut value = lower[place(k, k)] * constraints[of(k)];
            for &row in &self.below[k] {
                value -= lower[place(row, k)].tr_mul(&constraints[of(row)]);
            }
            constraints[of(k)] = value;
            for (&end, rows) in ends(k) {
                if let Some(body) = end {
                    bodies[rest.bodies[body]] -= rows.tr_mul(&value);
                }
            }
        }
        for (inverse, &body) in self.inverse.iter().zip(&rest.bodies) {
            bodies[body] = inverse * bodies[body];
        }
    }

    /// Returns the right-hand sides of the bodies (their loads), after [`SaddlePoint::solve`] their accelerations.
    pub fn bodies(&mut self) -> &mut [Vector3<f64>] {
        &mut self.values[0]
    }

    /// Sets the loads as the right-hand side.
    #[inline]
    pub(crate) fn set_loads(&mut self, loads: &[Wrench]) {
        for (value, load) in self.values[0].iter_mut().zip(loads) {
            *value = Vector3::new(load.fx, load.fy, load.moment);
        }
    }

    /// Returns the right-hand sides gamma of the constraints (unused components must be 0), after the solution **minus** their
    /// multipliers.
    pub fn constraints(&mut self) -> &mut [Vector3<f64>] {
        &mut self.values[1]
    }
}

/// Returns the inverse of the upper left `size` x `size` part of a constraint's block (negative definite when regular), and
/// true if the magnitudes of all its eigenvalues exceed `least`. Directions with smaller eigenvalues are dropped; outside the
/// part the inverse is the identity.
#[inline]
pub fn constraint_inverse(m: &Matrix3<f64>, size: usize, least: f64) -> (Matrix3<f64>, bool) {
    let mut inverse = Matrix3::identity();
    if size == 1 {
        let a = m[(0, 0)];
        let regular = a.abs() > least;
        inverse[(0, 0)] = if regular { 1.0 / a } else { 0.0 };
        return (inverse, regular);
    }
    let (a, b, d) = (m[(0, 0)], m[(1, 0)], m[(1, 1)]);
    let determinant = a * d - b * b;
    let trace = a + d;
    // Eigenvalues x and y: x + y = trace, x y = determinant; the smaller is determinant/larger.
    let gap = (0.25 * (a - d) * (a - d) + b * b).sqrt();
    let larger = 0.5 * trace - gap; // the trace is negative
    if determinant.abs() > least * larger.abs() {
        let scale = 1.0 / determinant;
        inverse[(0, 0)] = d * scale;
        inverse[(1, 0)] = -b * scale;
        inverse[(0, 1)] = -b * scale;
        inverse[(1, 1)] = a * scale;
        return (inverse, true);
    }
    inverse[(0, 0)] = 0.0;
    inverse[(1, 1)] = 0.0;
    if larger.abs() > least {
        // (m - smaller I)/(larger - smaller) projects onto the direction of the larger eigenvalue.
        let smaller = trace - larger;
        let scale = 1.0 / (larger * (larger - smaller));
        inverse[(0, 0)] = (a - smaller) * scale;
        inverse[(1, 0)] = b * scale;
        inverse[(0, 1)] = b * scale;
        inverse[(1, 1)] = (d - smaller) * scale;
    }
    (inverse, false)
}

/// Converts the failing constraint's number to an error that names it.
pub(crate) fn redundant(mechanism: &Mechanism, constraint: usize) -> MechanismError {
    let revolutes = mechanism.revolutes.len();
    let constraint = if constraint < revolutes {
        format!("revolute {constraint}")
    } else {
        format!("driver {}", constraint - revolutes)
    };
    MechanismError::Redundant { constraint }
}
