//! What all methods share whose steps follow from a tolerance: where a run is, and how it goes on after a step.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{StepCounts, StepError, Stepper, restored, saved, short_step};
use crate::OdeSystem;

/// Where a run is.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Clock {
    /// End of the last accepted step, s.
    pub(super) time: f64,
    /// Next step to try, s.
    pub(super) h: f64,
    /// The last one taken, s.
    pub(super) taken: f64,
    pub(super) counts: StepCounts,
}

impl Clock {
    /// At `time` with a first step `h`.
    pub(super) fn new(h: f64, time: f64) -> Self {
        Self {
            time,
            h,
            taken: h,
            counts: StepCounts::default(),
        }
    }

    /// Refuses a step that rounding would swallow.
    pub(super) fn room(&self) -> Result<(), StepError> {
        if self.h > 4.0 * f64::EPSILON * self.time.abs().max(f64::MIN_POSITIVE) {
            Ok(())
        } else {
            Err(StepError::StepTooSmall { time: self.time })
        }
    }

    /// The step tried is taken; the next is `factor` times as long.
    pub(super) fn accept(&mut self, factor: f64) {
        self.taken = self.h;
        self.time += self.h;
        self.h = short_step(self.h * factor);
        self.counts.steps += 1;
    }

    /// The step tried is not taken; the next attempt is `factor` times as long.
    pub(super) fn reject(&mut self, factor: f64) {
        self.counts.rejected += 1;
        self.h = short_step(self.h * factor);
    }
}

/// A method whose steps follow from a tolerance.
pub(super) trait Adaptive: Serialize + DeserializeOwned + Send {
    fn clock(&self) -> &Clock;
    fn clock_mut(&mut self) -> &mut Clock;
    /// State at the end of the last accepted step.
    fn state(&self) -> &[f64];
    /// One accepted step, see [`Stepper::step`].
    fn advance<S: OdeSystem>(&mut self, system: &mut S) -> Result<(), StepError>;
    /// Writes the state at `t`, which lies inside the last accepted step and is not its end.
    fn inside<S: OdeSystem>(&mut self, system: &mut S, t: f64, y: &mut [f64]);
}

impl<S: OdeSystem, A: Adaptive> Stepper<S> for A {
    fn step(&mut self, system: &mut S) -> Result<(), StepError> {
        self.advance(system)
    }

    fn time(&self) -> f64 {
        self.clock().time
    }

    fn state(&self) -> &[f64] {
        Adaptive::state(self)
    }

    fn next_step(&self) -> f64 {
        self.clock().h
    }

    fn shorten(&mut self, longest: f64) {
        let clock = self.clock_mut();
        clock.h = clock.h.min(longest);
    }

    fn interpolate(&mut self, system: &mut S, t: f64, y: &mut [f64]) {
        let clock = self.clock();
        if clock.counts.steps == 0 || (clock.time - t).abs() < 1e-9 * clock.taken {
            y.copy_from_slice(Adaptive::state(self));
            return;
        }
        self.inside(system, t, y);
        system.settle(t, y);
    }

    fn counts(&self) -> StepCounts {
        self.clock().counts
    }

    fn save(&self) -> Vec<u8> {
        saved(self)
    }

    fn restore(&mut self, bytes: &[u8]) -> bool {
        restored(self, bytes)
    }
}
