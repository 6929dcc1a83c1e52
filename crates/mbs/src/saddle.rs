//! Saddle-point system (Eq. 2), factored block by block.
//!
//! ```text
//! [ M  -D' ] [ a      ]   [ F     ]
//! [ D   0  ] [ lambda ] = [ gamma ]
//! ```
//! With mu = -lambda the system is symmetric indefinite: [M D'; D 0][a; mu] = [F; gamma]. Its graph has a node for each body (3
//! unknowns), revolute (2) and driver (1), and an edge wherever a constraint acts on a body. Nodes are eliminated in an order
//! of least degree first, which is determined once. A constraint's pivot is zero until one of its bodies is eliminated, so the
//! constraint has to wait:
//! * a joint of the spanning forest (and a driver across it) for its outer body; the rows so chosen
//!   are independent in any pose, because each has a body to itself;
//! * a joint that closes a loop for all bodies of the loop; its pivot is regular if D has full rank.
//!
//! D can lose rank in single poses of a mechanism with loops (all rods of a parallelogram on one line). The pivot of a closing
//! constraint then has an eigenvalue of the size of rounding errors. [`Dependent`] selects the treatment: an error, so that the
//! caller can evaluate a neighbouring pose, or omission of that direction, which gives the least solution of the remaining
//! equations.
//!
//! A forest has no fill: eliminating a leaf body and then its joint adds the leaf's inertia to its carrier, so the cost is
//! linear in the number of bodies. Only loops cause fill.
//!
//! Bodies held by one revolute on their carrier or on the ground are eliminated first and in closed form ([`pinned`]).
//!
//! Blocks are 3 x 3, with identity in the unused rows and columns of smaller nodes: one code path without branches, [George &
//! Liu 1981] on 3 x 3 blocks.

mod pinned;
mod symbolic;

use nalgebra::{Matrix3, Vector3};

use crate::mechanism::{Mechanism, MechanismError};
use crate::state::Wrench;
use crate::tree::Arms;
use pinned::Pinned;
use symbolic::{Below, Builder, Pivot, Target, Update, elimination_order, prerequisites};

/// Singularity threshold of a constraint's pivot: smallest eigenvalue relative to the largest change of the pivot during
/// elimination. Rounding errors are about 1e-16. The eigenvalue is the square of a small angle, so 1e-12 is an angle of 1e-6
/// rad.
const SINGULAR: f64 = 1e-12;

/// Treatment of a constraint that depends on others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dependent {
    /// The factorisation fails and names the constraint.
    Refuse,
    /// The constraint's dependent directions are dropped, with multipliers of 0.
    Drop,
}

/// Position of a constraint's Jacobian block for one body.
#[derive(Debug, Clone, Copy)]
struct Slot {
    block: usize,
    /// True if the body is eliminated after the constraint: the block is D' instead of D.
    transposed: bool,
}

/// Factored system; the symbolic part is computed once, the numbers at every evaluation.
#[derive(Debug, Clone)]
pub struct SaddlePoint {
    pinned: Pinned,
    /// Bodies and constraints that are not eliminated in closed form, by their numbers in the mechanism.
    left: [Vec<usize>; 2],
    /// Right-hand sides, then solutions, of all bodies and all constraints.
    values: [Vec<Vector3<f64>>; 2],
    bodies: usize,
    /// Unknowns of each node: 3, 2 or 1.
    sizes: Vec<usize>,
    slots: Vec<(Slot, Option<Slot>)>,
    pivots: Vec<Pivot>,
    below: Vec<Below>,
    updates: Vec<Update>,
    /// Diagonal blocks; after `factor` their inverses.
    diagonal: Vec<Matrix3<f64>>,
    /// Blocks below the diagonal; after `factor` the unit factor.
    lower: Vec<Matrix3<f64>>,
    scratch: Vec<Matrix3<f64>>,
    /// Largest change of each diagonal block so far, the reference for singular pivots.
    reference: Vec<f64>,
    /// Right-hand side, then solution, one vector for each node.
    unknowns: Vec<Vector3<f64>>,
}

impl SaddlePoint {
    /// Creates the symbolic elimination for the joints of `mechanism`; constraints are its revolutes, then its drivers.
    pub fn new(mechanism: &Mechanism) -> Self {
        let values = [
            vec![Vector3::zeros(); mechanism.bodies.len()],
            vec![Vector3::zeros(); mechanism.revolutes.len() + mechanism.drivers.len()],
        ];
        let (pinned, rest) = Pinned::new(mechanism);
        let mechanism = &rest.mechanism;
        let bodies = mechanism.bodies.len();
        let ends = mechanism.ends();
        let nodes = bodies + ends.len();
        let mut sizes = vec![3; bodies];
        sizes.extend(mechanism.revolutes.iter().map(|_| 2));
        sizes.extend(mechanism.drivers.iter().map(|_| 1));

        let order = elimination_order(bodies, &ends, &prerequisites(mechanism));
        let mut builder = Builder::new(nodes, &order);
        for (c, &(child, parent)) in ends.iter().enumerate() {
            builder.block(bodies + c, child);
            if let Some(parent) = parent {
                builder.block(bodies + c, parent);
            }
        }
        let (pivots, below, updates) = builder.eliminate(&order);
        let slots = ends
            .iter()
            .enumerate()
            .map(|(c, &(child, parent))| {
                let mut slot = |body: usize| Slot {
                    block: builder.block(bodies + c, body),
                    transposed: builder.position[body] > builder.position[bodies + c],
                };
                (slot(child), parent.map(&mut slot))
            })
            .collect();
        let widths = pivots.iter().map(|p| p.below.1 - p.below.0);
        let widest = widths.max().unwrap_or(0);
        Self {
            pinned,
            left: [rest.bodies, rest.constraints],
            values,
            bodies,
            sizes,
            slots,
            pivots,
            below,
            updates,
            diagonal: vec![Matrix3::zeros(); nodes],
            lower: vec![Matrix3::zeros(); builder.blocks.len()],
            scratch: vec![Matrix3::zeros(); widest],
            reference: vec![0.0; nodes],
            unknowns: vec![Vector3::zeros(); nodes],
        }
    }

    /// Returns the number of 3 x 3 blocks below the diagonal, fill included, without nodes eliminated in closed form.
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
        if self.left[0].is_empty() {
            return Ok(());
        }
        let (own, joints) = self.diagonal.split_at_mut(self.bodies);
        for (diagonal, &body) in own.iter_mut().zip(&self.left[0]) {
            *diagonal = self.pinned.inertia[body].matrix();
        }
        for (diagonal, &size) in joints.iter_mut().zip(&self.sizes[self.bodies..]) {
            *diagonal = Matrix3::zeros();
            for unused in size..3 {
                diagonal[(unused, unused)] = 1.0;
            }
        }
        self.lower.fill(Matrix3::zeros());
        for (&(child, parent), &c) in self.slots.iter().zip(&self.left[1]) {
            let mut put = |slot: Slot, sign: f64, arm: Option<[f64; 2]>| {
                let d = match arm {
                    Some([x, y]) => Matrix3::new(1.0, 0.0, -y, 0.0, 1.0, x, 0.0, 0.0, 0.0),
                    None => Matrix3::new(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
                };
                self.lower[slot.block] = sign * if slot.transposed { d.transpose() } else { d };
            };
            let arms = arms.get(c);
            put(child, 1.0, arms.map(|arms| arms.child));
            if let Some(parent) = parent {
                put(parent, -1.0, arms.map(|arms| arms.parent));
            }
        }
        self.reference.fill(0.0);
        self.eliminate(dependent)
    }

    fn eliminate(&mut self, dependent: Dependent) -> Result<(), usize> {
        for pivot in &self.pivots {
            let block = &self.diagonal[pivot.node];
            let inverse = match pivot.node.checked_sub(self.bodies) {
                None => symmetric_inverse(block),
                Some(constraint) => {
                    let size = self.sizes[pivot.node];
                    let least = SINGULAR * self.reference[pivot.node];
                    let (inverse, regular) = constraint_inverse(block, size, least);
                    if !regular && dependent == Dependent::Refuse {
                        return Err(self.left[1][constraint]);
                    }
                    inverse
                }
            };
            self.diagonal[pivot.node] = inverse;
            let below = &self.below[pivot.below.0..pivot.below.1];
            for (scaled, entry) in self.scratch.iter_mut().zip(below) {
                *scaled = self.lower[entry.block] * inverse;
            }
            for update in &self.updates[pivot.updates.0..pivot.updates.1] {
                let change =
                    self.scratch[update.row] * self.lower[below[update.column].block].transpose();
                match update.target {
                    Target::Diagonal(node) => {
                        let size = change[(0, 0)].abs().max(change[(1, 1)].abs());
                        self.reference[node] = self.reference[node].max(size);
                        self.diagonal[node] -= change;
                    }
                    Target::Block(block) => self.lower[block] -= change,
                }
            }
            for (scaled, entry) in self.scratch.iter().zip(below) {
                self.lower[entry.block] = *scaled;
            }
        }
        Ok(())
    }

    /// Solves for the right-hand side in [`bodies`](Self::bodies) and [`constraints`](Self::constraints).
    pub fn solve(&mut self) {
        let [bodies, constraints] = &mut self.values;
        self.pinned.eliminate(bodies, constraints);
        if !self.left[0].is_empty() {
            self.solve_rest();
        }
        let [bodies, constraints] = &mut self.values;
        self.pinned.finish(bodies, constraints);
    }

    /// Solves for the bodies and constraints that are not eliminated in closed form.
    fn solve_rest(&mut self) {
        let left = || self.left.iter().zip(&self.values);
        let known = left().flat_map(|(left, values)| left.iter().map(|&k| values[k]));
        for (unknown, known) in self.unknowns.iter_mut().zip(known) {
            *unknown = known;
        }
        for pivot in &self.pivots {
            let value = self.unknowns[pivot.node];
            for entry in &self.below[pivot.below.0..pivot.below.1] {
                self.unknowns[entry.node] -= self.lower[entry.block] * value;
            }
        }
        for pivot in self.pivots.iter().rev() {
            let mut value = self.diagonal[pivot.node] * self.unknowns[pivot.node];
            for entry in &self.below[pivot.below.0..pivot.below.1] {
                value -= self.lower[entry.block].tr_mul(&self.unknowns[entry.node]);
            }
            self.unknowns[pivot.node] = value;
        }
        let (own, joints) = self.unknowns.split_at(self.bodies);
        for ((values, left), scaled) in self.values.iter_mut().zip(&self.left).zip([own, joints]) {
            for (&k, &value) in left.iter().zip(scaled) {
                values[k] = value;
            }
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

/// Returns the inverse of the symmetric positive definite 3 x 3 block of a body: its inertia and that of the bodies it carries.
#[inline]
fn symmetric_inverse(m: &Matrix3<f64>) -> Matrix3<f64> {
    let (a, b, c) = (m[(0, 0)], m[(1, 0)], m[(2, 0)]);
    let (d, e, f) = (m[(1, 1)], m[(2, 1)], m[(2, 2)]);
    let (ca, cb, cc) = (d * f - e * e, c * e - b * f, b * e - c * d);
    let inverse = 1.0 / (a * ca + b * cb + c * cc);
    let (ia, ib, ic) = (ca * inverse, cb * inverse, cc * inverse);
    let (id, ie, iff) = (
        (a * f - c * c) * inverse,
        (b * c - a * e) * inverse,
        (a * d - b * b) * inverse,
    );
    Matrix3::new(ia, ib, ic, ib, id, ie, ic, ie, iff)
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
