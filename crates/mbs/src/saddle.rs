//! The saddle-point system (Eq. 2), factored block by block.
//!
//! ```text
//! [ M  -D' ] [ a      ]   [ F     ]
//! [ D   0  ] [ lambda ] = [ gamma ]
//! ```
//! With mu = -lambda it is symmetric indefinite: [M D'; D 0][a; mu] = [F; gamma]. Its graph has a
//! node for each body (3 unknowns), revolute (2) and driver (1), and an edge wherever a constraint
//! touches a body. Nodes are eliminated in an order found once, least degree first. A constraint's
//! pivot is zero until a body of its own is eliminated, so it waits:
//! * a joint of the spanning forest (and a driver across it) for its outer body; the rows so chosen
//!   are independent whatever the pose, because each has a body to itself;
//! * a joint that closes a loop for all bodies of the loop; its pivot is regular if D has full rank.
//!
//! D can lose rank in single poses of a mechanism with loops (all rods of a parallelogram on one line).
//! The pivot of a closing constraint then has a direction whose stretch is a rounding error of what was
//! subtracted to get there. [`Dependent`] says what to do: refuse, so that the caller can evaluate beside
//! the singular pose, or drop that direction, which gives the least solution of what is left.
//!
//! For a forest there is no fill: eliminating a leaf body and then its joint adds the leaf's inertia
//! to its carrier, so the cost is linear in the number of bodies. Loops cost the fill they need.
//!
//! Bodies that nothing but one revolute holds, at their centre of mass (sleeves, wheels), go first and in closed form. With m
//! and I theirs, D_p the revolute's rows for its parent, and the parent's rows of the system:
//!
//! ```text
//! a = gamma - D_p a_p,   mu = F - m a,   rotation: moment/I
//! (M_p + m D_p' D_p) a_p + ... = F_p - D_p' (F - m gamma)
//! ```
//!
//! Blocks are 3 x 3 with the unused rows and columns of smaller nodes held at identity, which
//! keeps one code path and no branches; this is [George & Liu 1981] on 3 x 3 blocks.

mod symbolic;

use nalgebra::{Matrix3, Vector3};

use crate::mechanism::{Mechanism, MechanismError, Revolute};
use symbolic::{Below, Builder, Pivot, Target, Update, elimination_order, prerequisites};

/// A constraint's pivot is singular if its smallest stretch falls below this share of the largest amount
/// that was added to or taken from it. Rounding leaves about 1e-16, and the stretch is the
/// square of a small angle, so 1e-12 is an angle of 1e-6 rad.
const SINGULAR: f64 = 1e-12;

/// What happens to a constraint that depends on others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dependent {
    /// The factorisation fails and names it.
    Refuse,
    /// Its dependent directions are dropped: their multipliers are 0.
    Drop,
}

/// Where a constraint's Jacobian part for one body goes.
#[derive(Debug, Clone, Copy)]
struct Slot {
    block: usize,
    /// The body is eliminated after the constraint: the block holds D' instead of D.
    transposed: bool,
}

/// Jacobian parts of one constraint: its rows of D for the child and, if there is one, the parent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows {
    pub(crate) child: Matrix3<f64>,
    pub(crate) parent: Matrix3<f64>,
}

/// A body held by one revolute, at its centre of mass.
#[derive(Debug, Clone)]
struct Leaf {
    body: usize,
    constraint: usize,
    /// Its carrier among the bodies that are left.
    parent: Option<usize>,
    mass: f64,
    moment: f64,
    /// The revolute's arm on the parent, m: `D_p = [-1 0 y; 0 -1 -x]`.
    arm: [f64; 2],
}

impl Leaf {
    /// D_p' v.
    #[inline]
    fn on_parent(&self, v: [f64; 2]) -> Vector3<f64> {
        let [x, y] = self.arm;
        Vector3::new(-v[0], -v[1], y * v[0] - x * v[1])
    }

    /// D_p a.
    #[inline]
    fn of_parent(&self, a: &Vector3<f64>) -> [f64; 2] {
        let [x, y] = self.arm;
        [y * a.z - a.x, -a.y - x * a.z]
    }
}

/// What closed forms take off a mechanism, and where the rest stands in it.
struct Trimmed {
    leaves: Vec<Leaf>,
    rest: Mechanism,
    bodies: Vec<usize>,
    constraints: Vec<usize>,
}

impl Trimmed {
    fn new(mechanism: &Mechanism) -> Self {
        let mut held = vec![0_u32; mechanism.bodies.len()];
        let joints = mechanism.revolutes.iter().map(|j| (j.child, j.parent));
        let drivers = mechanism.drivers.iter().map(|d| (d.child, d.parent));
        for (child, parent) in joints.chain(drivers) {
            held[child] += 1;
            if let Some(parent) = parent {
                held[parent] += 1;
            }
        }
        let is_leaf = |j: &Revolute| held[j.child] == 1 && j.child_point == [0.0; 2];
        let mut left = vec![true; held.len()];
        for joint in mechanism.revolutes.iter().filter(|j| is_leaf(j)) {
            left[joint.child] = false;
        }
        let bodies: Vec<usize> = (0..left.len()).filter(|&k| left[k]).collect();
        let place = |body: usize| bodies.partition_point(|&k| k < body);
        let (mut rest, mut leaves, mut constraints) = (mechanism.clone(), Vec::new(), Vec::new());
        rest.bodies = bodies
            .iter()
            .map(|&k| mechanism.bodies[k].clone())
            .collect();
        rest.revolutes.clear();
        for (constraint, joint) in mechanism.revolutes.iter().enumerate() {
            let parent = joint.parent.map(place);
            let body = &mechanism.bodies[joint.child];
            if left[joint.child] {
                constraints.push(constraint);
                rest.revolutes.push(Revolute {
                    parent,
                    child: place(joint.child),
                    ..*joint
                });
            } else {
                leaves.push(Leaf {
                    body: joint.child,
                    constraint,
                    parent,
                    mass: body.mass,
                    moment: body.moment,
                    arm: [0.0; 2],
                });
            }
        }
        for driver in &mut rest.drivers {
            (driver.parent, driver.child) = (driver.parent.map(place), place(driver.child));
        }
        let revolutes = mechanism.revolutes.len();
        constraints.extend((0..mechanism.drivers.len()).map(|k| revolutes + k));
        Self {
            leaves,
            rest,
            bodies,
            constraints,
        }
    }
}

/// The factored system: symbolic part made once, numbers replaced at every evaluation.
#[derive(Debug, Clone)]
pub struct SaddlePoint {
    leaves: Vec<Leaf>,
    /// The bodies and constraints that are left, by their numbers in the mechanism.
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
    mass: Vec<Matrix3<f64>>,
    /// Diagonal blocks; after `factor` their inverses.
    diagonal: Vec<Matrix3<f64>>,
    /// Blocks below the diagonal; after `factor` the unit factor.
    lower: Vec<Matrix3<f64>>,
    scratch: Vec<Matrix3<f64>>,
    /// Largest change of each diagonal block so far: what a singular pivot is small against.
    reference: Vec<f64>,
    /// Right-hand side, then solution, one vector a node.
    unknowns: Vec<Vector3<f64>>,
}

impl SaddlePoint {
    /// Symbolic elimination for the joints of `mechanism`; constraints are its revolutes, then its drivers.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let values = [
            vec![Vector3::zeros(); mechanism.bodies.len()],
            vec![Vector3::zeros(); mechanism.revolutes.len() + mechanism.drivers.len()],
        ];
        let trimmed = Trimmed::new(mechanism);
        let mechanism = &trimmed.rest;
        let bodies = mechanism.bodies.len();
        let ends: Vec<(usize, Option<usize>)> = mechanism
            .revolutes
            .iter()
            .map(|j| (j.child, j.parent))
            .chain(mechanism.drivers.iter().map(|d| (d.child, d.parent)))
            .collect();
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
        let widest = pivots
            .iter()
            .map(|p| p.below.1 - p.below.0)
            .max()
            .unwrap_or(0);
        let mass = mechanism
            .bodies
            .iter()
            .map(|b| Matrix3::from_diagonal(&Vector3::new(b.mass, b.mass, b.moment)))
            .collect();
        Self {
            leaves: trimmed.leaves,
            left: [trimmed.bodies, trimmed.constraints],
            values,
            bodies,
            sizes,
            slots,
            pivots,
            below,
            updates,
            mass,
            diagonal: vec![Matrix3::zeros(); nodes],
            lower: vec![Matrix3::zeros(); builder.blocks.len()],
            scratch: vec![Matrix3::zeros(); widest],
            reference: vec![0.0; nodes],
            unknowns: vec![Vector3::zeros(); nodes],
        }
    }

    /// Number of 3 x 3 blocks below the diagonal, fill included, of what closed forms leave.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.lower.len()
    }

    /// Puts M and the rows of D in place and factors. `rows(c)` gives constraint c.
    ///
    /// # Errors
    /// The index of the first constraint that depends on the others, if these are refused.
    pub(crate) fn factor(
        &mut self,
        dependent: Dependent,
        mut rows: impl FnMut(usize) -> Rows,
    ) -> Result<(), usize> {
        self.diagonal[..self.bodies].copy_from_slice(&self.mass);
        for (node, diagonal) in self.diagonal.iter_mut().enumerate().skip(self.bodies) {
            *diagonal = Matrix3::zeros();
            for unused in self.sizes[node]..3 {
                diagonal[(unused, unused)] = 1.0;
            }
        }
        for leaf in &mut self.leaves {
            let Some(parent) = leaf.parent else {
                continue;
            };
            let part = rows(leaf.constraint).parent;
            let (x, y, m) = (-part[(1, 2)], part[(0, 2)], leaf.mass);
            leaf.arm = [x, y];
            let block = &mut self.diagonal[parent];
            block[(0, 0)] += m;
            block[(1, 1)] += m;
            for (row, lever) in [(0, -y), (1, x)] {
                block[(row, 2)] += m * lever;
                block[(2, row)] += m * lever;
            }
            block[(2, 2)] += m * (x * x + y * y);
        }
        self.lower.fill(Matrix3::zeros());
        for (&(child, parent), &c) in self.slots.iter().zip(&self.left[1]) {
            let part = rows(c);
            let mut put = |slot: Slot, d: &Matrix3<f64>| {
                self.lower[slot.block] = if slot.transposed { d.transpose() } else { *d };
            };
            put(child, &part.child);
            if let Some(parent) = parent {
                put(parent, &part.parent);
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

    /// Solves for the right-hand side written through `rhs_body` and `rhs_constraint`.
    pub fn solve(&mut self) {
        let [bodies, constraints] = &mut self.values;
        let (own, joints) = self.unknowns.split_at_mut(self.bodies);
        for (unknown, &k) in own.iter_mut().zip(&self.left[0]) {
            *unknown = bodies[k];
        }
        for (unknown, &c) in joints.iter_mut().zip(&self.left[1]) {
            *unknown = constraints[c];
        }
        for leaf in &self.leaves {
            if let Some(parent) = leaf.parent {
                let (load, gamma) = (bodies[leaf.body], constraints[leaf.constraint]);
                own[parent] -=
                    leaf.on_parent([load.x - leaf.mass * gamma.x, load.y - leaf.mass * gamma.y]);
            }
        }
        self.solve_rest();
        let [bodies, constraints] = &mut self.values;
        let (own, joints) = self.unknowns.split_at(self.bodies);
        for leaf in &self.leaves {
            let (value, joint) = (&mut bodies[leaf.body], &mut constraints[leaf.constraint]);
            let mut a = [joint.x, joint.y];
            if let Some(parent) = leaf.parent {
                let carried = leaf.of_parent(&own[parent]);
                a = [a[0] - carried[0], a[1] - carried[1]];
            }
            *joint = Vector3::new(value.x - leaf.mass * a[0], value.y - leaf.mass * a[1], 0.0);
            *value = Vector3::new(a[0], a[1], value.z / leaf.moment);
        }
        for (unknown, &k) in own.iter().zip(&self.left[0]) {
            bodies[k] = *unknown;
        }
        for (unknown, &c) in joints.iter().zip(&self.left[1]) {
            constraints[c] = *unknown;
        }
    }

    /// The same of the bodies and constraints that are left.
    fn solve_rest(&mut self) {
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
    }

    /// Right-hand side of a body (its load), after [`SaddlePoint::solve`] its acceleration.
    pub fn body(&mut self, body: usize) -> &mut Vector3<f64> {
        &mut self.values[0][body]
    }

    /// Right-hand side gamma of a constraint (unused components must be 0), after the solution **minus** its multiplier.
    pub fn constraint(&mut self, constraint: usize) -> &mut Vector3<f64> {
        &mut self.values[1][constraint]
    }
}

/// Inverse of the symmetric positive definite 3 x 3 block of a body: its inertia and what it carries.
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

/// Inverse of the upper left `size` x `size` part of a constraint's block (negative definite when regular),
/// and whether all its stretches exceed `least`. Directions that do not are dropped; outside the part
/// stays the identity.
#[inline]
fn constraint_inverse(m: &Matrix3<f64>, size: usize, least: f64) -> (Matrix3<f64>, bool) {
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
    // Stretches x and y: x + y = trace, x y = determinant; the smaller is determinant/larger.
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
        // (m - smaller I)/(larger - smaller) projects on the larger stretch's direction.
        let smaller = trace - larger;
        let scale = 1.0 / (larger * (larger - smaller));
        inverse[(0, 0)] = (a - smaller) * scale;
        inverse[(1, 0)] = b * scale;
        inverse[(0, 1)] = b * scale;
        inverse[(1, 1)] = (d - smaller) * scale;
    }
    (inverse, false)
}

/// Turns the failing constraint's number into an error that names it.
pub(crate) fn redundant(mechanism: &Mechanism, constraint: usize) -> MechanismError {
    let revolutes = mechanism.revolutes.len();
    let constraint = if constraint < revolutes {
        format!("revolute {constraint}")
    } else {
        format!("driver {}", constraint - revolutes)
    };
    MechanismError::Redundant { constraint }
}

#[cfg(test)]
mod tests {
    use super::constraint_inverse;
    use nalgebra::{Matrix2, Matrix3};

    /// `[[a, b], [b, d]]` with these stretches, the first along the direction turned by `angle`.
    fn block(first: f64, second: f64, angle: f64) -> Matrix2<f64> {
        let (s, c) = angle.sin_cos();
        let turn = Matrix2::new(c, -s, s, c);
        turn * Matrix2::new(first, 0.0, 0.0, second) * turn.transpose()
    }

    /// Of one direction and of two: the inverse where both stretches exceed the least, and without the directions that do
    /// not. What lies outside of the part stays the identity.
    #[test]
    fn constraints_are_inverted_without_what_does_not_stretch() {
        let inverted = |part: Matrix2<f64>, size: usize| {
            let mut whole = Matrix3::identity() * 7.0;
            whole.fixed_view_mut::<2, 2>(0, 0).copy_from(&part);
            let (inverse, regular) = constraint_inverse(&whole, size, 1e-3);
            assert_eq!(inverse[(2, 2)], 1.0);
            let part: Matrix2<f64> = inverse.fixed_view::<2, 2>(0, 0).into();
            (part, regular)
        };
        let of = |x: f64| if x.abs() > 1e-3 { 1.0 / x } else { 0.0 };
        for angle in [0.0, 0.3, 0.8, 1.4, 2.5] {
            for (first, second) in [
                (-2.0, -0.5),
                (-0.5, -0.4),
                (-0.01, -3.0),
                (-1e-3 * 0.99, -0.3),
                (-0.3, -1e-3 * 1.01),
                (-0.3, 0.0),
                (-5.0, -1e-9),
                (-1e-4, -2e-4),
                (0.0, 0.0),
            ] {
                let (found, regular) = inverted(block(first, second, angle), 2);
                let exact = block(of(first), of(second), angle);
                let off = (found - exact).norm();
                assert!(
                    off < 1e-9 * exact.norm() + 1e-12,
                    "{first} {second} {angle}: {off:e}"
                );
                assert_eq!(
                    regular,
                    of(first) * of(second) != 0.0,
                    "{first} {second} {angle}"
                );
            }
        }
        for (stretch, inverse) in [(-4.0, -0.25), (-1e-4, 0.0)] {
            let (found, regular) = inverted(Matrix2::new(stretch, 0.0, 0.0, 9.0), 1);
            assert_eq!((found[(0, 0)], found[(1, 1)]), (inverse, 1.0));
            assert_eq!(regular, inverse != 0.0);
        }
    }
}
