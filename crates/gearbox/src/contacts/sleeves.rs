//! Sleeves that roll on the wheels and rub on their pins, where no friction of contacts turns them.
//!
//! ```text
//! T = mu F_n d/(2 r) clamp(v_t/(r slow), -1, 1)      against the sliding of a sleeve that does not turn on its pin, at the contact
//! ```
//! A sleeve that rolls at v_t/r on a pin of diameter d loses mu F_n d/2 times that, and T takes as much from the wheel. The couple T r on
//! the pin is its carrier's. slow = 1 rad/s. Slopes leave T out: it is some thousandths of F_n.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, Pose, Sums, Wrench};

use super::field::{ContactEnergy, ContactField, PairContact};
use super::floating::Bearings;
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// Rolling slower than this a sleeve's friction fades, rad/s.
const SLOW_RAD_S: f64 = 1.0;

/// What sleeves lose on their pins.
#[derive(Debug, Clone, Copy)]
pub(super) struct OnPins {
    /// mu d/2, m.
    lever_m: f64,
    layout: Layout,
}

/// T on a sleeve.
struct Drag {
    force: [f64; 2],
    /// Couple on its pin, N m.
    couple: f64,
    lost_w: f64,
}

impl OnPins {
    /// `None` where it is not given, or friction of contacts turns sleeves as it will.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let bearings = &scene.bearings;
        let lever_m = 0.5 * bearings.sleeve_friction_coefficient? * bearings.sleeve_bore_m?;
        let stands = scene.contact.friction_coefficient == 0.0;
        (stands && lever_m > 0.0).then(|| Self {
            lever_m,
            layout: Layout::of(&scene.gear),
        })
    }

    fn drag(&self, bodies: &[BodyState], pair: &PairContact) -> Drag {
        let arm = [
            pair.point[0] - pair.centre[0],
            pair.point[1] - pair.centre[1],
        ];
        let radius = arm[0].hypot(arm[1]);
        let carrier = match pair.sleeve {
            Sleeve::External(_) => 0.0,
            Sleeve::Internal(_) => bodies[Layout::OUTPUT].rate,
        };
        let own = bodies[self.layout.sleeve_body(pair.sleeve)].rate;
        let passing = pair.tangential_rate_m_s + (carrier - own) * radius;
        let rolling = passing / radius;
        let size = self.lever_m * pair.normal_force_n / radius;
        let along = -size * (rolling / SLOW_RAD_S).clamp(-1.0, 1.0);
        let [nx, ny] = pair.normal;
        let force = [-along * ny, along * nx];
        Drag {
            force,
            couple: arm[0] * force[1] - arm[1] * force[0],
            lost_w: -along * passing,
        }
    }

    fn add(&self, bodies: &[BodyState], pair: &PairContact, loads: &mut [Wrench]) {
        let Drag {
            force: [fx, fy],
            couple,
            ..
        } = self.drag(bodies, pair);
        let wheel = self.layout.wheel_bodies().start + pair.wheel;
        let sleeve = &mut loads[self.layout.sleeve_body(pair.sleeve)];
        (sleeve.fx, sleeve.fy) = (sleeve.fx + fx, sleeve.fy + fy);
        if matches!(pair.sleeve, Sleeve::Internal(_)) {
            loads[Layout::OUTPUT].moment += couple;
        }
        let (load, at) = (&mut loads[wheel], bodies[wheel]);
        (load.fx, load.fy) = (load.fx - fx, load.fy - fy);
        load.moment -= (pair.point[0] - at.x) * fy - (pair.point[1] - at.y) * fx;
    }
}

/// Contacts and bearings, and sleeves on their pins.
pub(super) struct Rolling {
    pub(super) inner: Box<dyn ContactField>,
    pub(super) pins: OnPins,
}

impl Rolling {
    fn lost_w(&mut self, bodies: &[BodyState]) -> f64 {
        let (pins, mut lost) = (self.pins, 0.0);
        self.inner.touching(bodies, &mut |pair| {
            lost += pins.drag(bodies, pair).lost_w;
        });
        lost
    }
}

impl ContactField for Rolling {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Sums<'_>) -> bool {
        // Pairs are told of bodies in place alone.
        let is_told = pose != Pose::AnglesOnly && sums.moments.is_none();
        if !is_told || !self.inner.evaluate(bodies, pose, sums) {
            return false;
        }
        if let Some(loads) = sums.loads.as_deref_mut() {
            let pins = self.pins;
            self.inner
                .touching(bodies, &mut |pair| pins.add(bodies, pair, loads));
        }
        if sums.energy.is_some() {
            let lost = self.lost_w(bodies);
            sums.energy
                .iter_mut()
                .for_each(|sum| sum.friction_w += lost);
        }
        true
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.inner.touching(bodies, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.inner.nearest(bodies, wheel, sleeve)
    }

    fn law(&self) -> &PinLaw {
        self.inner.law()
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        let mut sum = self.inner.energy(bodies);
        sum.friction_w += self.lost_w(bodies);
        sum
    }

    fn bearings(&self) -> Option<&Bearings> {
        self.inner.bearings()
    }
}
