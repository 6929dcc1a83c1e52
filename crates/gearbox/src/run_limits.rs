//! Limits of a run, and its early end when adaptive steps become too short to complete the scene.

use pinwheel_mbs::integrators::{Family, method};

use crate::scene::Scene;

/// Number of steps between two checks for a stop; samples may be much farther apart.
const LOOK: u64 = 1000;
/// Number of accepted steps between two checks of the pace.
pub const SPAN: u64 = 20_000;
/// Largest number of remaining steps at the pace of the last [`SPAN`]: five minutes at ten microseconds a step. The largest
/// number of a useful run was 9e6 (`dopri5` on `hard-friction-narrow`, 0.6 s).
const MOST_STEPS: f64 = 3e7;

/// Limits of a run besides its scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    /// Longest step of an adaptive method, s.
    pub(crate) longest_step_s: f64,
    /// Number of evaluations after which the run ends as diverged.
    pub(crate) evaluations: u64,
    /// True if nothing is evaluated between samples, so that steps need not end there.
    pub(crate) samples_alone: bool,
}

impl Limits {
    /// No limits, as for a run with a named method.
    pub(crate) const NONE: Self = Self {
        longest_step_s: f64::INFINITY,
        evaluations: u64::MAX,
        samples_alone: false,
    };
}

/// Progress of one run with steps from a tolerance.
#[derive(Debug, Clone)]
pub struct Pace {
    /// Number of requested steps.
    steps: u64,
    end: f64,
    last: f64,
    next_look: u64,
    integrator: String,
    has_friction: bool,
}

impl Pace {
    /// Creates the progress at time 0 of a scene with or without friction of contacts.
    pub fn new(scene: &Scene, has_friction: bool) -> Self {
        Self {
            steps: 0,
            end: scene.solver.duration_s,
            last: 0.0,
            next_look: SPAN,
            integrator: scene.solver.integrator.clone(),
            has_friction,
        }
    }

    /// True if a check is due; call before each step.
    #[inline]
    pub(crate) fn is_due(&mut self) -> bool {
        let due = self.steps.is_multiple_of(LOOK);
        self.steps += 1;
        due
    }

    /// Checks a run that has reached `time` (s) in `steps` steps.
    ///
    /// # Errors
    /// Cost of completing the run, with a remedy.
    pub fn look(&mut self, time: f64, steps: u64) -> Result<(), String> {
        if steps < self.next_look {
            return Ok(());
        }
        let step = (time - self.last) / SPAN as f64;
        let left = (self.end - time) / step;
        self.last = time;
        self.next_look = steps + SPAN;
        if left > MOST_STEPS {
            // Rounded to two digits, a tenth below the time that is reached at this pace.
            let reached = format!("{:.1e}", time + 0.9 * MOST_STEPS * step);
            let reached: f64 = reached.parse().unwrap_or(time);
            let implicit = method(&self.integrator)
                .is_some_and(|method| method.family == Family::SplitImplicit);
            let remedy = if self.has_friction && !implicit {
                "set solver.integrator to \"imex2\" or \"auto\", which treat friction implicitly"
                    .to_owned()
            } else {
                format!(
                    "make solver.duration_s {reached} or less, or name a method with a fixed step in solver.integrator"
                )
            };
            return Err(format!(
                "{} has reduced its steps to {step:.1e} s, with {left:.0e} of them left: the forces are too stiff for \
                 it, or the run is too long; {remedy}",
                self.integrator
            ));
        }
        Ok(())
    }
}
