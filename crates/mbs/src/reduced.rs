//! Reduced form: exact elimination of centre-pinned bodies.
//!
//! The translations of a body carried at its centre of mass are known functions of its carrier's angle, and its own rotation
//! does not react on the carrier. Its mass is lumped into the carrier. One equation for each free angle remains, without
//! multipliers:
//!
//! ```text
//! carried body:  I a = moment
//! carrier:       (I + sum m |s|^2) a = moment + sum (A s) x F
//! driven carrier: torque = (I + sum m |s|^2) f'' - moment - sum (A s) x F
//! ```
//! Bodies without a joint (`floating`) keep their three coordinates: `m a = force` beside their angle's equation. Bodies
//! without a moment (`idle`) keep their rate and are not integrated. A carried body that a driver fixes to its carrier rotates
//! with it: its moment of inertia and its moment are added to the carrier's. The motion equals that of the Lagrange form to
//! rounding.
//!
//! Friction may be treated implicitly ([`OdeSystem::split_stage`]): a contact's sliding speed is linear in the free rates, `u =
//! offset + J v`, and its friction contributes `-J' F_t` to their equations.

use crate::forces::{Coordinates, Evaluation, Forces};
use crate::jacobian::{Jacobian, Structure};
use crate::mechanism::{Body, Mechanism, MechanismError, Motion};
use crate::ode::{Detail, ErrorScales, Formulation, Observation, OdeSystem, own_scale};
use crate::pinned::{Angle, PinnedContacts};
use crate::sliding::SlidingStage;
use crate::state::{BodyId, BodyState, ContactEnergy, Wrench};

/// Body carried by another body at its centre of mass.
#[derive(Debug, Clone, Copy)]
struct Carried {
    body: BodyId,
    carrier: BodyId,
    arm: [f64; 2],
    /// True if a driver fixes the body's angle to the carrier.
    held: bool,
}

/// Reduced equations of a mechanism under applied `F`.
pub struct Reduced<F> {
    mechanism: Mechanism,
    forces: F,
    carried: Vec<Carried>,
    carriers: Vec<BodyId>,
    /// Lumped moment of inertia of every body.
    inertia: Vec<f64>,
    free: Vec<BodyId>,
    /// Bodies without a joint; their positions are numbered after all free angles in y.
    floating: Vec<BodyId>,
    /// Bodies that rotate at a constant rate without a moment, with their initial states.
    idle: Vec<(BodyId, BodyState)>,
    /// Rotational kinetic energy of the `idle` bodies, J.
    idle_j: f64,
    /// For each free body, in order: true if the body never touches another leaf and carries nothing.
    is_leaf: Vec<bool>,
    /// Inverse inertias of the free bodies. Divisions in every evaluation would take a tenth of the time of a small gear.
    free_inverse: Vec<f64>,
    bodies: Vec<BodyState>,
    loads: Vec<Wrench>,
    /// Moments about the pin, loads of carried bodies included.
    moments: Vec<f64>,
    /// Unit numbers e^{i angle} of the carriers.
    turns: Vec<(f64, f64)>,
    torques: Vec<f64>,
    contacts: PinnedContacts,
    scales: Option<ErrorScales>,
    /// Forces of the revolutes on their children; empty unless requested.
    reactions: Vec<[f64; 2]>,
    /// Sum of the reactions that each body carries: scratch.
    borne: Vec<[f64; 2]>,
    evaluated: Evaluated,
    /// Time, s, from which the evaluation at the end of a step includes all parts of an observation.
    observes_from: f64,
    /// Capabilities of the forces: moments from angles alone, and derivatives.
    from_angles: bool,
    has_derivatives: bool,
    coordinates: Coordinates,
}

/// State of the last evaluation, whose loads and energy are stored, if any.
#[derive(Debug, Default)]
struct Evaluated {
    valid: bool,
    /// True if the poses of carried bodies are set.
    placed: bool,
    time: f64,
    y: Vec<f64>,
    energy: Option<ContactEnergy>,
}

impl Evaluated {
    fn is_of(&self, t: f64, y: &[f64]) -> bool {
        self.valid && self.time == t && self.y.as_slice() == y
    }
}

impl<F: Forces> Reduced<F> {
    /// Eliminates the translations of `mechanism`; `idle` bodies must never receive a moment.
    ///
    /// # Errors
    /// The mechanism is faulty, or not a forest of centre-pinned bodies whose carriers are pinned to the ground. Bodies without
    /// a joint are permitted.
    pub fn new(mechanism: Mechanism, forces: F, idle: &[BodyId]) -> Result<Self, MechanismError> {
        mechanism.check()?;
        let n = mechanism.bodies.len();
        let no = |text: String| Err(MechanismError::NotReducible(text));
        let mut pin: Vec<Option<(Option<BodyId>, [f64; 2])>> = vec![None; n];
        for (k, joint) in mechanism.revolutes.iter().enumerate() {
            let name = &mechanism.bodies[joint.child].name;
            if joint.child_point != [0.0, 0.0] {
                return no(format!(
                    "revolute {k} does not hold `{name}` at its centre of mass"
                ));
            }
            if pin[joint.child]
                .replace((joint.parent, joint.parent_point))
                .is_some()
            {
                return no(format!("`{name}` is held twice"));
            }
        }
        let mut angles = vec![Angle::Idle; n];
        let mut held = vec![false; n];
        for (k, driver) in mechanism.drivers.iter().enumerate() {
            angles[driver.child] = Angle::Driven(k);
            held[driver.child] = driver.parent.is_some();
            let on_carrier = pin[driver.child].map(|(carrier, _)| carrier) == Some(driver.parent);
            if held[driver.child] && !(on_carrier && driver.motion == Motion::default()) {
                return no(format!("driver {k} moves a body against another"));
            }
        }
        let mut free = Vec::new();
        for (body, angle) in angles.iter_mut().enumerate() {
            if *angle == Angle::Idle && !idle.contains(&body) {
                *angle = Angle::Free(free.len());
                free.push(body);
            }
        }
        let mut inertia: Vec<f64> = mechanism.bodies.iter().map(|b| b.moment).collect();
        let floats = |&body: &BodyId| pin[body].is_none() && matches!(angles[body], Angle::Free(_));
        let floating: Vec<BodyId> = (0..n).filter(floats).collect();
        let mut coordinates = Coordinates::new(n, &free, &floating);
        let mut bodies: Vec<BodyState> = mechanism.bodies.iter().map(|b| b.start).collect();
        let (mut carried, mut carriers) = (Vec::new(), Vec::new());
        for (body, own) in pin.iter().enumerate() {
            let name = &mechanism.bodies[body].name;
            match *own {
                None if matches!(angles[body], Angle::Free(_)) => {}
                None => return no(format!("`{name}` is not held by any revolute")),
                Some((None, [x, y])) => {
                    (bodies[body].x, bodies[body].y) = (x, y);
                    (bodies[body].vx, bodies[body].vy) = (0.0, 0.0);
                }
                Some((Some(carrier), arm)) => {
                    if !matches!(pin[carrier], Some((None, _))) {
                        return no(format!(
                            "the carrier of `{name}` is not pinned to the ground"
                        ));
                    }
                    let Body { mass, moment, .. } = mechanism.bodies[body];
                    inertia[carrier] += mass * (arm[0] * arm[0] + arm[1] * arm[1]);
                    let held = held[body];
                    if held {
                        inertia[carrier] += moment;
                        inertia[body] = 0.0;
                        angles[body] = angles[carrier];
                        coordinates.hold(body, carrier);
                    }
                    carried.push(Carried {
                        body,
                        carrier,
                        arm,
                        held,
                    });
                    if !carriers.contains(&carrier) {
                        carriers.push(carrier);
                    }
                }
            }
        }
        let carriers_of = pin.iter().map(|pin| pin.and_then(|(carrier, _)| carrier));
        let idle = (0..n).filter(|&body| angles[body] == Angle::Idle);
        let idle = idle.map(|body| (body, mechanism.bodies[body].start));
        let idle: Vec<_> = idle.filter(|(_, start)| start.rate != 0.0).collect();
        let of_idle = idle
            .iter()
            .map(|&(body, start)| 0.5 * mechanism.bodies[body].moment * start.rate.powi(2));
        let moving = moving(&mechanism, &inertia, &free, &floating);
        let is_leaf = vec![false; moving.len()];
        Ok(Self {
            scales: None,
            observes_from: f64::NEG_INFINITY,
            from_angles: forces.work_from_angles(),
            has_derivatives: forces.have_derivatives(),
            coordinates,
            reactions: vec![[0.0; 2]; mechanism.revolutes.len()],
            borne: vec![[0.0; 2]; n],
            evaluated: Evaluated {
                y: vec![0.0; 2 * moving.len()],
                ..Evaluated::default()
            },
            free_inverse: moving.iter().map(|inertia| inertia.recip()).collect(),
            contacts: PinnedContacts {
                stage: SlidingStage::new(moving, &is_leaf),
                pins: angles.into_iter().zip(carriers_of).collect(),
                free: free.clone(),
                floating: floating.clone(),
            },
            is_leaf,
            forces,
            carried,
            carriers,
            inertia,
            free,
            floating,
            idle_j: of_idle.sum(),
            idle,
            loads: vec![Wrench::default(); n],
            moments: vec![0.0; n],
            turns: vec![(1.0, 0.0); n],
            torques: vec![0.0; mechanism.drivers.len()],
            bodies,
            mechanism,
        })
    }

    /// Declares bodies that never touch each other and carry nothing. Their rates are eliminated first, both with implicit
    /// friction and in methods that solve with the Jacobian. Without them both matrices are dense.
    #[must_use]
    pub fn with_leaves(mut self, leaves: &[BodyId]) -> Self {
        let leaf = self.free.iter().map(|body| leaves.contains(body));
        let hubs = std::iter::repeat_n(false, 2 * self.floating.len());
        self.is_leaf = leaf.chain(hubs).collect();
        let inertia = moving(&self.mechanism, &self.inertia, &self.free, &self.floating);
        self.contacts.stage = SlidingStage::new(inertia, &self.is_leaf);
        self
    }

    /// Returns the dependence of this mechanism's contacts on its free rates.
    pub fn into_contacts(self) -> PinnedContacts {
        self.contacts
    }

    /// Sets the errors that adaptive methods weigh as 1.
    #[must_use]
    pub fn with_scales(mut self, scales: ErrorScales) -> Self {
        self.scales = Some(scales);
        self
    }

    /// Returns the bodies whose angles are integrated, in the order of y.
    pub fn free_bodies(&self) -> &[BodyId] {
        &self.free
    }

    /// Replaces the motion of a driver; the caller must restart the integration.
    pub fn set_motion(&mut self, driver: usize, motion: Motion) {
        self.evaluated.valid = false;
        self.mechanism.drivers[driver].motion = motion;
    }

    /// Returns the applied forces for changes; the caller must restart the integration.
    pub fn forces_mut(&mut self) -> &mut F {
        self.evaluated.valid = false;
        &mut self.forces
    }

    /// Returns the number of integrated coordinates.
    fn coordinates(&self) -> usize {
        self.is_leaf.len()
    }

    /// Sets the angles and rates of all bodies, and the positions and velocities of floating bodies, from y.
    fn turn(&mut self, t: f64, y: &[f64]) {
        self.evaluated.valid = false;
        let n = self.coordinates();
        let angles = self.free.len();
        let (places, _) = y[angles..n].as_chunks::<2>();
        let (velocities, _) = y[n + angles..].as_chunks::<2>();
        let moved = places.iter().zip(velocities);
        for (&body, (&place, &velocity)) in self.floating.iter().zip(moved) {
            let body = &mut self.bodies[body];
            [body.x, body.y] = place;
            [body.vx, body.vy] = velocity;
        }
        for (k, &body) in self.free.iter().enumerate() {
            self.bodies[body].angle = y[k];
            self.bodies[body].rate = y[n + k];
        }
        let drivers = self.mechanism.drivers.iter();
        for driver in drivers.filter(|driver| driver.parent.is_none()) {
            let (angle, rate, _) = driver.motion.at(t);
            self.bodies[driver.child].angle = angle;
            self.bodies[driver.child].rate = rate;
        }
    }

    /// Sets the angles, then positions and velocities of carried bodies.
    fn place(&mut self, t: f64, y: &[f64]) {
        self.turn(t, y);
        self.carry();
    }

    /// Sets the positions and velocities of carried bodies from the angles of their carriers.
    fn carry(&mut self) {
        for &carrier in &self.carriers {
            let (s, c) = self.bodies[carrier].angle.sin_cos();
            self.turns[carrier] = (c, s);
        }
        for &Carried {
            body,
            carrier,
            arm,
            held,
        } in &self.carried
        {
            let (c, s) = self.turns[carrier];
            let [ax, ay] = arm;
            let (rx, ry) = (c * ax - s * ay, s * ax + c * ay);
            let BodyState {
                x, y, angle, rate, ..
            } = self.bodies[carrier];
            let body = &mut self.bodies[body];
            if held {
                (body.angle, body.rate) = (angle, rate);
            }
            (body.x, body.y) = (x + rx, y + ry);
            (body.vx, body.vy) = (-rate * ry, rate * rx);
        }
    }

    /// Evaluates the forces at (t, y), unless their values are stored: moments always; all loads, the energy and the drivers'
    /// torques if the state is `observed`.
    fn evaluate(&mut self, t: f64, y: &[f64], observed: bool) {
        if self.evaluated.is_of(t, y) {
            return;
        }
        self.turn(t, y);
        self.evaluated.placed = false;
        self.moments.fill(0.0);
        let from_angles = self.from_angles;
        if !from_angles {
            self.put(t);
        }
        let mut request = match from_angles {
            true => Evaluation::of_moments(&mut self.moments),
            false => Evaluation::default(),
        };
        if observed || !from_angles || !self.floating.is_empty() {
            self.loads.fill(Wrench::default());
            request.loads = Some(&mut self.loads);
            request.floating_alone = !observed;
        }
        if observed {
            request = request.with_energy();
        }
        self.forces.evaluate(t, &self.bodies, &mut request);
        self.evaluated.energy = request.energy;
        if !from_angles {
            self.sum_moments();
        }
        if !observed {
            return;
        }
        for (torque, driver) in self.torques.iter_mut().zip(&self.mechanism.drivers) {
            let (_, _, acceleration) = driver.motion.at(t);
            *torque = self.inertia[driver.child] * acceleration - self.moments[driver.child];
        }
        (self.evaluated.valid, self.evaluated.time) = (true, t);
        self.evaluated.y.copy_from_slice(y);
    }

    /// Sets the poses of all bodies from their angles and rates, which are those at time `t`.
    fn put(&mut self, t: f64) {
        if self.evaluated.placed {
            return;
        }
        self.carry();
        for &(body, start) in &self.idle {
            self.bodies[body].angle = start.angle + start.rate * t;
        }
        self.evaluated.placed = true;
    }

    /// Returns the observation of the last evaluation, at time `t`.
    fn observation(&self, t: f64) -> Observation<'_> {
        Observation {
            time: t,
            bodies: &self.bodies,
            loads: &self.loads,
            moments: Some(&self.moments),
            kinetic_j: self.kinetic_j(),
            driver_torques: &self.torques,
            energy: self.evaluated.energy,
            reactions: None,
        }
    }

    /// Returns the kinetic energy of the bodies with their present angles and rates, J.
    fn kinetic_j(&self) -> f64 {
        let of = |body: BodyId| self.inertia[body] * self.bodies[body].rate.powi(2);
        let free: f64 = self.free.iter().map(|&body| of(body)).sum();
        let drivers = self.mechanism.drivers.iter();
        let driven: f64 = drivers.map(|driver| of(driver.child)).sum();
        let sliding = |&body: &BodyId| {
            let BodyState { vx, vy, .. } = self.bodies[body];
            self.mechanism.bodies[body].mass * (vx * vx + vy * vy)
        };
        let floating: f64 = self.floating.iter().map(sliding).sum();
        0.5 * (free + driven + floating) + self.idle_j
    }

    /// Writes the rates and the accelerations from the moments into `dydt`.
    fn write_derivative(&self, y: &[f64], dydt: &mut [f64]) {
        let n = self.coordinates();
        dydt[..n].copy_from_slice(&y[n..]);
        let rates = &mut dydt[n..];
        for (k, &body) in self.free.iter().enumerate() {
            rates[k] = self.moments[body] * self.free_inverse[k];
        }
        if !self.floating.is_empty() {
            rates[self.free.len()..].fill(0.0);
            self.accelerate_floating(rates);
        }
    }

    /// Adds the accelerations of floating bodies under the present loads to `accelerations`, whose entries for them are 0 on
    /// entry.
    fn accelerate_floating(&self, accelerations: &mut [f64]) {
        let first = self.free.len();
        let (to, _) = accelerations[first..].as_chunks_mut::<2>();
        let (inverse, _) = self.free_inverse[first..].as_chunks::<2>();
        for (&body, ([x, y], [of_x, of_y])) in self.floating.iter().zip(to.iter_mut().zip(inverse))
        {
            let load = &self.loads[body];
            *x += load.fx * of_x;
            *y += load.fy * of_y;
        }
    }

    /// Computes the forces of the revolutes at time `t` from the moments and loads of the last evaluation. The elimination does
    /// not need reaction forces, but they follow from it:
    ///
    /// ```text
    /// carried body:  reaction = m a - F,   a = A (alpha (k x s) - omega^2 s)
    /// carrier:       reaction = sum of its bodies' reactions - F
    /// ```
    fn set_reactions(&mut self, t: f64) {
        self.borne.fill([0.0; 2]);
        for carried_ones in [true, false] {
            for (k, joint) in self.mechanism.revolutes.iter().enumerate() {
                if joint.parent.is_some() != carried_ones {
                    continue;
                }
                let (child, load) = (self.bodies[joint.child], self.loads[joint.child]);
                let [mut fx, mut fy] = self.borne[joint.child];
                (fx, fy) = (fx - load.fx, fy - load.fy);
                if let Some(parent) = joint.parent {
                    let base = self.bodies[parent];
                    let turning = match self.contacts.pins[parent].0 {
                        Angle::Driven(driver) => self.mechanism.drivers[driver].motion.at(t).2,
                        Angle::Free(_) => self.moments[parent] / self.inertia[parent],
                        Angle::Idle => 0.0,
                    };
                    let (sx, sy) = (child.x - base.x, child.y - base.y);
                    let mass = self.mechanism.bodies[joint.child].mass;
                    let squared = base.rate * base.rate;
                    fx += mass * (-turning * sy - squared * sx);
                    fy += mass * (turning * sx - squared * sy);
                    self.borne[parent][0] += fx;
                    self.borne[parent][1] += fy;
                }
                self.reactions[k] = [fx, fy];
            }
        }
    }

    /// Sums the moments about the pins from the loads.
    fn sum_moments(&mut self) {
        for (moment, load) in self.moments.iter_mut().zip(&self.loads) {
            *moment = load.moment;
        }
        for carried in &self.carried {
            let base = self.bodies[carried.carrier];
            let body = self.bodies[carried.body];
            let load = self.loads[carried.body];
            let moment = &mut self.moments[carried.carrier];
            *moment += (body.x - base.x) * load.fy - (body.y - base.y) * load.fx;
            if carried.held {
                *moment += load.moment;
            }
        }
    }
}

/// Returns the inertia of every velocity: lumped moments of inertia of the free bodies, then masses of the floating ones.
fn moving(
    mechanism: &Mechanism,
    inertia: &[f64],
    free: &[BodyId],
    floating: &[BodyId],
) -> Vec<f64> {
    let turning = free.iter().map(|&body| inertia[body]);
    let masses = floating.iter().map(|&body| mechanism.bodies[body].mass);
    turning.chain(masses.flat_map(|mass| [mass; 2])).collect()
}

impl<F: Forces> OdeSystem for Reduced<F> {
    fn dimension(&self) -> usize {
        2 * self.coordinates()
    }

    fn has_turning_springs(&self) -> bool {
        !self.floating.is_empty()
    }

    fn scale(&self, y: &[f64], scale: &mut [f64]) {
        let Some(ErrorScales {
            angle,
            frequency,
            length,
        }) = self.scales
        else {
            own_scale(y, scale);
            return;
        };
        let (places, rates) = scale.split_at_mut(self.coordinates());
        for (scale, factor) in [(places, 1.0), (rates, frequency)] {
            let (angles, lengths) = scale.split_at_mut(self.free.len());
            angles.fill(angle * factor);
            lengths.fill(length * factor);
        }
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.evaluate(t, y, false);
        self.write_derivative(y, dydt);
    }

    fn derivative_at_end(&mut self, t: f64, y: &[f64], sampled: bool, dydt: &mut [f64]) {
        self.evaluate(t, y, sampled || t >= self.observes_from);
        self.write_derivative(y, dydt);
    }

    fn split_stage(&mut self, t: f64, a: f64, y: &mut [f64], e: &mut [f64], i: &mut [f64]) {
        self.place(t, y);
        self.loads.fill(Wrench::default());
        let n = self.coordinates();
        e.fill(0.0);
        let listed = &mut self.contacts.stage.contacts;
        self.forces
            .apply_without_friction(t, &self.bodies, &mut self.loads, listed);
        let (bodies, guess, rates) = (&self.bodies, &i[n..], &mut y[n..]);
        if !self.contacts.solve(a, guess, bodies, &self.forces, rates) {
            e.fill(f64::NAN);
            return;
        }
        i.fill(0.0);
        self.contacts.stage.accelerate(&mut e[n..], &mut i[n..]);
        self.sum_moments();
        for (k, &body) in self.free.iter().enumerate() {
            e[n + k] += self.moments[body] * self.free_inverse[k];
        }
        self.accelerate_floating(&mut e[n..]);
        e[..n].copy_from_slice(&y[n..]);
    }

    fn structure(&self) -> Structure {
        Structure::SecondOrder {
            is_leaf: self.is_leaf.clone(),
        }
    }

    fn jacobian(&mut self, t: f64, y: &[f64], jacobian: &mut Jacobian) -> bool {
        self.place(t, y);
        if self.has_derivatives {
            let mut request = Evaluation::of_derivatives(jacobian, &self.coordinates);
            self.forces.evaluate(t, &self.bodies, &mut request);
            jacobian.scale_rows(&self.free_inverse);
        }
        self.has_derivatives
    }

    fn restart_at(&mut self, from: f64) {
        self.evaluated.valid = false;
        self.mechanism.restart_at(from);
        self.forces.restart_at(from);
    }
}

impl<F: Forces> Formulation for Reduced<F> {
    fn initial(&self) -> Vec<f64> {
        let start = |body: &BodyId| self.mechanism.bodies[*body].start;
        let places = |b: &BodyId| [start(b).x, start(b).y];
        let velocities = |b: &BodyId| [start(b).vx, start(b).vy];
        let angles = self.free.iter().map(|b| start(b).angle);
        let rates = self.free.iter().map(|b| start(b).rate);
        angles
            .chain(self.floating.iter().flat_map(places))
            .chain(rates)
            .chain(self.floating.iter().flat_map(velocities))
            .collect()
    }

    fn observe(&mut self, t: f64, y: &[f64], detail: Detail) -> Observation<'_> {
        self.evaluate(t, y, true);
        if detail == Detail::Forces {
            return self.observation(t);
        }
        self.put(t);
        self.set_reactions(t);
        Observation {
            reactions: Some(&self.reactions),
            ..self.observation(t)
        }
    }

    fn cached_observation(&mut self, t: f64, y: &[f64]) -> Option<Observation<'_>> {
        self.evaluated.is_of(t, y).then(|| self.observation(t))
    }

    fn observe_from(&mut self, t: f64) {
        self.observes_from = t;
    }

    fn degrees_of_freedom(&self) -> usize {
        self.coordinates()
    }

    fn newton_steps(&self) -> u64 {
        self.contacts.stage.newton_steps()
    }

    fn joint_error(&mut self, _t: f64, _y: &[f64]) -> f64 {
        0.0
    }
}
