//! Elastic bearings that discs float on: their forces on discs and input, or on the cranks of an RV gear.

use pinwheel_contact::{Complex, Dual, Scalar};
use pinwheel_mbs::{BodyState, ContactEnergy, Derivatives, Evaluation, Variable, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use super::bearing_load::BearingLoad;
use super::cranks::{CrankBearing, Cranks, OfCrank};
use super::motion::{self, Motion};
use super::pair::PairContact;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// Motion of a disc whose direction does not count.
#[inline(always)]
fn unturned(body: &BodyState) -> Motion {
    Motion {
        place: Complex::new(body.x, body.y),
        velocity: Complex::new(body.vx, body.vy),
        turn: Complex::ONE,
        rate: body.rate,
    }
}

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

    /// Adds loads, moments, derivatives and energy as far as they are requested.
    pub(super) fn add(&self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if let Some(derivatives) = &mut request.derivatives {
            self.add_jacobian(bodies, derivatives);
        }
        if let Some(loads) = request.loads.as_deref_mut() {
            self.add_loads(bodies, loads, request.moments.as_deref_mut());
        }
        if let Some(energy) = &mut request.energy {
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
        let mut bearings = OfCrank::new();
        let Some(cranks) = &self.cranks else {
            return Default::default();
        };
        cranks.crank(&self.law, self.layout, bodies, crank, &mut bearings);
        let body = bodies[self.layout.wheel_bodies().start + wheel];
        let CrankBearing { load, arm, .. } = bearings[wheel];
        (load, [body.x + arm.re, body.y + arm.im])
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
        let turn = input.angle.sin_cos();
        self.load_at(input, turn, &unturned(hub), self.eccentric_centres[wheel])
    }

    /// Load of the bearing of a disc on its one eccentric from the states of input and disc, sine and cosine of the input's
    /// angle, and the eccentric's centre.
    #[inline(always)]
    fn load_at<S: Scalar>(
        &self,
        input: &BodyState,
        (s, c): (S, S),
        wheel: &Motion<S>,
        centre: [f64; 2],
    ) -> BearingLoad<S> {
        let [sx, sy, x, y, rate] =
            [centre[0], centre[1], input.x, input.y, input.rate].map(|x| s.like(x));
        let (ex, ey) = (c * sx - s * sy, s * sx + c * sy);
        let offset = [wheel.place.re - x - ex, wheel.place.im - y - ey];
        let velocity = [wheel.velocity.re + rate * ey, wheel.velocity.im - rate * ex];
        BearingLoad::of(&self.law, offset, velocity, wheel.rate - rate)
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
            let bearing = self.load_at(input, turn, &unturned(hub), seat);
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

    /// Adds their derivatives by all that is free, and by the time as the input turns.
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Derivatives<'_>) {
        if let Some(cranks) = &self.cranks {
            return cranks.add_jacobian(&self.law, self.layout, bodies, derivatives);
        }
        let input = &bodies[Layout::INPUT];
        for (body, &centre) in self.layout.wheel_bodies().zip(&self.eccentric_centres) {
            let hub = &bodies[body];
            let [x, y, vx, vy, rate, phi] =
                Dual::variables([hub.x, hub.y, hub.vx, hub.vy, hub.rate, input.angle]);
            let wheel = Motion {
                place: Complex::new(x, y),
                velocity: Complex::new(vx, vy),
                turn: Complex::ONE.like(x),
                rate,
            };
            let load = self.load_at(input, phi.sin_cos(), &wheel, centre);
            let [_, x, y, rate, vx, vy] =
                motion::variables(derivatives.coordinates, body, hub, input);
            let variables = [x, y, vx, vy, rate, Variable::Time(input.rate)];
            let (place, angle) = (
                derivatives.coordinates.place(body),
                derivatives.coordinates.angle(body),
            );
            let [fx, fy] = load.on_wheel;
            derivatives.add(place, &variables, &fx.by);
            derivatives.add(place.map(|x| x + 1), &variables, &fy.by);
            derivatives.add(angle, &variables, &load.drag_n_m.by);
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
