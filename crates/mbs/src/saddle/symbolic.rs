//! Order of elimination and fill, determined once for a mechanism.
//!
//! Nodes are bodies, then revolutes, then drivers. A body may be eliminated at any time. A constraint waits for the bodies that
//! [`prerequisites`] lists, so that its pivot is regular whenever D has full rank:
//! * a joint of the spanning forest waits for its outer body: these rows stay independent in any pose, because each has its own
//!   body;
//! * a joint that closes a loop waits for all bodies of that loop. The constraints eliminated before it lie within the closed
//!   loops or have their own bodies, so that they are independent rows of D.

use crate::mechanism::Mechanism;
use crate::tree::Forest;

/// Later neighbour of a pivot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Below {
    pub(super) node: usize,
    pub(super) block: usize,
}

/// `target -= block(row) * pivot^-1 * block(column)'`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Update {
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) target: Target,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    Diagonal(usize),
    Block(usize),
}

/// Operations at one pivot: ranges into the flat lists.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pivot {
    pub(super) node: usize,
    pub(super) below: (usize, usize),
    pub(super) updates: (usize, usize),
}

/// Returns the bodies that must be eliminated before each constraint.
pub(super) fn prerequisites(mechanism: &Mechanism) -> Vec<Vec<usize>> {
    let forest = Forest::new(mechanism);
    let mut from = vec![None; mechanism.bodies.len()];
    for branch in &forest.branches {
        from[branch.body] = branch.from;
    }
    let outwards = |body: Option<usize>| -> Vec<usize> {
        let mut chain: Vec<usize> = std::iter::successors(body, |&b| from[b])
            .take(from.len())
            .collect();
        chain.reverse();
        chain
    };
    // Loop of a closure: both paths inwards to the last common body, that body included.
    let path = |child: usize, parent: Option<usize>| -> Vec<usize> {
        let (a, b) = (outwards(Some(child)), outwards(parent));
        let shared = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
        let top = shared.saturating_sub(1);
        a[top..].iter().chain(&b[shared..]).copied().collect()
    };
    let joints = mechanism.revolutes.iter();
    let mut waits: Vec<_> = joints.map(|j| path(j.child, j.parent)).collect();
    for branch in &forest.branches {
        waits[branch.revolute] = vec![branch.body];
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
            .map_or_else(|| path(driver.child, driver.parent), |b| vec![b.body])
    }));
    waits
}

/// Returns the order of elimination: least degree first among the nodes that need not wait.
pub(super) fn elimination_order(
    bodies: usize,
    ends: &[(usize, Option<usize>)],
    waits: &[Vec<usize>],
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
    let mut order = Vec::with_capacity(nodes);
    while !left.is_empty() {
        let eligible =
            |&k: &usize| k < bodies || waits[k - bodies].iter().all(|body| !left.contains(body));
        // Constraints come first among equal degrees: carriers then wait for all bodies that they carry.
        let next = left
            .iter()
            .copied()
            .filter(eligible)
            .min_by_key(|&k| (neighbours[k].len(), usize::from(k < bodies)));
        let Some(k) = next else { break };
        left.remove(&k);
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
pub(super) struct Builder {
    pub(super) position: Vec<usize>,
    pub(super) blocks: std::collections::BTreeMap<(usize, usize), usize>,
    pub(super) columns: Vec<Vec<usize>>,
}

impl Builder {
    pub(super) fn new(nodes: usize, order: &[usize]) -> Self {
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

    /// Returns the block that couples two nodes, and creates it if needed: rows of the later, columns of the earlier.
    pub(super) fn block(&mut self, a: usize, b: usize) -> usize {
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

    pub(super) fn eliminate(&mut self, order: &[usize]) -> (Vec<Pivot>, Vec<Below>, Vec<Update>) {
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
