//! Runs in segments between times at which f has a jump or a kink.
//!
//! A method of order p has its order only where f has p derivatives. A step over a jump of f has order 1 with any method; an
//! adaptive method shortens its steps before the jump, a fixed one does not. Therefore no step passes such a time. The last
//! step of a segment is shortened to end there, and the method restarts with its first step, a new derivative and no memory.
//! Both ends of a segment have the f of that segment ([`OdeSystem::restart_at`]).

use pinwheel_faults::{Fault, armed};

use super::{StepCounts, StepError, StepSettings, Stepper, restored, saved, start};
use crate::OdeSystem;

/// Distance from a segment's end, in steps of the settings, below which it is reached.
const THERE: f64 = 1e-9;

/// Method during a run that is divided into segments.
pub struct Segments {
    method: String,
    settings: StepSettings,
    stepper: Box<dyn Stepper>,
    /// Ends of future segments, the last first.
    ends: Vec<f64>,
    /// Work of the earlier steppers.
    past: StepCounts,
    /// Longest step of a method that chooses its steps, s.
    longest: f64,
    /// Next requested time, s.
    stop_time: f64,
}

impl Segments {
    /// Starts the method `name` at (t, y); `breaks` (s) must increase, those up to `t` are ignored. `None` if there is no such
    /// method.
    pub fn start(
        name: &str,
        settings: StepSettings,
        t: f64,
        y: &[f64],
        breaks: &[f64],
    ) -> Option<Self> {
        let coming = breaks.iter().rev().copied();
        Some(Self {
            method: name.to_owned(),
            settings,
            stepper: start(name, settings, t, y)?,
            ends: coming.filter(|&end| end > t).collect(),
            past: StepCounts::default(),
            longest: f64::INFINITY,
            stop_time: f64::INFINITY,
        })
    }

    /// Bounds the steps of a method that chooses them: after a smooth interval its estimates miss changes within a long step.
    #[must_use]
    pub fn with_longest(mut self, step: f64) -> Self {
        self.longest = step;
        self
    }

    /// Returns the end of the present segment, s; infinite for the last.
    pub fn end(&self) -> f64 {
        self.ends.last().copied().unwrap_or(f64::INFINITY)
    }

    /// Enters the next segment with the present state; no effect before the end of a segment.
    pub fn enter(&mut self, system: &mut dyn OdeSystem) {
        if self.end() - self.stepper.time() > THERE * self.settings.step {
            return;
        }
        if let Some(from) = self.ends.pop() {
            if !armed(Fault::PassedBreak) {
                self.restart(from, self.settings.step);
            }
            system.restart_at(from);
        }
    }

    /// Restarts the method at the current state, with a first or only step `step`.
    fn restart(&mut self, time: f64, step: f64) {
        let settings = StepSettings {
            step,
            ..self.settings
        };
        if let Some(stepper) = start(&self.method, settings, time, self.stepper.state()) {
            self.past = self.counts();
            self.stepper = stepper;
        }
    }
}

impl Stepper for Segments {
    /// Makes a step of the method; a step that begins at the end of a segment enters the next.
    fn step(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        if armed(Fault::PassedBreak) {
            return self.stepper.step(system);
        }
        self.enter(system);
        self.stepper.shorten(self.longest);
        // The end of a segment is a requested time, too.
        let stop_time = self.stop_time.min(self.end());
        self.stepper.set_stop_time(stop_time);
        let end = self.end();
        if end < f64::INFINITY {
            let (time, step) = (self.stepper.time(), self.stepper.next_step());
            if time + step > end + THERE * step {
                self.restart(time, end - time);
                self.stepper.set_stop_time(stop_time);
            }
        }
        self.stepper.step(system)
    }

    fn time(&self) -> f64 {
        self.stepper.time()
    }

    fn state(&self) -> &[f64] {
        self.stepper.state()
    }

    fn next_step(&self) -> f64 {
        self.stepper.next_step()
    }

    fn set_stop_time(&mut self, time: f64) {
        self.stop_time = time;
    }

    fn interpolate(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        self.stepper.interpolate(system, t, y);
    }

    fn evaluated_state(&self) -> Option<&[f64]> {
        self.stepper.evaluated_state()
    }

    fn counts(&self) -> StepCounts {
        self.past + self.stepper.counts()
    }

    fn save(&self) -> Vec<u8> {
        saved(&(&self.ends, self.past, self.stop_time, self.stepper.save()))
    }

    fn restore(&mut self, bytes: &[u8]) -> bool {
        let all: Option<(Vec<f64>, StepCounts, f64, Vec<u8>)> = restored(bytes);
        let Some((ends, past, stop_time, stepper)) = all else {
            return false;
        };
        let known = self.stepper.restore(&stepper);
        if known {
            (self.ends, self.past, self.stop_time) = (ends, past, stop_time);
        }
        known
    }
}
