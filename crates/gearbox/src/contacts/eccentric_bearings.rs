//! Elastic bearings that discs float on, one on each eccentric of the input: their forces on discs and input.

use pinwheel_mbs::{BodyState, ContactEnergy, Jacobian, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use super::bearing_load::BearingLoad;
use super::pairs::places;
use crate::Layout;
use crate::geometry::Geometry;
use crate::scene::Scene;

/// The bearings of all eccentrics.
#[derive(Debug, Clone)]
pub struct EccentricBearings {
    pub(crate) law: BearingLaw,
    layout: Layout,
    /// Centre of every eccentric, in the input's frame, m.
    eccentric_centres: Vec<[f64; 2]>,
}

impl EccentricBearings {
    pub(crate) fn of(law: BearingLaw, scene: &Scene, geometry: &Geometry) -> Self {
        let eccentric_centres = geometry.wheel_phases.iter().zip(&geometry.eccentricities_m);
        Self {
            law,
            layout: Layout::of(&scene.gear),
            eccentric_centres: eccentric_centres
                .map(|(phase, e)| [e * phase.cos(), e * phase.sin()])
                .collect(),
        }
    }

    /// The bearing of a disc on its one eccentric.
    pub(crate) fn load(&self, bodies: &[BodyState], wheel: usize) -> BearingLoad {
        let (input, hub) = (
            &bodies[Layout::INPUT],
            &bodies[self.layout.wheel_bodies()][wheel],
        );
        self.load_at(
            input,
            hub,
            self.eccentric_centres[wheel],
            input.angle.sin_cos(),
        )
    }

    /// Load of the bearing of a disc on its one eccentric from the states of input and disc and the seat, with sine
    /// and cosine of the input's angle.
    #[inline(always)]
    fn load_at(
        &self,
        input: &BodyState,
        wheel: &BodyState,
        [sx, sy]: [f64; 2],
        (s, c): (f64, f64),
    ) -> BearingLoad {
        let (ex, ey) = (c * sx - s * sy, s * sx + c * sy);
        let (dx, dy) = (wheel.x - input.x - ex, wheel.y - input.y - ey);
        let (ux, uy) = (wheel.vx + input.rate * ey, wheel.vy - input.rate * ex);
        let turning = wheel.rate - input.rate;
        BearingLoad::of(&self.law, [dx, dy], [ux, uy], turning)
    }

    /// Adds all of them, and their moments to `moments`: input and discs turn about their centres of mass.
    #[inline]
    pub(crate) fn add_loads(
        &self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        mut moments: Option<&mut [f64]>,
    ) {
        let input = &bodies[Layout::INPUT];
        let turn = input.angle.sin_cos();
        let first = self.layout.wheel_bodies().start;
        let mut on_input = Wrench::default();
        let hubs = bodies[first..].iter().zip(&mut loads[first..]);
        for (k, (&seat, (hub, load))) in self.eccentric_centres.iter().zip(hubs).enumerate() {
            let bearing = self.load_at(input, hub, seat, turn);
            let ([fx, fy], drag) = (bearing.on_wheel, bearing.drag_n_m);
            load.fx += fx;
            load.fy += fy;
            load.moment += drag;
            if let Some(moments) = &mut moments {
                moments[first + k] += drag;
            }
            on_input.fx -= fx;
            on_input.fy -= fy;
            on_input.moment -= (hub.x - input.x) * fy - (hub.y - input.y) * fx + drag;
        }
        let load = &mut loads[Layout::INPUT];
        load.fx += on_input.fx;
        load.fy += on_input.fy;
        load.moment += on_input.moment;
        if let Some(moments) = moments {
            moments[Layout::INPUT] += on_input.moment;
        }
    }

    /// Adds how they change with all that is free, and with the time as the input turns. With d the offset, n along it and t = R90
    /// n, e the eccentric and omega the input's rate:
    ///
    /// ```text
    /// force on the disc  -F n,    dF = F_d n.dd + F_v (n.dd' + (d'.t) t.dd/|d|),    dn = t (t.dd)/|d|
    /// by the time:        dd = -C' dt,  dd' = omega^2 e dt
    /// ```
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Jacobian) {
        let first = places(self.layout, derivatives);
        let Some(position) = &mut derivatives.position else {
            return;
        };
        let input = bodies[Layout::INPUT];
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let load = self.load(bodies, wheel);
            let [dx, dy] = load.offset_m;
            let offset = dx.hypot(dy);
            let [force, by_offset, by_rate] = self.law.derivatives(offset, load.rate);
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
                    (&mut derivatives.rate, moved([0.0; 2], axis)),
                ] {
                    matrix.add(rows[0], rows[k], push[0]);
                    matrix.add(rows[1], rows[k], push[1]);
                    matrix.add(hub, rows[k], moment);
                }
            }
            derivatives.rate.add(hub, hub, drag_by_rate);
            let squared = input.rate * input.rate;
            let (push, moment) = moved(of_seat.map(|v| -v), e.map(|x| squared * x));
            derivatives.time[rows[0]] += push[0];
            derivatives.time[rows[1]] += push[1];
            derivatives.time[hub] += moment;
        }
    }

    /// Adds energy stored and powers dissipated.
    pub(crate) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        for wheel in 0..self.layout.wheels {
            self.load(bodies, wheel).add_energy(&self.law, sum);
        }
    }
}
