//! Elastic bearings of floating discs, one on each eccentric of the input: their forces on discs and input.

use pinwheel_contact::{Complex, Dual, Scalar};
use pinwheel_mbs::{BodyState, ContactEnergy, Derivatives, Variable, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use super::bearing_load::BearingLoad;
use super::motion::{self, Motion};
use crate::Layout;
use crate::geometry::Geometry;
use crate::scene::Scene;

/// Returns the motion of a disc without its direction, which is not needed.
#[inline(always)]
fn unturned(body: &BodyState) -> Motion {
    Motion {
        place: Complex::new(body.x, body.y),
        velocity: Complex::new(body.vx, body.vy),
        turn: Complex::ONE,
        rate: body.rate,
    }
}

/// Bearings of all eccentrics.
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

    /// Returns the load of the bearing of a disc on its one eccentric.
    pub(crate) fn load(&self, bodies: &[BodyState], wheel: usize) -> BearingLoad {
        let (input, hub) = (
            &bodies[Layout::INPUT],
            &bodies[self.layout.wheel_bodies()][wheel],
        );
        let turn = input.angle.sin_cos();
        self.load_at(input, turn, &unturned(hub), self.eccentric_centres[wheel])
    }

    /// Returns the load of the bearing of a disc on its one eccentric from the states of input and disc, sine and cosine of the
    /// input's angle, and the eccentric's centre.
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

    /// Adds the loads of all bearings, and their moments about the centres of mass of input and discs to `moments`.
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

    /// Adds the bearings' derivatives with respect to all free coordinates, and to time as the input turns.
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Derivatives<'_>) {
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

    /// Adds the stored energy and the dissipated powers.
    pub(crate) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        for wheel in 0..self.layout.wheels {
            self.load(bodies, wheel).add_energy(&self.law, sum);
        }
    }
}
