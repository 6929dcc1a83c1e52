//! Contact forces and the load as applied forces of the mechanism, with friction included or listed separately.

use pinwheel_mbs::sliding::Contact;
use pinwheel_mbs::{BodyState, Evaluation, Forces, Variable, Wrench, add_pair};

use crate::Layout;
use crate::contacts::{ContactField, PairContact};
use crate::linear_signal::LinearSignal;
use crate::load_profile::{self, LoadSegment};
use crate::scene::Drive;
use crate::{Gearbox, GearboxError};

/// Applied forces of a gearbox.
pub struct GearForces {
    layout: Layout,
    /// Coefficients of friction of ring and of output pins on which discs slide, and the ramp, m/s.
    sliding: [f64; 2],
    ramp_m_s: f64,
    drive: Drive,
    field: ContactField,
    /// Load of the present segment.
    load: LoadSegment,
    /// Additional prescribed torques on input and output, N m.
    pub held: [LinearSignal; 2],
    /// True if the input's speed and the output's torque are prescribed; only then moments follow from angles, and derivatives
    /// are available.
    pub speed_in_torque_out: bool,
    /// Touching pairs of the last listing.
    pairs: Vec<PairContact>,
}

impl GearForces {
    /// Creates the forces of a gearbox in its first segment.
    ///
    /// # Errors
    /// See [`Gearbox::contact_field`].
    pub fn new(gearbox: &Gearbox) -> Result<Self, GearboxError> {
        let layout = gearbox.layout;
        let most = layout.wheels * (layout.external_sleeves + layout.internal_sleeves);
        Ok(Self {
            layout,
            sliding: gearbox.scene.sliding(),
            ramp_m_s: gearbox.scene.contact.friction_ramp_m_s,
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

    /// Returns the load on the output with the additional torque, N m.
    pub(crate) fn load_n_m(&self, time: f64) -> f64 {
        self.load.torque(time) + self.held[1].at(time)
    }

    /// Returns the time at which the present segment of the load begins, s.
    pub fn segment_s(&self) -> f64 {
        self.load.from_s
    }
}

impl Forces for GearForces {
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.evaluate(time, bodies, &mut Evaluation::of_loads(loads));
    }

    // Moments alone lack those of a free input.
    fn work_from_angles(&self) -> bool {
        self.speed_in_torque_out && self.field.work_from_angles()
    }

    // Derivatives by time lack the input's acceleration.
    fn have_derivatives(&self) -> bool {
        self.drive.speed_changes.is_empty()
            && self.speed_in_torque_out
            && self.field.have_derivatives()
    }

    fn evaluate(&mut self, t: f64, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        self.field.evaluate(bodies, request);
        let torque = self.load.torque(t);
        let [input, output] = &self.held;
        if let Some(loads) = &mut request.loads {
            loads[Layout::OUTPUT].moment += torque;
            self.add_held(t, loads);
        }
        if let Some(moments) = &mut request.moments {
            moments[Layout::OUTPUT] += torque;
            moments[Layout::INPUT] += input.at(t);
            moments[Layout::OUTPUT] += output.at(t);
        }
        if let Some(derivatives) = &mut request.derivatives {
            let load = &self.load;
            let mut change = output.slope;
            if (load.from_s..load.settled_s()).contains(&t) {
                change += (load.after_n_m - load.before_n_m) / load.ramp_s;
            }
            let row = derivatives.coordinates.angle(Layout::OUTPUT);
            derivatives.add(row, &[Variable::Time(1.0)], &[change]);
        }
    }

    fn apply_without_friction(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        if self.sliding == [0.0; 2] {
            self.apply(time, bodies, loads);
            return;
        }
        loads[Layout::OUTPUT].moment += self.load.torque(time);
        let (layout, pins) = (self.layout, self.field.pins);
        let (wheels, sliding) = (layout.wheel_bodies().start, self.sliding);
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
            if let Some(pins) = &pins[pair.sleeve.side()] {
                pins.add(bodies, pair, &pins.drag(bodies, pair), loads);
            }
            if sliding[pair.sleeve.side()] == 0.0 {
                return;
            }
            contacts.push(Contact {
                bodies: bodies_of,
                point: pair.point,
                normal: pair.normal,
                normal_force: pair.normal_force_n,
                coefficient: sliding[pair.sleeve.side()],
                ramp: self.ramp_m_s,
            });
            pairs.push(*pair);
        });
        self.field.carrier.add_loads(bodies, loads, None);
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
