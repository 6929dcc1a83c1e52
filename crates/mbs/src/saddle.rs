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
//! * a joint that closes a loop for all bodies, when its pivot is regular if D has full rank.
//!
//! For a forest there is no fill: eliminating a leaf body and then its joint adds the leaf's inertia
//! to its carrier, so the cost is linear in the number of bodies. Loops cost the fill they need.
//!
//! Blocks are 3 x 3 with the unused rows and columns of smaller nodes held at identity, which
//! keeps one code path and no branches; this is [George & Liu 1981] on 3 x 3 blocks.

use nalgebra::{Matrix3, Vector3};

use crate::mechanism::{Mechanism, MechanismError};
use crate::tree::Forest;

/// A pivot whose smallest to largest stretch falls below this is singular: the constraint depends on others.
const SINGULAR: f64 = 1e-13;

/// One later neighbour of a pivot.
#[derive(Debug, Clone, Copy)]
struct Below {
    node: usize,
    block: usize,
}

/// `target -= block(row) * pivot^-1 * block(column)'`.
#[derive(Debug, Clone, Copy)]
struct Update {
    row: usize,
    column: usize,
    target: Target,
}

#[derive(Debug, Clone, Copy)]
enum Target {
    Diagonal(usize),
    Block(usize),
}

/// What happens at one pivot: ranges into the flat lists.
#[derive(Debug, Clone, Copy)]
struct Pivot {
    node: usize,
    below: (usize, usize),
    updates: (usize, usize),
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

/// The factored system: symbolic part made once, numbers replaced at every evaluation.
#[derive(Debug, Clone)]
pub struct SaddlePoint {
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
    /// Right-hand side, then solution, one vector a node.
    unknowns: Vec<Vector3<f64>>,
}

impl SaddlePoint {
    /// Symbolic elimination for the joints of `mechanism`; constraints are its revolutes, then its drivers.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
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
            unknowns: vec![Vector3::zeros(); nodes],
        }
    }

    /// Number of 3 x 3 blocks below the diagonal, fill included.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.lower.len()
    }

    /// Puts M and the rows of D in place and factors. `rows(c)` gives constraint c.
    ///
    /// # Errors
    /// The index of the first constraint that depends on the others.
    pub(crate) fn factor(&mut self, mut rows: impl FnMut(usize) -> Rows) -> Result<(), usize> {
        self.diagonal[..self.bodies].copy_from_slice(&self.mass);
        for (node, diagonal) in self.diagonal.iter_mut().enumerate().skip(self.bodies) {
            *diagonal = Matrix3::zeros();
            for unused in self.sizes[node]..3 {
                diagonal[(unused, unused)] = 1.0;
            }
        }
        self.lower.fill(Matrix3::zeros());
        for (c, &(child, parent)) in self.slots.iter().enumerate() {
            let part = rows(c);
            let mut put = |slot: Slot, d: &Matrix3<f64>| {
                self.lower[slot.block] = if slot.transposed { d.transpose() } else { *d };
            };
            put(child, &part.child);
            if let Some(parent) = parent {
                put(parent, &part.parent);
            }
        }
        self.eliminate()
    }

    fn eliminate(&mut self) -> Result<(), usize> {
        for pivot in &self.pivots {
            let inverse = symmetric_inverse(&self.diagonal[pivot.node])
                .ok_or_else(|| pivot.node.saturating_sub(self.bodies))?;
            self.diagonal[pivot.node] = inverse;
            let below = &self.below[pivot.below.0..pivot.below.1];
            for (scaled, entry) in self.scratch.iter_mut().zip(below) {
                *scaled = self.lower[entry.block] * inverse;
            }
            for update in &self.updates[pivot.updates.0..pivot.updates.1] {
                let change =
                    self.scratch[update.row] * self.lower[below[update.column].block].transpose();
                match update.target {
                    Target::Diagonal(node) => self.diagonal[node] -= change,
                    Target::Block(block) => self.lower[block] -= change,
                }
            }
            for (scaled, entry) in self.scratch.iter().zip(below) {
                self.lower[entry.block] = *scaled;
            }
        }
        Ok(())
    }

    /// Solves for the right-hand side written through [`SaddlePoint::rhs_body`] and `rhs_constraint`.
    pub fn solve(&mut self) {
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
        &mut self.unknowns[body]
    }

    /// Right-hand side gamma of a constraint (unused components must be 0), after the solution **minus** its multiplier.
    pub fn constraint(&mut self, constraint: usize) -> &mut Vector3<f64> {
        &mut self.unknowns[self.bodies + constraint]
    }
}

/// Inverse of a symmetric 3 x 3 block, `None` when it is singular to rounding.
#[inline]
fn symmetric_inverse(m: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let (a, b, c) = (m[(0, 0)], m[(1, 0)], m[(2, 0)]);
    let (d, e, f) = (m[(1, 1)], m[(2, 1)], m[(2, 2)]);
    let (ca, cb, cc) = (d * f - e * e, c * e - b * f, b * e - c * d);
    let determinant = a * ca + b * cb + c * cc;
    // Scale by the diagonal, whose units differ (kg, kg m^2, 1/kg): |det| <= |a d f| for definite blocks.
    if !(determinant.abs() > SINGULAR * (a * d * f).abs()) {
        return None;
    }
    let inverse = 1.0 / determinant;
    let (ia, ib, ic) = (ca * inverse, cb * inverse, cc * inverse);
    let (id, ie, iff) = (
        (a * f - c * c) * inverse,
        (b * c - a * e) * inverse,
        (a * d - b * b) * inverse,
    );
    Some(Matrix3::new(ia, ib, ic, ib, id, ie, ic, ie, iff))
}

/// How many bodies must be gone before a constraint may be eliminated.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Waits {
    /// For this body.
    Outer(usize),
    /// For all of them.
    All,
}

/// What each constraint waits for.
fn prerequisites(mechanism: &Mechanism) -> Vec<Waits> {
    let forest = Forest::new(mechanism);
    let mut waits = vec![Waits::All; mechanism.revolutes.len()];
    for branch in &forest.branches {
        waits[branch.revolute] = Waits::Outer(branch.body);
    }
    waits.extend(mechanism.drivers.iter().map(|driver| {
        let across = |b: &&crate::tree::Branch| {
            (b.body, b.from) == (driver.child, driver.parent)
                || (Some(b.body), b.from) == (driver.parent, Some(driver.child))
        };
        forest
            .branches
            .iter()
            .find(across)
            .map_or(Waits::All, |b| Waits::Outer(b.body))
    }));
    waits
}

/// Least degree first among those that need not wait.
fn elimination_order(
    bodies: usize,
    ends: &[(usize, Option<usize>)],
    waits: &[Waits],
) -> Vec<usize> {
    use std::collections::BTreeSet;
    let nodes = bodies + ends.len();
    let mut neighbours: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); nodes];
    for (c, &(child, parent)) in ends.iter().enumerate() {
        for body in std::iter::once(child).chain(parent) {
            neighbours[bodies + c].insert(body);
            neighbours[body].insert(bodies + c);
        }
    }
    let mut left: BTreeSet<usize> = (0..nodes).collect();
    let mut bodies_left = bodies;
    let mut order = Vec::with_capacity(nodes);
    while !left.is_empty() {
        let eligible = |&k: &usize| {
            k < bodies
                || match waits[k - bodies] {
                    Waits::Outer(body) => !left.contains(&body),
                    Waits::All => bodies_left == 0,
                }
        };
        // Constraints first among equals: it keeps carriers waiting until all they carry is in.
        let next = left
            .iter()
            .copied()
            .filter(eligible)
            .min_by_key(|&k| (neighbours[k].len(), usize::from(k < bodies)));
        let Some(k) = next else { break };
        left.remove(&k);
        bodies_left -= usize::from(k < bodies);
        order.push(k);
        let around: Vec<usize> = std::mem::take(&mut neighbours[k]).into_iter().collect();
        for &i in &around {
            neighbours[i].remove(&k);
            neighbours[i].extend(around.iter().copied().filter(|&j| j != i));
        }
    }
    order
}

/// Collects blocks and updates of the symbolic elimination.
struct Builder {
    position: Vec<usize>,
    blocks: std::collections::BTreeMap<(usize, usize), usize>,
    columns: Vec<Vec<usize>>,
}

impl Builder {
    fn new(nodes: usize, order: &[usize]) -> Self {
        let mut position = vec![0; nodes];
        for (k, &node) in order.iter().enumerate() {
            position[node] = k;
        }
        Self {
            position,
            blocks: std::collections::BTreeMap::new(),
            columns: vec![Vec::new(); nodes],
        }
    }

    /// The block coupling two nodes, made if it is not there: rows of the later, columns of the earlier.
    fn block(&mut self, a: usize, b: usize) -> usize {
        let (late, early) = if self.position[a] > self.position[b] {
            (a, b)
        } else {
            (b, a)
        };
        let next = self.blocks.len();
        *self.blocks.entry((late, early)).or_insert_with(|| {
            self.columns[early].push(late);
            next
        })
    }

    fn eliminate(&mut self, order: &[usize]) -> (Vec<Pivot>, Vec<Below>, Vec<Update>) {
        let (mut pivots, mut below, mut updates) = (Vec::new(), Vec::new(), Vec::new());
        for &node in order {
            let mut later = self.columns[node].clone();
            later.sort_by_key(|&i| self.position[i]);
            let first = (below.len(), updates.len());
            for &i in &later {
                let block = self.block(i, node);
                below.push(Below { node: i, block });
            }
            for (row, &i) in later.iter().enumerate() {
                for (column, &j) in later.iter().enumerate().take(row + 1) {
                    let target = if i == j {
                        Target::Diagonal(i)
                    } else {
                        Target::Block(self.block(i, j))
                    };
                    updates.push(Update {
                        row,
                        column,
                        target,
                    });
                }
            }
            pivots.push(Pivot {
                node,
                below: (first.0, below.len()),
                updates: (first.1, updates.len()),
            });
        }
        (pivots, below, updates)
    }
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
