//! Implicit stage: velocities that are consistent with the friction of listed contacts.

use pinwheel_faults::{Fault, factor};

use super::contact::{Contact, Row};
use super::problem::{SlidingProblem, Slip};

/// Contacts of one stage in generalised velocities, with the memory for all stages.
#[derive(Debug, Clone)]
pub struct SlidingStage {
    problem: SlidingProblem,
    /// Contacts of the stage, to be listed by the forces.
    pub contacts: Vec<Contact>,
    slips: Vec<Slip>,
    normals: Vec<Row>,
    normal_forces: Vec<f64>,
    friction: Vec<f64>,
    target: Vec<f64>,
    newton_steps: u64,
}

impl SlidingStage {
    /// Creates a stage; see [`SlidingProblem::new`].
    pub fn new(inertia: Vec<f64>, is_leaf: &[bool]) -> Self {
        Self {
            contacts: Vec::new(),
            slips: Vec::new(),
            normals: Vec::new(),
            normal_forces: Vec::new(),
            friction: Vec::new(),
            target: vec![0.0; inertia.len()],
            problem: SlidingProblem::new(inertia, is_leaf),
            newton_steps: 0,
        }
    }

    /// Sets the rows of the listed contacts: sliding speed u and closing speed of the normal.
    pub fn set_rows(&mut self, rows: impl Fn(&Contact) -> [Row; 2]) {
        self.slips.clear();
        self.normals.clear();
        self.normal_forces.clear();
        for contact in &self.contacts {
            let [tangent, normal] = rows(contact);
            self.slips.push(Slip {
                rate: tangent,
                limit: contact.coefficient * contact.normal_force,
                ramp: contact.ramp,
            });
            self.normals.push(normal);
            self.normal_forces.push(contact.normal_force);
        }
    }

    /// Solves `v = v* + a i(v)` for the friction's accelerations i, in place (`v` holds v*).
    ///
    /// Newton's method begins at v* + a `guess`, an estimate of i. Damping makes the normal forces depend slightly on the
    /// velocities; they are evaluated at this estimate. The error of an estimate from the previous stage changes them by less
    /// than 1e-3.
    ///
    /// `normal_force(k, listed, rate)` is the law of contact k at other velocities. Returns false without a solution.
    /// Afterwards [`contact_forces`](Self::contact_forces) and [`accelerate`](Self::accelerate) use the solution.
    pub fn solve(
        &mut self,
        a: f64,
        guess: &[f64],
        v: &mut [f64],
        normal_force: impl Fn(usize, f64, f64) -> f64,
    ) -> bool {
        self.target.copy_from_slice(v);
        if a > 0.0 {
            for (v, guess) in v.iter_mut().zip(guess) {
                *v += a * guess;
            }
            for (k, slip) in self.slips.iter_mut().enumerate() {
                let contact = &self.contacts[k];
                let force = normal_force(k, contact.normal_force, self.normals[k].value(v));
                slip.limit = contact.coefficient * force;
                self.normal_forces[k] = force;
            }
            match self.problem.solve(a, &self.slips, &self.target, v) {
                Some(steps) => self.newton_steps += steps as u64,
                None => return false,
            }
        }
        self.friction.clear();
        let sign = factor(Fault::FrictionSign, -1.0);
        let forces = self.slips.iter().map(|slip| slip.force(slip.rate.value(v)));
        self.friction.extend(forces.map(|force| sign * force));
        true
    }

    /// Returns the Newton steps of all stages so far.
    pub fn newton_steps(&self) -> u64 {
        self.newton_steps
    }

    /// Adds the accelerations by friction to `i`, and those by the change of the normal forces to `e`.
    pub fn accelerate(&self, e: &mut [f64], i: &mut [f64]) {
        let inertia = self.problem.inertia();
        for (k, slip) in self.slips.iter().enumerate() {
            for (dof, c) in slip.rate.entries() {
                i[dof] -= self.friction[k] * c / inertia[dof];
            }
            let change = self.normal_forces[k] - self.contacts[k].normal_force;
            for (dof, c) in self.normals[k].entries() {
                e[dof] -= change * c / inertia[dof];
            }
        }
    }

    /// Returns every contact with the change of its normal force and its friction against the sliding (t), N.
    pub fn contact_forces(&self) -> impl Iterator<Item = (&Contact, f64, f64)> {
        let forces = self.normal_forces.iter().zip(&self.friction);
        let all = self.contacts.iter().zip(forces);
        all.map(|(contact, (normal, friction))| (contact, normal - contact.normal_force, *friction))
    }
}
