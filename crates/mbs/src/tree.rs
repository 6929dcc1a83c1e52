//! Spanning forest of the joints: bodies from the ground outwards.
//!
//! Along the forest every centre of mass follows from the angles exactly, without a solve, by `r_child = r_parent + A_parent
//! s_parent - A_child s_child`.

use crate::mechanism::{Mechanism, Revolute};
use crate::state::{BodyId, BodyState};

/// Arms of one revolute in the ground frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Arms {
    pub(crate) parent: [f64; 2],
    pub(crate) child: [f64; 2],
}

impl Arms {
    /// Returns the arms while both bodies have angles of 0.
    pub(crate) fn unturned(joint: &Revolute) -> Self {
        Self {
            parent: joint.parent_point,
            child: joint.child_point,
        }
    }
}

/// Revolute of the forest, in an order with parents before children.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Branch {
    revolute: usize,
    /// Body whose position is computed.
    body: BodyId,
    /// Body (or ground) from which it is computed.
    from: Option<BodyId>,
    /// True if `body` is the joint's child and `from` its parent; else the reverse.
    outwards: bool,
}

/// Forest, and the joints and bodies outside it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Forest {
    /// Bodies not reached by a revolute of the forest.
    pub(crate) roots: Vec<BodyId>,
    /// Branches whose bodies' centres are fixed by the ground.
    resting: Vec<Branch>,
    moving: Vec<Branch>,
    /// True if revolutes close loops.
    pub(crate) has_loops: bool,
}

impl Forest {
    /// Builds the forest breadth first from the ground; islands without ground start at their first body.
    pub(crate) fn new(mechanism: &Mechanism) -> Self {
        let n = mechanism.bodies.len();
        let mut reached = vec![false; n];
        let mut used = vec![false; mechanism.revolutes.len()];
        let (mut branches, mut roots) = (Vec::new(), Vec::new());
        loop {
            let before = branches.len();
            for (k, joint) in mechanism.revolutes.iter().enumerate() {
                if used[k] {
                    continue;
                }
                let parent_there = joint.parent.is_none_or(|p| reached[p]);
                let branch = match (parent_there, reached[joint.child], joint.parent) {
                    (true, false, from) => Branch {
                        revolute: k,
                        body: joint.child,
                        from,
                        outwards: true,
                    },
                    (false, true, Some(parent)) => Branch {
                        revolute: k,
                        body: parent,
                        from: Some(joint.child),
                        outwards: false,
                    },
                    _ => continue,
                };
                reached[branch.body] = true;
                used[k] = true;
                branches.push(branch);
            }
            if branches.len() == before {
                match reached.iter().position(|r| !r) {
                    Some(root) => {
                        reached[root] = true;
                        roots.push(root);
                    }
                    None => break,
                }
            }
        }
        let has_loops = used.contains(&false);
        // Closing loops moves all bodies.
        let rests = |branch: &Branch| {
            let pinned = mechanism.revolutes[branch.revolute].child_point == [0.0; 2];
            !has_loops && branch.from.is_none() && pinned
        };
        let (resting, moving) = branches.into_iter().partition(rests);
        Self {
            roots,
            resting,
            moving,
            has_loops,
        }
    }

    /// Computes the positions and velocities of all moving centres from their angles and predecessors. `arms`: arms of every
    /// revolute at these angles.
    #[inline]
    pub(crate) fn place(&self, bodies: &mut [BodyState], arms: &[Arms]) {
        for branch in &self.moving {
            branch.place(bodies, arms);
        }
    }

    /// Computes the centres of the resting branches, which only other code can move.
    pub(crate) fn place_resting(&self, bodies: &mut [BodyState], arms: &[Arms]) {
        for branch in &self.resting {
            branch.place(bodies, arms);
        }
    }
}

impl Branch {
    #[inline]
    fn place(&self, bodies: &mut [BodyState], arms: &[Arms]) {
        let arms = arms[self.revolute];
        let ([ax, ay], own) = if self.outwards {
            (arms.parent, arms.child)
        } else {
            (arms.child, arms.parent)
        };
        let (mut x, mut y, mut vx, mut vy) = match self.from {
            None => (ax, ay, 0.0, 0.0),
            Some(from) => {
                let b = &bodies[from];
                (b.x + ax, b.y + ay, b.vx - b.rate * ay, b.vy + b.rate * ax)
            }
        };
        let body = &mut bodies[self.body];
        let [ax, ay] = own;
        x -= ax;
        y -= ay;
        vx += body.rate * ay;
        vy -= body.rate * ax;
        (body.x, body.y, body.vx, body.vy) = (x, y, vx, vy);
    }
}

/// Returns a local point in the ground frame; the centre of mass itself needs no computation.
#[inline]
pub(crate) fn turned(point: [f64; 2], angle: f64) -> [f64; 2] {
    if point == [0.0, 0.0] {
        return point;
    }
    let (s, c) = angle.sin_cos();
    [c * point[0] - s * point[1], s * point[0] + c * point[1]]
}
