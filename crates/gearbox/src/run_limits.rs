//! Limits of a run; and the end of one whose adaptive steps have become so short that its own end is out of reach.

use pinwheel_mbs::integrators::{Family, method};

use crate::scene::Scene;

/// Steps from one look at whether the run must stop to the next; samples may be much farther apart.
const LOOK: u64 = 1000;
/// Accepted steps between two looks at the pace.
const SPAN: u64 = 20_000;
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
pub(crate) struct Pace {
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
    pub(crate) fn new(scene: &Scene, has_friction: bool) -> Self {
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
    pub(crate) fn look(&mut self, time: f64, steps: u64) -> Result<(), String> {
        if steps < self.next_look {
            return Ok(());
        }
        let step = (time - self.last) / SPAN as f64;
        let left = (self.end - time) / step;
        self.last = time;
        self.next_look = steps + SPAN;
        if left > MOST_STEPS {
            let implicit = method(&self.integrator)
                .is_some_and(|method| method.family == Family::SplitImplicit);
            let remedy = if self.has_friction && !implicit {
                "set solver.integrator to \"imex2\" or \"auto\", which treat friction implicitly"
            } else {
                "raise solver.tolerance, or name a method with a fixed step in solver.integrator"
            };
            return Err(format!(
                "{} has come down to steps of {step:.1e} s, {left:.0e} of them to the end: the forces are too stiff for \
                 it; {remedy}",
                self.integrator
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_pace_without_end_is_refused() {
        let mut scene = Scene::paper();
        scene.solver.integrator = "dopri5".to_owned();
        let mut pace = Pace::new(&scene, false);
        assert_eq!(pace.look(1e-12, SPAN - 1), Ok(()), "too early to tell");
        assert_eq!(pace.look(0.01, SPAN), Ok(()));
        // A short passage of tiny steps at a switch is over before anybody looks.
        assert_eq!(pace.look(0.02, 2 * SPAN), Ok(()));
        let told = pace.look(0.02 + 1e-6, 3 * SPAN).unwrap_err();
        assert!(
            told.contains("5.0e-11 s") && told.contains("solver.tolerance"),
            "{told}"
        );
        // An implicit method is the remedy for friction, but for one that is implicit.
        for (integrator, remedy) in [("dopri5", "\"imex2\""), ("imex2-adaptive", "tolerance")] {
            scene.solver.integrator = integrator.to_owned();
            let told = Pace::new(&scene, true).look(1e-9, SPAN).unwrap_err();
            assert!(told.contains(remedy), "{told}");
        }
    }
}
