//! Contact forces and the load as the mechanism's applied forces, whole or with the friction told apart.

use pinwheel_mbs::sliding::{Contact, RateStage};
use pinwheel_mbs::{BodyState, ContactEnergy, Forces, Jacobian, Wrench};

use crate::Layout;
use crate::contacts::{ContactField, PairContact};
use crate::load_course::{self, LoadPiece};
use crate::scene::{Contact as Contacts, Drive};
use crate::{Gearbox, GearboxError};

/// Applied forces of a gearbox.
pub(crate) struct GearForces {
    layout: Layout,
    contact: Contacts,
    drive: Drive,
    field: Box<dyn ContactField>,
    /// The load of this leg.
    load: LoadPiece,
    /// Touching pairs of the last listing.
    pairs: Vec<PairContact>,
}

impl GearForces {
    pub(crate) fn new(gearbox: &Gearbox) -> Result<Self, GearboxError> {
        let layout = gearbox.layout;
        let most = layout.wheels * (layout.external_sleeves + layout.internal_sleeves);
        Ok(Self {
            layout,
            contact: gearbox.scene.contact.clone(),
            drive: gearbox.scene.drive.clone(),
            field: gearbox.contact_field()?,
            load: load_course::piece_at(&gearbox.scene.drive, 0.0),
            pairs: Vec::with_capacity(most),
        })
    }

    /// Where the present leg begins, s: what [`enter_leg`](Forces::enter_leg) was told, or an earlier time of the same leg.
    pub(crate) fn leg_s(&self) -> f64 {
        self.load.from_s
    }
}

impl Forces for GearForces {
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        loads[Layout::OUTPUT].moment += self.load.torque(time);
        self.field.add_loads(bodies, loads);
    }

    fn apply_observed(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
    ) -> Option<ContactEnergy> {
        loads[Layout::OUTPUT].moment += self.load.torque(time);
        Some(self.field.add_loads_with_energy(bodies, loads))
    }

    fn apply_held(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        observed: bool,
    ) -> Option<ContactEnergy> {
        loads[Layout::OUTPUT].moment += self.load.torque(time);
        self.field.add_held_loads(bodies, loads, observed)
    }

    fn moments(&mut self, time: f64, bodies: &[BodyState], moments: &mut [f64]) -> bool {
        let known = self.field.add_moments(bodies, moments);
        if known {
            moments[Layout::OUTPUT] += self.load.torque(time);
        }
        known
    }

    fn apply_without_friction(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        if !(self.contact.friction_coefficient > 0.0) {
            self.apply(time, bodies, loads);
            return;
        }
        loads[Layout::OUTPUT].moment += self.load.torque(time);
        let (layout, law) = (self.layout, &self.contact);
        let wheels = layout.wheel_bodies().start;
        let pairs = &mut self.pairs;
        pairs.clear();
        self.field.touching(bodies, &mut |pair| {
            let (sleeve, wheel) = (layout.sleeve_body(pair.sleeve), wheels + pair.wheel);
            let [nx, ny] = pair.normal;
            let (push, along) = (pair.normal_force_n, pair.along_force_n);
            for (point, fx, fy) in [
                (pair.point, -push * nx, -push * ny),
                (pair.centre, -along * ny, along * nx),
            ] {
                for (body, sign) in [(sleeve, 1.0), (wheel, -1.0)] {
                    let (at, load) = (bodies[body], &mut loads[body]);
                    let (fx, fy) = (sign * fx, sign * fy);
                    load.fx += fx;
                    load.fy += fy;
                    load.moment += (point[0] - at.x) * fy - (point[1] - at.y) * fx;
                }
            }
            contacts.push(Contact {
                bodies: [sleeve, wheel],
                point: pair.point,
                normal: pair.normal,
                normal_force: pair.normal_force_n,
                coefficient: law.friction_coefficient,
                ramp: law.friction_ramp_m_s,
            });
            pairs.push(*pair);
        });
    }

    fn solve_friction(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        stage: &mut RateStage<'_>,
    ) -> Option<bool> {
        let solved = self.field.solve_friction(bodies, loads, stage)?;
        loads[Layout::OUTPUT].moment += self.load.torque(time);
        Some(solved)
    }

    fn moment_slopes(&mut self, time: f64, bodies: &[BodyState], slopes: &mut Jacobian) -> bool {
        if !self.field.add_slopes(bodies, slopes) {
            return false;
        }
        let load = &self.load;
        if (load.from_s..load.settled_s()).contains(&time) {
            // The output is the first of the free bodies.
            let (_, _, by_time) = slopes.parts_mut();
            by_time[0] += (load.after_n_m - load.before_n_m) / load.ramp_s;
        }
        true
    }

    fn enter_leg(&mut self, from: f64) {
        self.load = load_course::piece_at(&self.drive, from);
    }

    fn normal_force(&self, index: usize, listed: f64, rate: f64) -> f64 {
        self.pairs
            .get(index)
            .map_or(listed, |pair| self.field.normal_force(pair, rate))
    }
}
