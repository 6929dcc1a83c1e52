//! Elimination of bodies in closed form, before the factorisation.
//!
//! **Leaves** are bodies with a single revolute, at their centre of mass (pins, discs). With m and I of the leaf and D_p the
//! revolute's rows for its parent, the leaf and the parent's rows of the system are:
//!
//! ```text
//! a = gamma - D_p a_p,   mu = F - m a,   rotation: moment/I
//! (M_p + m D_p' D_p) a_p + ... = F_p - D_p' (F - m gamma)
//! ```
//!
//! **Hubs** are bodies that one revolute joins to the ground and that carry only leaves (shafts, pendulums); a driver from the
//! ground may turn them. Let s be the arm of the revolute and M the inertia including the leaves. Under the revolute one
//! acceleration is free:
//!
//! ```text
//! a = (gamma, 0) + w alpha,   w = (s_y, -s_x, 1)
//! alpha = w.(F - M (gamma, 0))/w.M w, or the driver's;   mu = (F - M a)_xy,   w.(F - M a) of the driver
//! ```
//! A gear has only hubs and leaves.

use std::collections::BTreeSet;
use std::iter::once;

use nalgebra::{Matrix3, Vector3};

use crate::mechanism::Mechanism;
use crate::tree::Arms;

/// Inertia of a body and the leaves on it, about its centre of mass.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inertia {
    mass: f64,
    /// First moment, kg m, in the ground frame.
    first: [f64; 2],
    /// Second moment, kg m^2.
    second: f64,
}

impl Inertia {
    /// Returns M.
    pub(super) fn matrix(&self) -> Matrix3<f64> {
        let (m, [x, y]) = (self.mass, self.first);
        Matrix3::new(m, 0.0, -y, 0.0, m, x, -y, x, self.second)
    }

    /// Returns M a.
    #[inline]
    fn times(&self, a: &Vector3<f64>) -> Vector3<f64> {
        let (m, [x, y]) = (self.mass, self.first);
        Vector3::new(
            m * a.x - y * a.z,
            m * a.y + x * a.z,
            x * a.y - y * a.x + self.second * a.z,
        )
    }

    /// Adds a leaf of mass `mass` at an arm whose square is `squared`.
    fn carry(&mut self, mass: f64, squared: f64) {
        self.mass += mass;
        self.second += mass * squared;
    }
}

/// Body held by one revolute, at its centre of mass.
#[derive(Debug, Clone)]
struct Leaf {
    body: usize,
    constraint: usize,
    mass: f64,
    /// Inverse 1/I.
    over_moment: f64,
    /// Arm of the revolute on the parent, m: `D_p = [-1 0 y; 0 -1 -x]`.
    arm: [f64; 2],
}

impl Leaf {
    /// Returns D_p' v.
    #[inline]
    fn on_parent(&self, v: [f64; 2]) -> Vector3<f64> {
        let [x, y] = self.arm;
        Vector3::new(-v[0], -v[1], y * v[0] - x * v[1])
    }

    /// Returns D_p a.
    #[inline]
    fn of_parent(&self, a: &Vector3<f64>) -> [f64; 2] {
        let [x, y] = self.arm;
        [y * a.z - a.x, -a.y - x * a.z]
    }
}

/// Body with the range of its leaves.
type Carrier = (usize, std::ops::Range<usize>);

/// Body that is joined to the ground and carries only leaves.
#[derive(Debug, Clone)]
struct Hub {
    body: usize,
    constraint: usize,
    driver: Option<usize>,
    /// Inverse 1/w.M w, which is constant because w and M turn with the body.
    over_inertia: f64,
    /// Free direction w.
    free: Vector3<f64>,
}

/// Leaves and hubs of a mechanism.
#[derive(Debug, Clone)]
pub(super) struct Pinned {
    /// Leaves on the ground, then carrier by carrier.
    leaves: Vec<Leaf>,
    on_ground: usize,
    carriers: Vec<Carrier>,
    hubs: Vec<Hub>,
    /// Inertia of every body; those of leaves are not read.
    pub(super) inertia: Vec<Inertia>,
}

/// Bodies and constraints that are not eliminated in closed form, by their numbers in the mechanism.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    pub(super) bodies: Vec<usize>,
    pub(super) constraints: Vec<usize>,
    /// Child and parent of each constraint, by their places in `bodies`; no parent: the ground.
    pub(super) ends: Vec<[Option<usize>; 2]>,
    /// Number of revolutes of the mechanism, which come before its drivers.
    pub(super) revolutes: usize,
}

impl Rest {
    /// Sorts the constraints: next is always the one with the fewest neighbours, whose elimination joins these. Returns each
    /// one's neighbours at its elimination, in ascending order.
    pub(super) fn order(&mut self) -> Vec<Vec<usize>> {
        let count = self.ends.len();
        let joined = |a: usize, b: usize| {
            let mut bodies = self.ends[a].iter().flatten();
            a != b && bodies.any(|body| self.ends[b].contains(&Some(*body)))
        };
        let near_of = |a| (0..count).filter(|&b| joined(a, b)).collect();
        let mut near: Vec<BTreeSet<usize>> = (0..count).map(near_of).collect();
        let mut left: Vec<usize> = (0..count).collect();
        let mut order = Vec::new();
        while let Some(least) = (0..left.len()).min_by_key(|&k| near[left[k]].len()) {
            let next = left.remove(least);
            let own = near[next].clone();
            for other in &own {
                near[*other].extend(&own);
                near[*other].retain(|c| c != other && *c != next);
            }
            order.push(next);
        }
        let mut places = vec![0; count];
        for (place, &c) in order.iter().enumerate() {
            places[c] = place;
        }
        self.constraints = order.iter().map(|&c| self.constraints[c]).collect();
        self.ends = order.iter().map(|&c| self.ends[c]).collect();
        let sorted = |c: usize| {
            let mut below: Vec<usize> = near[c].iter().map(|&c| places[c]).collect();
            below.sort_unstable();
            below
        };
        order.into_iter().map(sorted).collect()
    }
}

impl Pinned {
    pub(super) fn new(mechanism: &Mechanism) -> (Self, Rest) {
        let revolutes = mechanism.revolutes.len();
        let ends = mechanism.ends();
        let mut joints_of = vec![0_u32; mechanism.bodies.len()];
        for &(child, parent) in &ends {
            for body in once(child).chain(parent) {
                joints_of[body] += 1;
            }
        }
        let mut left = vec![true; joints_of.len()];
        let mut leaves = Vec::new();
        let alone = mechanism.bodies.iter().map(|b| Inertia {
            mass: b.mass,
            second: b.moment,
            ..Inertia::default()
        });
        let mut inertia: Vec<Inertia> = alone.collect();
        let touching =
            |body: usize| move |e: &(usize, Option<usize>)| e.0 == body || e.1 == Some(body);
        for (constraint, joint) in mechanism.revolutes.iter().enumerate() {
            if joints_of[joint.child] > 1 || joint.child_point != [0.0; 2] {
                continue;
            }
            let body = &mechanism.bodies[joint.child];
            left[joint.child] = false;
            if let Some(parent) = joint.parent {
                let [x, y] = joint.parent_point;
                inertia[parent].carry(body.mass, x * x + y * y);
            }
            let leaf = Leaf {
                body: joint.child,
                constraint,
                mass: body.mass,
                over_moment: body.moment.recip(),
                arm: [0.0; 2],
            };
            leaves.push((joint.parent, leaf));
        }
        leaves.sort_by_key(|(parent, _)| *parent);
        let on_ground = leaves.partition_point(|(parent, _)| parent.is_none());
        let carriers = (0..left.len()).filter_map(|body| {
            let to = |body| leaves.partition_point(|(parent, _)| *parent < Some(body));
            let own = to(body)..to(body + 1);
            (!own.is_empty()).then_some((body, own))
        });
        let is_leaf = |c: &usize| *c < revolutes && !left[ends[*c].0];
        let constraints: Vec<usize> = (0..ends.len()).filter(|c| !is_leaf(c)).collect();
        let mut hubs = Vec::new();
        for body in (0..left.len()).filter(|&k| left[k]) {
            let mut own = constraints.iter().filter(|c| touching(body)(&ends[**c]));
            let holders = [own.next(), own.next(), own.next()].map(|c| c.copied());
            let (constraint, driver) = match holders {
                [Some(c), driver, None] if c < revolutes => (c, driver),
                _ => continue,
            };
            let on_ground = |c: usize| ends[c] == (body, None);
            if on_ground(constraint) && driver.is_none_or(|d| d >= revolutes && on_ground(d)) {
                hubs.push(Hub {
                    body,
                    constraint,
                    driver,
                    over_inertia: 0.0,
                    free: Vector3::zeros(),
                });
            }
        }
        let mut pinned = Self {
            carriers: carriers.collect(),
            on_ground,
            leaves: leaves.into_iter().map(|(_, leaf)| leaf).collect(),
            hubs,
            inertia,
        };
        // Inertias are computed at angles of 0, because bodies rotate with all that they carry.
        pinned.place(
            &mechanism
                .revolutes
                .iter()
                .map(Arms::unturned)
                .collect::<Vec<_>>(),
        );
        for hub in &mut pinned.hubs {
            let times = pinned.inertia[hub.body].times(&hub.free);
            hub.over_inertia = hub.free.dot(&times).recip();
            left[hub.body] = false;
        }
        let bodies: Vec<usize> = (0..left.len()).filter(|&k| left[k]).collect();
        let place = |body: usize| bodies.partition_point(|&k| k < body);
        let constraints: Vec<usize> = (0..ends.len()).filter(|&c| left[ends[c].0]).collect();
        let of = |&c: &usize| [Some(place(ends[c].0)), ends[c].1.map(place)];
        let rest = Rest {
            ends: constraints.iter().map(of).collect(),
            bodies,
            constraints,
            revolutes,
        };
        (pinned, rest)
    }

    /// Sets all leaves and hubs for the arms of the revolutes.
    #[inline]
    pub(super) fn place(&mut self, arms: &[Arms]) {
        for (body, own) in &self.carriers {
            let mut first = [0.0; 2];
            for leaf in &mut self.leaves[own.clone()] {
                leaf.arm = arms[leaf.constraint].parent;
                first = [0, 1].map(|i| first[i] + leaf.mass * leaf.arm[i]);
            }
            self.inertia[*body].first = first;
        }
        for hub in &mut self.hubs {
            let [x, y] = arms[hub.constraint].child;
            hub.free = Vector3::new(y, -x, 1.0);
        }
    }

    /// Adds the leaves' parts to the right-hand sides, then replaces those of the hubs by their solutions.
    #[inline]
    pub(super) fn eliminate(&self, bodies: &mut [Vector3<f64>], constraints: &mut [Vector3<f64>]) {
        for (body, own) in &self.carriers {
            let mut sum = bodies[*body];
            for leaf in &self.leaves[own.clone()] {
                let (load, gamma) = (bodies[leaf.body], constraints[leaf.constraint]);
                sum -= leaf.on_parent([load.x - leaf.mass * gamma.x, load.y - leaf.mass * gamma.y]);
            }
            bodies[*body] = sum;
        }
        for hub in &self.hubs {
            let (inertia, load) = (&self.inertia[hub.body], bodies[hub.body]);
            let constrained = constraints[hub.constraint];
            let alpha = match hub.driver {
                None => hub.free.dot(&(load - inertia.times(&constrained))) * hub.over_inertia,
                Some(driver) => constraints[driver].x,
            };
            let a = constrained + hub.free * alpha;
            let rest = load - inertia.times(&a);
            bodies[hub.body] = a;
            constraints[hub.constraint] = Vector3::new(rest.x, rest.y, 0.0);
            if let Some(driver) = hub.driver {
                constraints[driver] = Vector3::new(hub.free.dot(&rest), 0.0, 0.0);
            }
        }
    }

    /// Computes the leaves' solutions from those of their parents.
    #[inline]
    pub(super) fn finish(&self, bodies: &mut [Vector3<f64>], constraints: &mut [Vector3<f64>]) {
        let mut finish_leaf = |leaf: &Leaf, bodies: &mut [Vector3<f64>], carried: [f64; 2]| {
            let (joint, load) = (&mut constraints[leaf.constraint], &mut bodies[leaf.body]);
            let a = [joint.x - carried[0], joint.y - carried[1]];
            *joint = Vector3::new(load.x - leaf.mass * a[0], load.y - leaf.mass * a[1], 0.0);
            *load = Vector3::new(a[0], a[1], load.z * leaf.over_moment);
        };
        for leaf in &self.leaves[..self.on_ground] {
            finish_leaf(leaf, bodies, [0.0; 2]);
        }
        for (body, own) in &self.carriers {
            let a = bodies[*body];
            for leaf in &self.leaves[own.clone()] {
                finish_leaf(leaf, bodies, leaf.of_parent(&a));
            }
        }
    }
}
