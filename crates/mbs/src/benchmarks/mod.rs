//! Published mechanisms with known solutions, ready to run: what ties this solver to the world.
//!
//! A [`Problem`] holds mechanism, loads and what is read off; the numbers it is measured against
//! live in `reference/published/`. Nothing here knows of gears.

mod andrews;
mod four_bars;
mod pendulum;

pub use andrews::andrews;
pub use four_bars::four_bars;
pub use pendulum::pendulum;

use crate::elements::{Elements, kinetic_energy};
use crate::integrators::{StepCounts, StepError, StepSettings, start};
use crate::lagrange::{Lagrange, Stabilisation};
use crate::mechanism::{Mechanism, MechanismError};
use crate::ode::{Formulation, Observation};

/// A mechanism with its loads and its published read-out.
#[derive(Debug, Clone)]
pub struct Problem {
    /// For tables.
    pub name: String,
    /// Bodies and joints.
    pub mechanism: Mechanism,
    /// Applied loads.
    pub loads: Elements,
    /// What the published solution gives, from a state.
    pub read: fn(&Observation<'_>) -> Vec<f64>,
}

/// The read-out of one run at the times asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// One row of [`Problem::read`] a time.
    pub values: Vec<Vec<f64>>,
    /// Kinetic plus potential energy at those times, J.
    pub energy: Vec<f64>,
    /// Largest joint error at those times, m.
    pub joint_error: f64,
    /// What the integrator did.
    pub counts: StepCounts,
}

/// Why a problem was not solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// The mechanism is faulty.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
    /// The integrator gave up.
    #[error(transparent)]
    Step(#[from] StepError),
    /// No such method.
    #[error("no integrator `{0}`")]
    UnknownMethod(String),
    /// The observer asked to stop.
    #[error("stopped at t = {time} s")]
    Stopped {
        /// Where, s.
        time: f64,
    },
}

/// Steps between two looks at whether to stop.
const STEPS_BETWEEN_LOOKS: u64 = 100;

impl Problem {
    /// Integrates in the Lagrange form by `method` and reads the solution at `times` (s, increasing).
    ///
    /// # Errors
    /// See [`ProblemError`].
    pub fn solve(
        &self,
        stabilisation: Stabilisation,
        method: &str,
        settings: StepSettings,
        times: &[f64],
    ) -> Result<Solved, ProblemError> {
        self.solve_watched(stabilisation, method, settings, times, &mut |_| false)
    }

    /// The same; `watch` is asked every 100 steps and returns true to stop.
    ///
    /// # Errors
    /// See [`ProblemError`].
    pub fn solve_watched(
        &self,
        stabilisation: Stabilisation,
        method: &str,
        settings: StepSettings,
        times: &[f64],
        watch: &mut dyn FnMut(StepCounts) -> bool,
    ) -> Result<Solved, ProblemError> {
        let mut system = Lagrange::new(self.mechanism.clone(), self.loads.clone(), stabilisation)?;
        let mut y = system.initial();
        let mut stepper = start::<Lagrange<Elements>>(method, settings, 0.0, &y)
            .ok_or_else(|| ProblemError::UnknownMethod(method.to_owned()))?;
        let (mut values, mut energy) = (Vec::new(), Vec::new());
        let mut joint_error: f64 = 0.0;
        for &t in times {
            // A step that ends within rounding of t has arrived.
            while stepper.time() < t * (1.0 - 1e-12) {
                stepper.step(&mut system)?;
                let counts = stepper.counts();
                if counts.steps % STEPS_BETWEEN_LOOKS == 0 && watch(counts) {
                    return Err(ProblemError::Stopped {
                        time: stepper.time(),
                    });
                }
            }
            stepper.interpolate(&mut system, t, &mut y);
            joint_error = joint_error.max(system.joint_error(t, &y));
            let seen = system.observe(t, &y);
            values.push((self.read)(&seen));
            energy.push(
                kinetic_energy(&self.mechanism, seen.bodies) + self.loads.potential(seen.bodies),
            );
        }
        Ok(Solved {
            values,
            energy,
            joint_error,
            counts: stepper.counts(),
        })
    }
}
