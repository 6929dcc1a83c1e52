//! Lagrange form: three coordinates for each body, joints by multipliers (Eq. 2-9).
//!
//! y = [x, y, angle of every body; their rates]. Every evaluation imposes the constraints' accelerations: `D a = gamma` with,
//! for a revolute with rotated arms s, `D_parent = [-1 0 s_y; 0 -1 -s_x]`, `D_child = [1 0 -s_y; 0 1 s_x]`, `gamma =
//! rate_child^2 s_child - rate_parent^2 s_parent`, and for a driver `gamma = f''`.
//!
//! Positions drift with the integrator's error, because only accelerations are constrained: for Heun at 1e-5 s about 1e-9 m on
//! the paper's discs, but 4e-10 m inside every second stage, which is 1e-4 of a penetration. [`Stabilisation`] selects the
//! remedy.

mod projected;
mod split;

use std::iter::zip;

use nalgebra::Vector3;

use crate::forces::{Evaluation, Forces, Pose};
use crate::mechanism::{Mechanism, MechanismError};
use crate::ode::{Detail, ErrorScales, Formulation, Observation, OdeSystem, own_scale};
use crate::pinned::PinnedContacts;
use crate::saddle::{Dependent, SaddlePoint, redundant};
use crate::state::{BodyId, BodyState, ContactEnergy, Wrench};
use crate::tree::{Arms, Forest, turned};
use projected::Projected;

/// Correction of the joints' drift, besides the constraints on accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stabilisation {
    /// No correction, as published.
    None,
    /// [Baumgarte 1972]: gamma - 2 b dPhi/dt - b^2 Phi with the rate b, 1/s.
    Baumgarte {
        /// b, 1/s; b times the step must stay below about 1 for explicit methods.
        rate: f64,
    },
    /// Projection of every evaluated stage and of every step's end onto the constraints. Along the forest of joints centres
    /// follow from angles, and driven angles from time. Newton steps of least kinetic energy, `M dq + D' mu = 0, D dq = -Phi`,
    /// close the loops.
    Projection,
}

/// Largest number of Newton steps to close loops.
const LOOP_STEPS: usize = 8;
/// Tolerance of closed loops: largest gap of a joint, relative to the largest coordinate (at least 1 m).
const LOOP_TOLERANCE: f64 = 1e-14;
/// Rotation of the fastest body out of a singular pose, rad.
const BESIDE: f64 = 2e-5;

/// True if a revolute is on the body outside its centre of mass.
fn turns(mechanism: &Mechanism, body: BodyId) -> bool {
    mechanism.revolutes.iter().any(|joint| {
        let child = joint.child == body && joint.child_point != [0.0; 2];
        child || (joint.parent == Some(body) && joint.parent_point != [0.0; 2])
    })
}

/// Returns the state of a body; `None` for the ground.
fn state_of(bodies: &[BodyState], body: Option<BodyId>) -> BodyState {
    body.map_or_else(BodyState::default, |body| bodies[body])
}

/// Splits y into three coordinates of every body and their rates.
#[inline]
fn coordinates(y: &[f64]) -> (&[[f64; 3]], &[[f64; 3]]) {
    let (q, v) = y.split_at(y.len() / 2);
    (q.as_chunks().0, v.as_chunks().0)
}

/// Splits y into three coordinates of every body and their rates, for writing.
#[inline]
fn coordinates_mut(y: &mut [f64]) -> (&mut [[f64; 3]], &mut [[f64; 3]]) {
    let (q, v) = y.split_at_mut(y.len() / 2);
    (q.as_chunks_mut().0, v.as_chunks_mut().0)
}

/// Writes the states of all bodies as y.
#[inline]
fn write<'a>(bodies: impl IntoIterator<Item = &'a BodyState>, y: &mut [f64]) {
    let (q, v) = coordinates_mut(y);
    for (body, (q, v)) in zip(bodies, zip(q, v)) {
        *q = [body.x, body.y, body.angle];
        *v = [body.vx, body.vy, body.rate];
    }
}

/// Equations of a mechanism under applied `F`.
pub struct Lagrange<F> {
    mechanism: Mechanism,
    forces: F,
    stabilisation: Stabilisation,
    forest: Forest,
    saddle: SaddlePoint,
    bodies: Vec<BodyState>,
    loads: Vec<Wrench>,
    arms: Vec<Arms>,
    /// Bodies with a joint outside their centre of mass.
    turning: Vec<BodyId>,
    /// Cosine and sine of the angles of these bodies; other entries are not used.
    turns: Vec<[f64; 2]>,
    projected: Projected,
    reactions: Vec<[f64; 2]>,
    torques: Vec<f64>,
    /// Dependence of contacts on the free rates, for implicit friction.
    contacts: Option<PinnedContacts>,
    rates: Vec<f64>,
    /// First estimate of the accelerations of these rates by friction.
    guess: Vec<f64>,
    friction: Vec<Wrench>,
    scales: Option<ErrorScales>,
}

impl<F: Forces> Lagrange<F> {
    /// Creates the equations: checks the mechanism, orders the elimination and factors once at the start.
    ///
    /// # Errors
    /// Bad indices or values; constraints that depend on each other at t = 0.
    pub fn new(
        mechanism: Mechanism,
        forces: F,
        stabilisation: Stabilisation,
    ) -> Result<Self, MechanismError> {
        mechanism.check()?;
        let n = mechanism.bodies.len();
        let mut system = Self {
            forces,
            stabilisation,
            scales: None,
            forest: Forest::new(&mechanism),
            saddle: SaddlePoint::new(&mechanism),
            bodies: vec![BodyState::default(); n],
            loads: vec![Wrench::default(); n],
            arms: mechanism.revolutes.iter().map(Arms::unturned).collect(),
            turning: (0..n).filter(|&body| turns(&mechanism, body)).collect(),
            turns: vec![[1.0, 0.0]; n],
            projected: Projected::new(6 * n),
            reactions: vec![[0.0; 2]; mechanism.revolutes.len()],
            torques: vec![0.0; mechanism.drivers.len()],
            contacts: None,
            rates: Vec::new(),
            guess: Vec::new(),
            friction: vec![Wrench::default(); n],
            mechanism,
        };
        let start = system.initial();
        system.unpack(&start);
        system.rotate_arms();
        system.rest();
        system
            .factor_beside()
            .map_err(|c| redundant(&system.mechanism, c))?;
        Ok(system)
    }

    /// Enables implicit treatment of friction; `contacts` comes from [`crate::Reduced`] of the same mechanism. Without it,
    /// methods with implicit friction fail on a mechanism whose forces list contacts.
    #[must_use]
    pub fn with_contacts(mut self, contacts: PinnedContacts) -> Self {
        self.contacts = Some(contacts);
        self
    }

    /// Sets the errors that adaptive methods weigh as 1.
    #[must_use]
    pub fn with_scales(mut self, scales: ErrorScales) -> Self {
        self.scales = Some(scales);
        self
    }

    /// Sets the states of all bodies from y.
    fn unpack(&mut self, y: &[f64]) {
        self.projected.valid = false;
        let (q, v) = coordinates(y);
        for (body, (q, v)) in zip(&mut self.bodies, zip(q, v)) {
            *body = BodyState::new(*q, *v);
        }
    }

    /// Sets from y the coordinates that the forest of joints does not determine, before
    /// [`satisfy_constraints`](Self::satisfy_constraints).
    fn unpack_free(&mut self, y: &[f64]) {
        self.projected.valid = false;
        let (q, v) = coordinates(y);
        for (body, (q, v)) in zip(&mut self.bodies, zip(q, v)) {
            (body.angle, body.rate) = (q[2], v[2]);
        }
        for &root in &self.forest.roots {
            self.bodies[root] = BodyState::new(q[root], v[root]);
        }
    }

    fn rotate_arms(&mut self) {
        for &body in &self.turning {
            let (s, c) = self.bodies[body].angle.sin_cos();
            self.turns[body] = [c, s];
        }
        let turned = |[x, y]: [f64; 2], body: BodyId| {
            let [c, s] = self.turns[body];
            [c * x - s * y, s * x + c * y]
        };
        for (arms, joint) in zip(&mut self.arms, &self.mechanism.revolutes) {
            arms.child = turned(joint.child_point, joint.child);
            if let Some(parent) = joint.parent {
                arms.parent = turned(joint.parent_point, parent);
            }
        }
    }

    /// Advances the arms by `time`, each at its body's rate.
    fn turn_arms(&mut self, time: f64) {
        self.projected.valid = false;
        for (arms, joint) in self.arms.iter_mut().zip(&self.mechanism.revolutes) {
            let on = |point: [f64; 2], rate: f64| turned(point, rate * time);
            arms.parent = on(arms.parent, state_of(&self.bodies, joint.parent).rate);
            arms.child = on(arms.child, self.bodies[joint.child].rate);
        }
    }

    /// Factors the system; where constraints depend on each other, at a neighbouring pose.
    ///
    /// Loops can lose rank in single poses of the motion, where the accelerations are the limit from both sides. The arms are
    /// therefore advanced by [`BESIDE`], each at its body's rate, and gamma is that of the same arms. The solution is then that
    /// of the neighbouring pose of the same branch, with an error of the order of that angle in this evaluation only.
    fn factor_beside(&mut self) -> Result<(), usize> {
        let Err(constraint) = self.saddle.factor(Dependent::Refuse, &self.arms) else {
            return Ok(());
        };
        let fastest = self.bodies.iter().map(|b| b.rate.abs()).fold(0.0, f64::max);
        if !(fastest > 0.0 && fastest.is_finite()) {
            return Err(constraint);
        }
        self.turn_arms(BESIDE / fastest);
        self.saddle.factor(Dependent::Refuse, &self.arms)
    }

    /// Returns Phi and dPhi/dt of a revolute.
    fn revolute_error(&self, k: usize) -> ([f64; 2], [f64; 2]) {
        let joint = &self.mechanism.revolutes[k];
        let ([px, py], [cx, cy]) = (self.arms[k].parent, self.arms[k].child);
        let parent = state_of(&self.bodies, joint.parent);
        let child = self.bodies[joint.child];
        (
            [child.x + cx - parent.x - px, child.y + cy - parent.y - py],
            [
                child.vx - child.rate * cy - parent.vx + parent.rate * py,
                child.vy + child.rate * cx - parent.vy - parent.rate * px,
            ],
        )
    }

    /// Returns Phi and dPhi/dt of a driver.
    fn driver_error(&self, k: usize, t: f64) -> (f64, f64) {
        let driver = &self.mechanism.drivers[k];
        let parent = state_of(&self.bodies, driver.parent);
        let (angle, rate, _) = driver.motion.at(t);
        let child = self.bodies[driver.child];
        (
            child.angle - parent.angle - angle,
            child.rate - parent.rate - rate,
        )
    }

    /// Sets the right-hand side gamma of Eq. 9, with Baumgarte's feedback if chosen.
    fn set_gamma(&mut self, t: f64) {
        let revolutes = self.arms.len();
        let kept = pinwheel_faults::factor(pinwheel_faults::Fault::DroppedGamma, 0.0);
        let squared = |body: &BodyState| kept * body.rate * body.rate;
        let joints = zip(&self.arms, &self.mechanism.revolutes);
        for (gamma, (arms, joint)) in zip(self.saddle.constraints(), joints) {
            let child = squared(&self.bodies[joint.child]);
            let parent = joint.parent.map_or(0.0, |body| squared(&self.bodies[body]));
            let [x, y] = [0, 1].map(|i| child * arms.child[i] - parent * arms.parent[i]);
            *gamma = Vector3::new(x, y, 0.0);
        }
        for (k, driver) in self.mechanism.drivers.iter().enumerate() {
            let (_, _, acceleration) = driver.motion.at(t);
            self.saddle.constraints()[revolutes + k] = Vector3::new(acceleration, 0.0, 0.0);
        }
        let Stabilisation::Baumgarte { rate: b } = self.stabilisation else {
            return;
        };
        let (b1, b2) = (2.0 * b, b * b);
        for k in 0..revolutes {
            let (phi, rate) = self.revolute_error(k);
            let feedback = [0, 1].map(|i| b1 * rate[i] + b2 * phi[i]);
            self.saddle.constraints()[k] -= Vector3::new(feedback[0], feedback[1], 0.0);
        }
        for k in 0..self.torques.len() {
            let (phi, rate) = self.driver_error(k, t);
            self.saddle.constraints()[revolutes + k].x -= b1 * rate + b2 * phi;
        }
    }

    /// Projects the bodies onto the constraints at time `t`.
    fn satisfy_constraints(&mut self, t: f64) {
        for driver in &self.mechanism.drivers {
            let (angle, rate, _) = driver.motion.at(t);
            let parent = state_of(&self.bodies, driver.parent);
            let child = &mut self.bodies[driver.child];
            (child.angle, child.rate) = (parent.angle + angle, parent.rate + rate);
        }
        self.rotate_arms();
        self.forest.place(&mut self.bodies, &self.arms);
        if self.forest.has_loops {
            self.close_loops(t);
        }
    }

    /// Corrects positions by Newton's method on all constraints in the metric of the mass matrix, then rates by one exact
    /// solve.
    fn close_loops(&mut self, t: f64) {
        let far = |b: &BodyState| b.x.abs().max(b.y.abs());
        let tolerance = LOOP_TOLERANCE * self.bodies.iter().map(far).fold(1.0, f64::max);
        for _ in 0..LOOP_STEPS {
            self.rotate_arms();
            let worst = self.set_joint_errors(t, false);
            if !(worst > tolerance) || self.correct().is_err() {
                break;
            }
            for (body, step) in zip(&mut self.bodies, self.saddle.bodies()) {
                body.x += step.x;
                body.y += step.y;
                body.angle += step.z;
            }
        }
        self.rotate_arms();
        self.set_joint_errors(t, true);
        if self.correct().is_ok() {
            for (body, step) in zip(&mut self.bodies, self.saddle.bodies()) {
                body.vx += step.x;
                body.vy += step.y;
                body.rate += step.z;
            }
        }
    }

    /// Writes -Phi, or -dPhi/dt where `rates` is true, into the constraint rows, and returns the largest component of a
    /// revolute's error.
    fn set_joint_errors(&mut self, t: f64, rates: bool) -> f64 {
        let mut worst: f64 = 0.0;
        for k in 0..self.arms.len() {
            let (phi, rate) = self.revolute_error(k);
            let [x, y] = if rates { rate } else { phi };
            worst = worst.max(x.abs()).max(y.abs());
            self.saddle.constraints()[k] = Vector3::new(-x, -y, 0.0);
        }
        for k in 0..self.torques.len() {
            let (phi, rate) = self.driver_error(k, t);
            let error = if rates { rate } else { phi };
            self.saddle.constraints()[self.arms.len() + k] = Vector3::new(-error, 0.0, 0.0);
        }
        worst
    }

    /// Solves M dq + D' mu = 0, D dq = b, with b in the constraint rows.
    fn correct(&mut self) -> Result<(), usize> {
        // Dependent directions are dropped: their correction is undefined, and a step of least energy does not move them.
        self.saddle.factor(Dependent::Drop, &self.arms)?;
        self.saddle.bodies().fill(Vector3::zeros());
        self.saddle.solve();
        Ok(())
    }

    /// Sums the applied loads at the unpacked bodies, and returns the contacts' energy if requested and available.
    fn sum_loads(&mut self, t: f64, wants_energy: bool) -> Option<ContactEnergy> {
        self.loads.fill(Wrench::default());
        let pose = if self.stabilisation == Stabilisation::Projection {
            Pose::Prescribed
        } else {
            Pose::Any
        };
        let mut request = Evaluation {
            pose,
            ..Evaluation::of_loads(&mut self.loads)
        };
        if wants_energy {
            request = request.with_energy();
        }
        self.forces.evaluate(t, &self.bodies, &mut request);
        request.energy
    }

    /// Solves the accelerations and multipliers under the loads.
    fn accelerate(&mut self, t: f64) -> Result<(), usize> {
        self.factor_beside()?;
        self.set_gamma(t);
        self.saddle.set_loads(&self.loads);
        self.saddle.solve();
        Ok(())
    }

    /// Resets the poses of bodies at rest to those of the forest of joints.
    fn rest(&mut self) {
        if self.stabilisation == Stabilisation::Projection {
            self.forest.place_resting(&mut self.bodies, &self.arms);
        }
    }

    /// Sets bodies and arms to (t, y), unless they already are.
    fn prepare(&mut self, t: f64, y: &[f64]) {
        if self.projected.is(t, y) {
            return;
        }
        if self.stabilisation == Stabilisation::Projection {
            self.unpack_free(y);
            self.satisfy_constraints(t);
        } else {
            self.unpack(y);
            self.rotate_arms();
        }
    }
}

impl<F: Forces> OdeSystem for Lagrange<F> {
    fn dimension(&self) -> usize {
        6 * self.bodies.len()
    }

    fn scale(&self, y: &[f64], scale: &mut [f64]) {
        let Some(ErrorScales {
            length,
            angle,
            frequency,
        }) = self.scales
        else {
            own_scale(y, scale);
            return;
        };
        let (q, v) = coordinates_mut(scale);
        for (scale, by) in [(q, 1.0), (v, frequency)] {
            scale.fill([length * by, length * by, angle * by]);
        }
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.prepare(t, y);
        self.sum_loads(t, false);
        if self.accelerate(t).is_err() {
            dydt.fill(f64::NAN);
            return;
        }
        let (qd, vd) = coordinates_mut(dydt);
        let states = zip(&self.bodies, self.saddle.bodies());
        for ((qd, vd), (body, a)) in zip(zip(qd, vd), states) {
            *qd = [body.vx, body.vy, body.rate];
            *vd = (*a).into();
        }
    }

    fn split_stage(&mut self, t: f64, a: f64, y: &mut [f64], e: &mut [f64], i: &mut [f64]) {
        if self.split(t, a, y, e, i).is_none() {
            e.fill(f64::NAN);
            i.fill(f64::NAN);
        }
    }

    fn project(&mut self, t: f64, y: &mut [f64]) {
        if self.stabilisation == Stabilisation::Projection {
            self.unpack_free(y);
            self.satisfy_constraints(t);
            write(&self.bodies, y);
            self.projected.set(t, y);
        }
    }

    fn restart_at(&mut self, from: f64) {
        self.mechanism.restart_at(from);
        self.forces.restart_at(from);
    }
}

impl<F: Forces> Formulation for Lagrange<F> {
    fn initial(&self) -> Vec<f64> {
        let mut y = vec![0.0; 6 * self.mechanism.bodies.len()];
        write(self.mechanism.bodies.iter().map(|body| &body.start), &mut y);
        y
    }

    fn observe(&mut self, t: f64, y: &[f64], _detail: Detail) -> Observation<'_> {
        self.prepare(t, y);
        let energy = self.sum_loads(t, true);
        let solved = self.accelerate(t).is_ok();
        // Without a solution the multipliers are unknown.
        let sign = if solved { -1.0 } else { f64::NAN };
        let (joints, drivers) = self.saddle.constraints().split_at(self.arms.len());
        for (reaction, mu) in zip(&mut self.reactions, joints) {
            *reaction = [sign * mu.x, sign * mu.y];
        }
        for (torque, mu) in zip(&mut self.torques, drivers) {
            *torque = sign * mu.x;
        }
        Observation {
            time: t,
            bodies: &self.bodies,
            loads: &self.loads,
            moments: None,
            kinetic_j: self.mechanism.kinetic_j(&self.bodies),
            driver_torques: &self.torques,
            energy,
            reactions: Some(&self.reactions),
        }
    }

    fn degrees_of_freedom(&self) -> usize {
        3 * self.bodies.len()
    }

    fn newton_steps(&self) -> u64 {
        let contacts = self.contacts.as_ref();
        contacts.map_or(0, |contacts| contacts.stage.newton_steps())
    }

    fn joint_error(&mut self, t: f64, y: &[f64]) -> f64 {
        let known = self.projected.is(t, y);
        if !known {
            self.unpack(y);
            self.rotate_arms();
        }
        let errors = (0..self.arms.len()).map(|k| {
            let ([x, y], _) = self.revolute_error(k);
            x * x + y * y
        });
        let largest = errors.fold(0.0, f64::max).sqrt();
        if !known {
            self.rest();
        }
        largest
    }
}
