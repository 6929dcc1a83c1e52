//! Limits of a run; and the end of one whose adaptive steps have become so short that its own end is out of reach.

use pinwheel_mbs::integrators::{Family, method};

use crate::scene::Scene;

/// Steps from one look at whether the run must stop to the next; samples may be much farther apart.
const LOOK: u64 = 1000;
/// Accepted steps between two looks at the pace.
pub const SPAN: u64 = 20_000;
/// Steps that may be left at the pace of the last [`SPAN`]: at ten microseconds a step five minutes.
/// Measured most of a run worth having: 9e6 (`dopri5` on `hard-friction-narrow`, 0.6 s).
const MOST_STEPS: f64 = 3e7;

/// Limits of a run besides its scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    /// No step of an adaptive method is longer, s.
    pub(crate) longest_step_s: f64,
    /// The run ends as diverged after this many evaluations.
    pub(crate) evaluations: u64,
    /// Nothing is looked at between samples: steps need not end there.
    pub(crate) samples_alone: bool,
}

impl Limits {
    /// None: what a run with a named method has.
    pub(crate) const NONE: Self = Self {
        longest_step_s: f64::INFINITY,
        evaluations: u64::MAX,
        samples_alone: false,
    };
}

/// Progress of one run with steps from a tolerance.
#[derive(Debug, Clone)]
pub struct Pace {
    /// Steps asked for.
    steps: u64,
    end: f64,
    last: f64,
    next_look: u64,
    integrator: String,
    has_friction: bool,
}

impl Pace {
    /// At time 0 of a scene whose contacts rub or do not.
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

    /// Before each step: whether it is time to look.
    #[inline]
    pub(crate) fn is_due(&mut self) -> bool {
        let due = self.steps.is_multiple_of(LOOK);
        self.steps += 1;
        due
    }

    /// Looks at a run that has reached `time` in `steps` steps.
    ///
    /// # Errors
    /// Returns the cost of reaching the end, and a remedy.
    pub fn look(&mut self, time: f64, steps: u64) -> Result<(), String> {
        if steps < self.next_look {
            return Ok(());
        }
        let step = (time - self.last) / SPAN as f64;
        let left = (self.end - time) / step;
        self.last = time;
        self.next_look = steps + SPAN;
        if left > MOST_STEPS {
            // Two digits, and a tenth below what this pace reaches.
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
                "{} has come down to steps of {step:.1e} s, {left:.0e} of them to the end: the forces are too stiff for \
                 it, or the run is too long; {remedy}",
                self.integrator
            ));
        }
        Ok(())
    }
}
