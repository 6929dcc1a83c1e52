//! Run of ARS(2,2,2), with a fixed step or with steps from a tolerance.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::imex::{Point, advance};
use super::imex_adaptive::StepControl;
use super::{StepError, check_finite};
use crate::OdeSystem;

/// Run with a fixed step, or with steps from a tolerance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Imex {
    /// Control of the step; `None`: fixed.
    control: Option<StepControl>,
    clock: Clock,
    time_before: f64,
    before: Point,
    now: Point,
    stage: Point,
    next: Point,
    /// True if the derivatives at `now` are known.
    fresh: bool,
}

impl Imex {
    /// Starts at (t, y) with step `h` (s).
    pub fn fixed(h: f64, t: f64, y: &[f64]) -> Self {
        let point = Point::new(y);
        Self {
            control: None,
            clock: Clock::fixed(h, t),
            time_before: t,
            before: point.clone(),
            now: point.clone(),
            stage: point.clone(),
            next: point,
            fresh: false,
        }
    }

    /// Starts at (t, y) with a first step `h` (s); `tolerance` is relative, of the entire run.
    pub fn adaptive(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        Self {
            control: Some(StepControl::new(tolerance, y.len())),
            clock: Clock::new(h, t),
            ..Self::fixed(h, t, y)
        }
    }
}

impl Method for Imex {
    fields!(clock, now.y);

    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        let t = self.clock.time;
        if !self.fresh {
            self.now.evaluate(system, t);
            self.clock.counts.evaluations += 1;
            self.fresh = true;
        }
        check_finite(&[&self.now.e, &self.now.i], t)?;
        loop {
            self.clock.room()?;
            let h = self.clock.h;
            advance(system, t, h, &self.now, &mut self.stage, &mut self.next);
            self.clock.counts.evaluations += 2;
            let next = &self.next;
            let Some(control) = &mut self.control else {
                check_finite(&[&next.y, &next.e, &next.i], self.clock.end())?;
                self.clock.advance();
                break;
            };
            match control.judge(system, h, &self.now, next) {
                (true, factor) => {
                    self.clock.accept(factor);
                    break;
                }
                (false, factor) => self.clock.reject(factor),
            }
        }
        self.time_before = t;
        system.project(self.clock.time, &mut self.next.y);
        std::mem::swap(&mut self.before, &mut self.now);
        std::mem::swap(&mut self.now, &mut self.next);
        Ok(())
    }

    fn inside(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        let h = self.clock.taken - (self.clock.time - t);
        let (stage, next) = (&mut self.stage, &mut self.next);
        advance(system, self.time_before, h, &self.before, stage, next);
        y.copy_from_slice(&self.next.y);
    }
}
