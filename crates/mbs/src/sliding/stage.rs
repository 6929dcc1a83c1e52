//! One implicit stage: from listed contacts to velocities that agree with their friction.

use super::contact::{Contact, Row};
use super::problem::{SlidingProblem, Slip};

/// Times the normal forces are brought up to date with the velocities found. Damping makes them
/// depend on these a little; the second solution already changes the friction by less than 1e-3.
const PASSES: usize = 2;

/// Contacts of one stage in generalised velocities, with the memory for all stages.
#[derive(Debug, Clone)]
pub struct SlidingStage {
    problem: SlidingProblem,
    /// The stage's contacts, to be listed by the forces.
    pub contacts: Vec<Contact>,
    slips: Vec<Slip>,
    normals: Vec<Row>,
    normal_forces: Vec<f64>,
    target: Vec<f64>,
}

impl SlidingStage {
    /// See [`SlidingProblem::new`].
    #[must_use]
    pub fn new(inertia: Vec<f64>, is_leaf: &[bool]) -> Self {
        Self {
            contacts: Vec::new(),
            slips: Vec::new(),
            normals: Vec::new(),
            normal_forces: Vec::new(),
            target: vec![0.0; inertia.len()],
            problem: SlidingProblem::new(inertia, is_leaf),
        }
    }

    /// Forgets the rows of the stage before.
    pub fn clear_rows(&mut self) {
        self.slips.clear();
        self.normals.clear();
        self.normal_forces.clear();
    }

    /// Adds the next contact as rows: sliding speed u and closing speed of its normal.
    pub fn push(&mut self, contact: &Contact, tangent: Row, normal: Row) {
        self.slips.push(Slip {
            rate: tangent,
            limit: contact.coefficient * contact.normal_force,
            ramp: contact.ramp,
        });
        self.normals.push(normal);
        self.normal_forces.push(contact.normal_force);
    }

    /// Solves `v = v* + a i(v)` for the friction's accelerations i, in place (`v` holds v*), and writes i
    /// at the solution. `normal_force(k, listed, rate)` is the law of contact k at other velocities; what
    /// its change does is added to the accelerations `e`. False if there is no solution.
    pub fn solve(
        &mut self,
        a: f64,
        v: &mut [f64],
        e: &mut [f64],
        i: &mut [f64],
        normal_force: impl Fn(usize, f64, f64) -> f64,
    ) -> bool {
        i.fill(0.0);
        if self.slips.is_empty() {
            return true;
        }
        self.target.copy_from_slice(v);
        for pass in 0..PASSES {
            if a > 0.0
                && self
                    .problem
                    .solve(a, &self.slips, &self.target, v)
                    .is_none()
            {
                return false;
            }
            if a <= 0.0 || pass + 1 == PASSES {
                break;
            }
            for (k, slip) in self.slips.iter_mut().enumerate() {
                let contact = &self.contacts[k];
                let force = normal_force(k, contact.normal_force, self.normals[k].value(v));
                slip.limit = contact.coefficient * force;
                self.normal_forces[k] = force;
            }
        }
        let inertia = self.problem.inertia();
        for (k, slip) in self.slips.iter().enumerate() {
            let friction = slip.force(slip.rate.value(v));
            for (dof, c) in slip.rate.entries() {
                i[dof] -= friction * c / inertia[dof];
            }
            let change = self.normal_forces[k] - self.contacts[k].normal_force;
            for (dof, c) in self.normals[k].entries() {
                e[dof] -= change * c / inertia[dof];
            }
        }
        true
    }
}
