//! Elastic bearings that discs float on: their forces on discs and input, or on the cranks of an RV gear.

use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation, Jacobian, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use super::bearing_load::BearingLoad;
use super::cranks::{Cranks, OfCrank};
use super::pair::PairContact;
use super::pairs::places;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// The bearings of all eccentrics.
#[derive(Debug, Clone)]
pub struct EccentricBearings {
    pub(crate) law: BearingLaw,
    layout: Layout,
    /// Centre of every eccentric, in the input's frame, m.
    eccentric_centres: Vec<[f64; 2]>,
    /// Cranks that carry discs in the place of one eccentric.
    cranks: Option<Cranks>,
}

impl EccentricBearings {
    /// Bearings of a scene whose discs float; `None`: eccentrics hold them rigidly.
    #[must_use]
    pub fn of(scene: &Scene, geometry: &Geometry) -> Option<Self> {
        let eccentric_centres = geometry.wheel_phases.iter().zip(&geometry.eccentricities_m);
        Some(Self {
            law: BearingLaw::of(scene)?,
            layout: Layout::of(&scene.gear),
            eccentric_centres: eccentric_centres
                .map(|(phase, e)| [e * phase.cos(), e * phase.sin()])
                .collect(),
            cranks: Cranks::of(scene, geometry),
        })
    }

    /// True for the cranks of an RV gear.
    pub(super) fn has_cranks(&self) -> bool {
        self.cranks.is_some()
    }

    /// Adds loads, moments, derivatives and energy as far as `sums` has them.
    pub(super) fn add(&self, bodies: &[BodyState], sums: &mut Evaluation<'_>) {
        if let Some(derivatives) = sums.derivatives.as_deref_mut() {
            self.add_jacobian(bodies, derivatives);
        }
        if let Some(loads) = sums.loads.as_deref_mut() {
            self.add_loads(bodies, loads, sums.moments.as_deref_mut());
        }
        if let Some(energy) = &mut sums.energy {
            self.add_energy(bodies, energy);
        }
    }

    /// Bearings without friction.
    pub(crate) fn frictionless(mut self) -> Self {
        self.law.drag_m = 0.0;
        self
    }

    /// Bearings and supports whose deflection under the same forces is `share` of theirs, with `of_clearance` times
    /// their clearance.
    pub(crate) fn share(&self, share: f64, of_clearance: f64) -> Self {
        let law = BearingLaw {
            stiffness: self.law.stiffness / share.powf(self.law.exponent),
            clearance_m: self.law.clearance_m * of_clearance,
            ..self.law
        };
        let cranks = self
            .cranks
            .as_ref()
            .map(|cranks| cranks.share(share, of_clearance));
        Self {
            law,
            cranks,
            ..self.clone()
        }
    }

    /// Load of the bearing that carries a disc, or of those of all cranks together, whose offset is their mean.
    #[must_use]
    pub fn of_wheel(&self, bodies: &[BodyState], wheel: usize) -> BearingLoad {
        if self.cranks.is_none() {
            return self.load(bodies, wheel);
        }
        let mut all = BearingLoad::default();
        let share = 1.0 / self.layout.internal_sleeves as f64;
        for crank in 0..self.layout.internal_sleeves {
            let one = self.of_crank(bodies, wheel, crank);
            for k in 0..2 {
                all.on_wheel[k] += one.on_wheel[k];
                all.offset_m[k] += share * one.offset_m[k];
            }
            all.drag_n_m += one.drag_n_m;
        }
        all
    }

    /// The bearing of a crank of an RV gear in a disc, whose offset is the bore's centre from the eccentric's; of other gears
    /// nothing.
    #[must_use]
    pub fn of_crank(&self, bodies: &[BodyState], wheel: usize, crank: usize) -> BearingLoad {
        self.in_bore(bodies, wheel, crank).0
    }

    /// Load of a crank's bearing in a disc, and the bore's centre, m, ground frame.
    fn in_bore(&self, bodies: &[BodyState], wheel: usize, crank: usize) -> (BearingLoad, [f64; 2]) {
        let mut found = OfCrank::new();
        let Some(cranks) = &self.cranks else {
            return Default::default();
        };
        cranks.crank(&self.law, self.layout, bodies, crank, &mut found);
        let (body, [x, y]) = (
            bodies[self.layout.wheel_bodies().start + wheel],
            found[wheel].arm,
        );
        (found[wheel].load, [body.x + x, body.y + y])
    }

    /// Load of a crank's bearing in a disc as a pair of disc and crank.
    pub(super) fn crank_pair(
        &self,
        bodies: &[BodyState],
        wheel: usize,
        crank: usize,
    ) -> PairContact {
        let (load, point) = self.in_bore(bodies, wheel, crank);
        let ([dx, dy], [fx, fy]) = (load.offset_m, load.on_wheel);
        let offset = dx.hypot(dy);
        let normal = match offset > 0.0 {
            true => [-dx / offset, -dy / offset],
            false => [0.0; 2],
        };
        let seat = bodies[self.layout.sleeve_body(Sleeve::Internal(crank))];
        PairContact {
            wheel,
            sleeve: Sleeve::Internal(crank),
            point,
            normal,
            penetration_m: offset - self.clearance_m(wheel, crank),
            normal_rate_m_s: load.rate,
            tangential_rate_m_s: 0.0,
            stiffness: self.law.stiffness,
            normal_force_n: fx.hypot(fy),
            friction_force_n: 0.0,
            along_force_n: 0.0,
            centre: [seat.x, seat.y],
        }
    }

    /// All of them that carry.
    pub(crate) fn crank_pairs(&self, bodies: &[BodyState]) -> Vec<PairContact> {
        let cranks = self
            .cranks
            .iter()
            .flat_map(|_| 0..self.layout.internal_sleeves);
        let of_crank = |crank| (0..self.layout.wheels).map(move |wheel| (wheel, crank));
        let all = cranks.flat_map(of_crank);
        let pairs = all.map(|(wheel, crank)| self.crank_pair(bodies, wheel, crank));
        pairs.filter(|pair| pair.normal_force_n > 0.0).collect()
    }

    /// Clearance of that bearing, m.
    pub(crate) fn clearance_m(&self, wheel: usize, crank: usize) -> f64 {
        let own = self
            .cranks
            .as_ref()
            .map(|cranks| cranks.extra_clearance_m(wheel, crank));
        self.law.clearance_m + own.unwrap_or_default()
    }

    /// The bearing of a disc on its one eccentric.
    fn load(&self, bodies: &[BodyState], wheel: usize) -> BearingLoad {
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

    /// Adds all of them, and their moments to `moments`: input and discs turn about their centres of mass. Cranks tell no moments.
    #[inline]
    pub(crate) fn add_loads(
        &self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        mut moments: Option<&mut [f64]>,
    ) {
        if let Some(cranks) = &self.cranks {
            return cranks.add_loads(&self.law, self.layout, bodies, loads);
        }
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
        if let Some(cranks) = &self.cranks {
            return cranks.add_jacobian(&self.law, self.layout, bodies, derivatives);
        }
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
    pub(super) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        if let Some(cranks) = &self.cranks {
            return cranks.add_energy(&self.law, self.layout, bodies, sum);
        }
        for wheel in 0..self.layout.wheels {
            self.load(bodies, wheel).add_energy(&self.law, sum);
        }
    }
}
