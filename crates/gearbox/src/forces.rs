//! Contact forces and the load as the mechanism's applied forces, whole or with the friction told apart.

use pinwheel_mbs::sliding::Contact;
use pinwheel_mbs::{BodyState, Evaluation, Forces, Pose, Wrench, add_pair};

use crate::Layout;
use crate::contacts::{ContactField, PairContact};
use crate::linear_signal::LinearSignal;
use crate::load_profile::{self, LoadSegment};
use crate::scene::{Contact as Contacts, Drive};
use crate::{Gearbox, GearboxError};

/// Applied forces of a gearbox.
pub(crate) struct GearForces {
    layout: Layout,
    contact: Contacts,
    drive: Drive,
    field: ContactField,
    /// The load of this segment.
    load: LoadSegment,
    /// Torques that are held on input and output besides, N m.
    pub(crate) held: [LinearSignal; 2],
    /// Speed in, torque out: what the short cuts are made for.
    pub(crate) speed_in_torque_out: bool,
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
            load: load_profile::piece_at(&gearbox.scene.drive, 0.0),
            held: [LinearSignal::default(); 2],
            speed_in_torque_out: true,
            pairs: Vec::with_capacity(most),
        })
    }

    fn add_held(&self, time: f64, loads: &mut [Wrench]) {
        for (held, body) in self.held.iter().zip([Layout::INPUT, Layout::OUTPUT]) {
            loads[body].moment += held.at(time);
        }
    }

    /// The load on the output with what is held there, N m.
    pub(crate) fn load_n_m(&self, time: f64) -> f64 {
        self.load.torque(time) + self.held[1].at(time)
    }

    /// Where the present segment begins, s: what [`restart_at`](Forces::restart_at) was told, or an earlier time of the same segment.
    pub(crate) fn segment_s(&self) -> f64 {
        self.load.from_s
    }
}

impl Forces for GearForces {
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.evaluate(time, bodies, Pose::Any, &mut Evaluation::of_loads(loads));
    }

    fn evaluate(
        &mut self,
        t: f64,
        bodies: &[BodyState],
        pose: Pose,
        sums: &mut Evaluation<'_>,
    ) -> bool {
        // Moments alone lack those of the input, where that is free.
        let is_partial =
            sums.derivatives.is_some() || sums.moments.is_some() && sums.loads.is_none();
        if is_partial && !self.speed_in_torque_out || !self.field.evaluate(bodies, pose, sums) {
            return false;
        }
        let torque = self.load.torque(t);
        let [input, output] = &self.held;
        if let Some(loads) = &mut sums.loads {
            loads[Layout::OUTPUT].moment += torque;
            self.add_held(t, loads);
        }
        if let Some(moments) = &mut sums.moments {
            moments[Layout::OUTPUT] += torque;
            moments[Layout::INPUT] += input.at(t);
            moments[Layout::OUTPUT] += output.at(t);
        }
        if let Some(derivatives) = &mut sums.derivatives {
            let load = &self.load;
            // The output is the first of the free bodies.
            if (load.from_s..load.settled_s()).contains(&t) {
                derivatives.time[0] += (load.after_n_m - load.before_n_m) / load.ramp_s;
            }
            derivatives.time[0] += output.slope;
        }
        true
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
            let bodies_of = [sleeve, wheel];
            let (across, beside) = ([-push * nx, -push * ny], [-along * ny, along * nx]);
            add_pair(loads, bodies, bodies_of, pair.point, across);
            add_pair(loads, bodies, bodies_of, pair.centre, beside);
            contacts.push(Contact {
                bodies: bodies_of,
                point: pair.point,
                normal: pair.normal,
                normal_force: pair.normal_force_n,
                coefficient: law.friction_coefficient,
                ramp: law.friction_ramp_m_s,
            });
            pairs.push(*pair);
        });
        if let Some(bearings) = &self.field.bearings {
            bearings.add_loads(bodies, loads, None);
        }
        if let Some(seals) = &self.field.seals {
            seals.add_moments(bodies, loads, |load| &mut load.moment);
        }
        self.add_held(time, loads);
    }

    fn restart_at(&mut self, from: f64) {
        self.load = load_profile::piece_at(&self.drive, from);
    }

    fn normal_force(&self, index: usize, listed: f64, rate: f64) -> f64 {
        self.pairs
            .get(index)
            .map_or(listed, |pair| pair.normal_force_at(self.field.law(), rate))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Override, Scene};
    use pinwheel_mbs::{Jacobian, Structure};

    fn gearbox(sets: &[(&str, &str)]) -> Gearbox {
        let sets: Vec<Override> = sets.iter().map(|&(k, v)| Override::new(k, v)).collect();
        Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap()
    }

    /// A pose under load, with rates at which contacts slide.
    fn pose(gearbox: &Gearbox) -> Vec<BodyState> {
        let mut statics = crate::statics::Statics::new(gearbox).unwrap();
        let mut bodies = statics.solve(0.3, 22.0).unwrap().bodies;
        for (k, body) in bodies.iter_mut().enumerate().skip(1) {
            body.rate += (k % 5) as f64 - 2.0;
        }
        bodies
    }

    /// Friction told apart and put on again, pair by pair, is all that there was.
    #[test]
    fn the_whole_is_friction_and_the_rest() {
        for law in ["paper", "paper-conservative"] {
            let gearbox = gearbox(&[
                ("contact.friction_coefficient", "0.1"),
                ("contact.law", law),
            ]);
            let bodies = pose(&gearbox);
            let mut forces = GearForces::new(&gearbox).unwrap();
            let zeros = vec![Wrench::default(); bodies.len()];
            let (mut whole, mut seen, mut rest) = (zeros.clone(), zeros.clone(), zeros);
            let mut contacts = Vec::new();
            forces.apply(0.1, &bodies, &mut whole);
            let mut sums = Evaluation::of_loads(&mut seen).with_energy();
            assert!(forces.evaluate(0.1, &bodies, Pose::Any, &mut sums));
            let energy = sums.energy.unwrap();
            assert_eq!(whole, seen);
            let known = forces.field.energy(&bodies);
            assert!((energy.stored_j / known.stored_j - 1.0).abs() < 1e-12);
            assert!((energy.friction_w() / known.friction_w() - 1.0).abs() < 1e-9);
            forces.apply_without_friction(0.1, &bodies, &mut rest, &mut contacts);
            assert!(contacts.len() > 10 && contacts.len() == forces.pairs.len());
            for (k, pair) in forces.pairs.iter().enumerate() {
                let again = forces.normal_force(k, f64::NAN, pair.normal_rate_m_s);
                assert!((again - pair.normal_force_n).abs() < 1e-12 * pair.normal_force_n);
                assert!(forces.normal_force(k, f64::NAN, pair.normal_rate_m_s + 1.0) > again);
            }
            assert_eq!(forces.normal_force(forces.pairs.len(), 7.0, 0.0), 7.0);
            for (contact, pair) in contacts.iter().zip(&forces.pairs) {
                let [nx, ny] = contact.normal;
                let drag = [-pair.friction_force_n * ny, pair.friction_force_n * nx];
                for (body, sign) in contact.bodies.into_iter().zip([1.0, -1.0]) {
                    let (at, [fx, fy]) = (bodies[body], drag.map(|f| sign * f));
                    let load = &mut rest[body];
                    load.fx += fx;
                    load.fy += fy;
                    load.moment += (contact.point[0] - at.x) * fy - (contact.point[1] - at.y) * fx;
                }
            }
            for (whole, rest) in whole.iter().zip(&rest) {
                let off = (whole.fx - rest.fx).hypot(whole.fy - rest.fy);
                assert!(off < 1e-8, "{law}: {whole:?} {rest:?}");
                assert!(
                    (whole.moment - rest.moment).abs() < 1e-9,
                    "{law}: {whole:?} {rest:?}"
                );
            }
        }
    }

    /// The load is that of the segment, and so is how it rises and falls.
    #[test]
    fn loads_follow_their_leg() {
        let gearbox = gearbox(&[
            ("drive.load_ramp_s", "0.01"),
            ("drive.output_torque_n_m", "20"),
            (
                "drive.load_changes",
                "[{ time_s = 0.03, output_torque_n_m = 5.0, ramp_s = 0.01 }]",
            ),
        ]);
        let bodies = pose(&gearbox);
        let mut forces = GearForces::new(&gearbox).unwrap();
        let torque = |forces: &mut GearForces, time: f64| {
            let (mut loads, mut idle) = (vec![Wrench::default(); bodies.len()], Vec::new());
            idle.resize(bodies.len(), Wrench::default());
            forces.apply(time, &bodies, &mut loads);
            forces.field.add_loads(&bodies, &mut idle);
            loads[Layout::OUTPUT].moment - idle[Layout::OUTPUT].moment
        };
        assert!((torque(&mut forces, 0.005) - 10.0).abs() < 1e-12);
        assert!((torque(&mut forces, 0.03) - 20.0).abs() < 1e-12);
        assert_eq!(forces.segment_s(), 0.0);
        let structure = Structure::SecondOrder {
            is_leaf: vec![false; 3],
        };
        let derivatives = |forces: &mut GearForces, time: f64| {
            let mut derivatives = Jacobian::new(&structure, 6);
            let mut sums = Evaluation::of_slopes(&mut derivatives);
            assert!(forces.evaluate(time, &bodies, Pose::Prescribed, &mut sums));
            derivatives.time
        };
        let (rising, risen) = (
            derivatives(&mut forces, 0.005),
            derivatives(&mut forces, 0.02),
        );
        assert!(
            (rising[0] - risen[0] - 2000.0).abs() < 1e-6,
            "{rising:?} {risen:?}"
        );
        assert_eq!(rising[1..], risen[1..]);
        forces.restart_at(0.03);
        assert!((torque(&mut forces, 0.03) - 20.0).abs() < 1e-12);
        assert!((torque(&mut forces, 0.05) - 5.0).abs() < 1e-12);
        assert_eq!(forces.segment_s(), 0.03);
        let (falling, fallen) = (
            derivatives(&mut forces, 0.031),
            derivatives(&mut forces, 0.05),
        );
        assert!(
            (falling[0] - fallen[0] + 1500.0).abs() < 1e-6,
            "{falling:?}"
        );
    }
}
