//! Published mechanisms with known solutions.
//!
//! A [`Problem`] has mechanism, loads and outputs; the published values are in `reference/published/`. Nothing here depends on
//! gears.

#![allow(dead_code, reason = "tests and benches each use a part")]

mod andrews;
mod elements;
mod four_bars;
mod pendulum;

pub(crate) use andrews::andrews;
pub(crate) use four_bars::four_bars;
pub(crate) use pendulum::pendulum;

use elements::Elements;
use pinwheel_mbs::integrators::{StepCounts, StepError, StepSettings, start};
use pinwheel_mbs::{Detail, Formulation, Lagrange, Mechanism, Observation, Stabilisation};

/// Mechanism with its loads and its published outputs.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    /// Name for tables.
    pub(crate) name: String,
    /// Bodies and joints.
    pub(crate) mechanism: Mechanism,
    /// Applied loads.
    pub(crate) loads: Elements,
    /// Figures of the published solution, from a state.
    pub(crate) read: fn(&Observation<'_>) -> Vec<f64>,
}

/// Outputs of one run at the requested times.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solved {
    /// Rows of [`Problem::read`], one for each time.
    pub(crate) values: Vec<Vec<f64>>,
    /// Kinetic plus potential energy at those times, J.
    pub(crate) energy: Vec<f64>,
    /// Largest joint error at those times, m.
    pub(crate) joint_error: f64,
    /// Work of the integrator.
    pub(crate) counts: StepCounts,
}

impl Problem {
    /// Integrates in the Lagrange form by `method` and evaluates the outputs at `times` (s, increasing).
    pub(crate) fn solve(
        &self,
        stabilisation: Stabilisation,
        method: &str,
        settings: StepSettings,
        times: &[f64],
    ) -> Result<Solved, StepError> {
        let mut system = Lagrange::new(self.mechanism.clone(), self.loads.clone(), stabilisation)
            .expect("a mechanism without fault");
        let mut y = system.initial();
        let mut stepper = start(method, settings, 0.0, &y).expect("registered");
        let (mut values, mut energy) = (Vec::new(), Vec::new());
        let mut joint_error: f64 = 0.0;
        for &t in times {
            // A step that ends within rounding of t has reached it.
            while stepper.time() < t * (1.0 - 1e-12) {
                stepper.step(&mut system)?;
            }
            stepper.interpolate(&mut system, t, &mut y);
            joint_error = joint_error.max(system.joint_error(t, &y));
            let observed = system.observe(t, &y, Detail::Everything);
            values.push((self.read)(&observed));
            energy.push(observed.kinetic_j + self.loads.potential(observed.bodies));
        }
        Ok(Solved {
            values,
            energy,
            joint_error,
            counts: stepper.counts(),
        })
    }
}
