//! Time and step size of a run, and the operations shared by all one-step methods: steps, interpolation, saving.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{StepCounts, StepError, Stepper, restored, saved, short_step};
use crate::OdeSystem;

/// Time and step of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Clock {
    /// End of the last accepted step, s.
    pub(super) time: f64,
    /// Next step to try, s.
    pub(super) h: f64,
    /// Last step taken, s.
    pub(super) taken: f64,
    pub(super) counts: StepCounts,
    /// Start time of a run with a fixed step, s; `None`: steps follow from a tolerance.
    pub(super) start: Option<f64>,
}

impl Clock {
    /// Creates a clock at `time` with a first step `h`; the next ones follow from a tolerance.
    pub(super) fn new(h: f64, time: f64) -> Self {
        Self {
            time,
            h,
            taken: h,
            counts: StepCounts::default(),
            start: None,
        }
    }

    /// Creates a clock at `time` with steps `h`. Times are n h, not sums of h.
    pub(super) fn fixed(h: f64, time: f64) -> Self {
        Self {
            start: Some(time),
            ..Self::new(h, time)
        }
    }

    /// Returns the end of the next step, s.
    pub(super) fn end(&self) -> f64 {
        match self.start {
            Some(start) => start + (self.counts.steps + 1) as f64 * self.h,
            None => self.time + self.h,
        }
    }

    /// Returns an error if rounding would make the step ineffective.
    pub(super) fn room(&self) -> Result<(), StepError> {
        if self.h > 4.0 * f64::EPSILON * self.time.abs().max(f64::MIN_POSITIVE) {
            Ok(())
        } else {
            Err(StepError::StepTooSmall { time: self.time })
        }
    }

    /// Accepts the step; the next has equal length.
    pub(super) fn advance(&mut self) {
        self.time = self.end();
        self.taken = self.h;
        self.counts.steps += 1;
    }

    /// Accepts the step; the next is `factor` times as long.
    pub(super) fn accept(&mut self, factor: f64) {
        self.advance();
        self.h = short_step(self.h * factor);
    }

    /// Rejects the step; the next attempt is `factor` times as long.
    pub(super) fn reject(&mut self, factor: f64) {
        self.counts.rejected += 1;
        self.h = short_step(self.h * factor);
    }
}

/// Method that provides the state inside its last step.
pub(super) trait Method: Serialize + DeserializeOwned + Send {
    fn clock(&self) -> &Clock;
    fn clock_mut(&mut self) -> &mut Clock;
    /// Returns the state at the end of the last accepted step.
    fn state(&self) -> &[f64];
    /// Makes one accepted step, see [`Stepper::step`].
    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError>;
    /// Writes the state at `t`, which lies inside the last accepted step and is not its end.
    fn inside(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]);
    /// Returns the last evaluated state; see [`Stepper::evaluated_state`].
    fn evaluated_state(&self) -> Option<&[f64]> {
        None
    }
    /// Restores the saved data of a run of the same method and settings.
    fn resume(&mut self, saved: Self) {
        *self = saved;
    }
}

impl<M: Method> Stepper for M {
    fn step(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        self.advance(system)
    }

    fn time(&self) -> f64 {
        self.clock().time
    }

    fn state(&self) -> &[f64] {
        Method::state(self)
    }

    fn next_step(&self) -> f64 {
        self.clock().h
    }

    fn shorten(&mut self, longest: f64) {
        let clock = self.clock_mut();
        if clock.start.is_none() {
            clock.h = clock.h.min(longest);
        }
    }

    fn interpolate(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        let clock = self.clock();
        if clock.counts.steps == 0 || (clock.time - t).abs() < 1e-9 * clock.taken {
            y.copy_from_slice(Method::state(self));
            return;
        }
        self.inside(system, t, y);
        system.project(t, y);
    }

    fn evaluated_state(&self) -> Option<&[f64]> {
        Method::evaluated_state(self)
    }

    fn counts(&self) -> StepCounts {
        self.clock().counts
    }

    fn save(&self) -> Vec<u8> {
        saved(self)
    }

    fn restore(&mut self, bytes: &[u8]) -> bool {
        restored(bytes).map(|saved| self.resume(saved)).is_some()
    }
}

/// Implements the accessors of [`Method`] for fields.
macro_rules! fields {
    ($clock:ident, $($state:ident).+) => {
        fn clock(&self) -> &Clock {
            &self.$clock
        }

        fn clock_mut(&mut self) -> &mut Clock {
            &mut self.$clock
        }

        fn state(&self) -> &[f64] {
            &self.$($state).+
        }
    };
}
pub(super) use fields;
