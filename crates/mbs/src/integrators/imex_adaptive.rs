//! ARS(2,2,2) with steps from a tolerance.
//!
//! Both derivatives at the end of a step are known, because its last stage is the next step's first. The trapezoidal rule, also
//! of order 2, therefore costs nothing; its difference from the step is the error estimate:
//!
//! ```text
//! est = y + h/2 (f(y) + f(y+)) - y+,   err = max_k |est_k| / scale_k
//! h+  = h clamp(0.9 (target/err)^(1/3), 0.2, 2)
//! ```
//! Where a contact begins to slide or stick, f jumps, est falls in proportion to h only, and steps shorten: the switches are
//! approached, not located.
//! `target` is tolerance^(3/2): a method of order 2 then needs about tolerance^(-1/2) steps, and the error of the run, not of a
//! step, is proportional to the tolerance.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::imex::{Point, advance};
use super::{ADAPTIVE, Family, MethodInfo, StepError, check_finite};
use crate::OdeSystem;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "imex2-adaptive",
    summary: "ARS(2,2,2), second order, steps from the tolerance, friction implicit",
    order: 2,
    family: Family::SplitImplicit,
    step_power: 0.5,
    usual_tolerance: 1e-3,
    ..ADAPTIVE
};

/// Safety factor on the step that the estimate allows.
const SAFETY: f64 = 0.9;
/// Shortest and longest next step, relative to the present one.
const SHRINK: f64 = 0.2;
const GROW: f64 = 2.0;

/// Adaptive run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ImexAdaptive {
    target: f64,
    clock: Clock,
    time_before: f64,
    before: Point,
    now: Point,
    stage: Point,
    next: Point,
    scale: Vec<f64>,
    fresh: bool,
}

impl ImexAdaptive {
    /// Starts at (t, y) with a first step `h` (s); `tolerance` is relative, of the entire run.
    pub fn new(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        let point = Point::new(y);
        Self {
            target: tolerance * tolerance.sqrt(),
            clock: Clock::new(h, t),
            time_before: t,
            before: point.clone(),
            now: point.clone(),
            stage: point.clone(),
            scale: y.to_vec(),
            next: point,
            fresh: false,
        }
    }

    fn accept(&mut self, system: &mut dyn OdeSystem, factor: f64) {
        self.time_before = self.clock.time;
        self.clock.accept(factor);
        system.project(self.clock.time, &mut self.next.y);
        std::mem::swap(&mut self.before, &mut self.now);
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Returns the error estimate of the module; NaN or infinite if a number is.
    fn error(&mut self, system: &dyn OdeSystem, h: f64) -> f64 {
        system.scale(&self.next.y, &mut self.scale);
        let (from, to) = (&self.now, &self.next);
        let mut worst: f64 = 0.0;
        for k in 0..to.y.len() {
            let derivatives = (from.e[k] + from.i[k]) + (to.e[k] + to.i[k]);
            let error = (from.y[k] - to.y[k] + 0.5 * h * derivatives).abs();
            let scaled = error / self.scale[k];
            // f64::max would ignore a NaN.
            if !(scaled <= worst) {
                worst = scaled;
            }
            if worst.is_nan() {
                break;
            }
        }
        worst
    }
}

impl Method for ImexAdaptive {
    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        if !self.fresh {
            self.now.evaluate(system, self.clock.time);
            self.clock.counts.evaluations += 1;
            self.fresh = true;
        }
        check_finite(&[&self.now.e, &self.now.i], self.clock.time)?;
        loop {
            self.clock.room()?;
            let h = self.clock.h;
            let (t, stage, next) = (self.clock.time, &mut self.stage, &mut self.next);
            advance(system, t, h, &self.now, stage, next);
            self.clock.counts.evaluations += 2;
            let share = self.error(system, h) / self.target;
            // A step that cannot be evaluated is far too long.
            let factor = if share.is_finite() {
                (SAFETY * share.powf(-1.0 / 3.0)).clamp(SHRINK, GROW)
            } else {
                SHRINK
            };
            if share <= 1.0 {
                self.accept(system, factor);
                return Ok(());
            }
            self.clock.reject(factor.min(SAFETY));
        }
    }

    fields!(clock, now.y);

    fn inside(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        let (begin, stage, next) = (self.time_before, &mut self.stage, &mut self.next);
        advance(system, begin, t - begin, &self.before, stage, next);
        y.copy_from_slice(&self.next.y);
    }
}
