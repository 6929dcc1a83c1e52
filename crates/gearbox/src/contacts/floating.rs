//! Contacts of wheels that float on elastic bearings: those of the law, and the bearings' forces on wheels and input.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, Jacobian, Pose, Sums, Wrench, add_pair};
use pinwheel_scene::bearings::BearingLaw;

use super::field::{ContactEnergy, ContactField, PairContact};
use super::pairs::places;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// The bearings of all eccentrics.
#[derive(Debug, Clone)]
pub struct Bearings {
    pub(crate) law: BearingLaw,
    layout: Layout,
    /// Of every eccentric, in the input's frame, m.
    seats: Vec<[f64; 2]>,
}

/// One bearing at a state.
#[derive(Debug, Clone, Copy)]
pub struct BearingLoad {
    /// On the wheel at its centre, N, ground frame.
    pub on_wheel: [f64; 2],
    /// Wheel's centre less the eccentric's, m, ground frame.
    pub offset_m: [f64; 2],
    /// Friction on the wheel, N m, and what it loses, W.
    pub drag_n_m: f64,
    drag_w: f64,
    /// How fast the offset grows, m/s.
    rate: f64,
}

impl Bearings {
    /// Of a scene whose wheels float; `None`: eccentrics hold them rigidly.
    #[must_use]
    pub fn of(scene: &Scene, geometry: &Geometry) -> Option<Self> {
        let seats = geometry.wheel_phases.iter().zip(&geometry.eccentricities_m);
        Some(Self {
            law: BearingLaw::of(scene)?,
            layout: Layout::of(&scene.gear),
            seats: seats
                .map(|(phase, e)| [e * phase.cos(), e * phase.sin()])
                .collect(),
        })
    }

    /// The bearing of a wheel.
    #[must_use]
    pub fn load(&self, bodies: &[BodyState], wheel: usize) -> BearingLoad {
        self.load_at(bodies, wheel, bodies[Layout::INPUT].angle.sin_cos())
    }

    /// The same with sine and cosine of the input's angle.
    #[inline]
    fn load_at(&self, bodies: &[BodyState], wheel: usize, (s, c): (f64, f64)) -> BearingLoad {
        let input = bodies[Layout::INPUT];
        let body = bodies[self.layout.wheel_bodies().start + wheel];
        let [sx, sy] = self.seats[wheel];
        let (ex, ey) = (c * sx - s * sy, s * sx + c * sy);
        let (dx, dy) = (body.x - input.x - ex, body.y - input.y - ey);
        let (ux, uy) = (body.vx + input.rate * ey, body.vy - input.rate * ex);
        let offset = (dx * dx + dy * dy).sqrt();
        let [nx, ny] = match offset > 0.0 {
            true => [dx / offset, dy / offset],
            false => [0.0; 2],
        };
        let rate = ux * nx + uy * ny;
        let force = self.law.force(offset, rate);
        let turning = body.rate - input.rate;
        let drag_n_m = self.law.drag(force, turning);
        BearingLoad {
            on_wheel: [-force * nx, -force * ny],
            offset_m: [dx, dy],
            drag_n_m,
            drag_w: -drag_n_m * turning,
            rate,
        }
    }

    /// Adds all of them.
    pub(crate) fn add_loads(&self, bodies: &[BodyState], loads: &mut [Wrench]) {
        let turn = bodies[Layout::INPUT].angle.sin_cos();
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let load = self.load_at(bodies, wheel, turn);
            let (pair, at) = ([body, Layout::INPUT], [bodies[body].x, bodies[body].y]);
            add_pair(loads, bodies, pair, at, load.on_wheel);
            loads[body].moment += load.drag_n_m;
            loads[Layout::INPUT].moment -= load.drag_n_m;
        }
    }

    /// Torque that holds the input against them, N m.
    #[must_use]
    pub fn driver_torque(&self, bodies: &[BodyState]) -> f64 {
        let input = bodies[Layout::INPUT];
        let of = |(wheel, body): (usize, usize)| {
            let load = self.load(bodies, wheel);
            let [fx, fy] = load.on_wheel;
            (bodies[body].x - input.x) * fy - (bodies[body].y - input.y) * fx + load.drag_n_m
        };
        self.layout.wheel_bodies().enumerate().map(of).sum()
    }

    /// Adds how they change with all that is free, and with the time as the input turns. With d the offset, n along it and t = R90
    /// n, e the eccentric and omega the input's rate:
    ///
    /// ```text
    /// force on the wheel  -F n,    dF = F_d n.dd + F_v (n.dd' + (d'.t) t.dd/|d|),    dn = t (t.dd)/|d|
    /// by the time:        dd = -C' dt,  dd' = omega^2 e dt
    /// ```
    pub(crate) fn add_slopes(&self, bodies: &[BodyState], slopes: &mut Jacobian) {
        let first = places(self.layout, slopes);
        let Some(position) = &mut slopes.position else {
            return;
        };
        let input = bodies[Layout::INPUT];
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let load = self.load(bodies, wheel);
            let [dx, dy] = load.offset_m;
            let offset = dx.hypot(dy);
            let [force, by_offset, by_rate] = self.law.slopes(offset, load.rate);
            if force == 0.0 {
                continue;
            }
            let body = bodies[body];
            let (n, t) = ([dx / offset, dy / offset], [-dy / offset, dx / offset]);
            let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
            let e = [body.x - input.x - dx, body.y - input.y - dy];
            let of_seat = [-input.rate * e[1], input.rate * e[0]];
            let passing = dot([body.vx - of_seat[0], body.vy - of_seat[1]], t);
            let turning = body.rate - input.rate;
            let [drag_by_force, drag_by_rate] = self.law.drag_slopes(force, turning);
            let hub = 1 + wheel;
            let rows = [first + 2 * wheel, first + 2 * wheel + 1];
            // By the way d moves and by its rate: the force along n, its part across, the moment.
            let moved = |way: [f64; 2], faster: [f64; 2]| {
                let across = dot(way, t) / offset;
                let grown = by_offset * dot(way, n) + by_rate * (dot(faster, n) + passing * across);
                let on_wheel = [0, 1].map(|k| -grown * n[k] - force * across * t[k]);
                (on_wheel, drag_by_force * grown)
            };
            for (k, axis) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
                for (matrix, (push, moment)) in [
                    (&mut *position, moved(axis, [0.0; 2])),
                    (&mut slopes.rate, moved([0.0; 2], axis)),
                ] {
                    matrix.add(rows[0], rows[k], push[0]);
                    matrix.add(rows[1], rows[k], push[1]);
                    matrix.add(hub, rows[k], moment);
                }
            }
            slopes.rate.add(hub, hub, drag_by_rate);
            let squared = input.rate * input.rate;
            let (push, moment) = moved(of_seat.map(|v| -v), e.map(|x| squared * x));
            slopes.time[rows[0]] += push[0];
            slopes.time[rows[1]] += push[1];
            slopes.time[hub] += moment;
        }
    }

    fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        for wheel in 0..self.layout.wheels {
            let load = self.load(bodies, wheel);
            let [dx, dy] = load.offset_m;
            let offset = dx.hypot(dy);
            sum.stored_j += self.law.stored(offset);
            let damped = self.law.force(offset, load.rate) - self.law.force(offset, 0.0);
            sum.damping_w += damped * load.rate;
            sum.friction_w += load.drag_w;
        }
    }
}

/// See the module.
pub(super) struct Floating {
    pub(super) contacts: Box<dyn ContactField>,
    pub(super) bearings: Bearings,
}

impl ContactField for Floating {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Sums<'_>) -> bool {
        if !self.contacts.evaluate(bodies, pose, sums) {
            return false;
        }
        if let Some(slopes) = sums.slopes.as_deref_mut() {
            self.bearings.add_slopes(bodies, slopes);
        }
        if let Some(loads) = sums.loads.as_deref_mut() {
            let hubs = Layout::INPUT..self.bearings.layout.wheel_bodies().end;
            if let Some(moments) = sums.moments.as_deref_mut() {
                // Input and wheels turn about their centres of mass.
                hubs.clone()
                    .for_each(|hub| moments[hub] -= loads[hub].moment);
            }
            self.bearings.add_loads(bodies, loads);
            if let Some(moments) = sums.moments.as_deref_mut() {
                hubs.for_each(|hub| moments[hub] += loads[hub].moment);
            }
        }
        if let Some(energy) = &mut sums.energy {
            self.bearings.add_energy(bodies, energy);
        }
        true
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.contacts.touching(bodies, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.contacts.nearest(bodies, wheel, sleeve)
    }

    fn law(&self) -> &PinLaw {
        self.contacts.law()
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        let mut sum = self.contacts.energy(bodies);
        self.bearings.add_energy(bodies, &mut sum);
        sum
    }

    fn bearings(&self) -> Option<&Bearings> {
        Some(&self.bearings)
    }
}
