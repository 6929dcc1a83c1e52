//! IMEX Runge-Kutta ARS(2,2,2), order 2 [Ascher, Ruuth, Spiteri 1997, sec. 2.6]: treats the stiff part i of f = e + i
//! implicitly and e explicitly, both at the same two stages.
//!
//! ```text
//! g = 1 - 1/sqrt 2,  d = 1 - 1/(2 g)
//! Y1 = y + h g e(y)                       + h g i(Y1)                       at t + g h
//! Y2 = y + h (d e(y) + (1-d) e(Y1))       + h ((1-g) i(Y1) + g i(Y2))       at t + h
//! y+ = Y2
//! ```
//! The implicit part is L-stable and stiffly accurate: components that relax within a step are relaxed at its end. Y2 is the
//! next step's y, so that a step costs two evaluations, like Heun's. For a system without an implicit part the method is
//! explicit, of second order.
//!
//! The state inside a step is a shorter step from the same start, so that friction in samples is as relaxed as at the ends of
//! steps; no interpolating polynomial ensures this.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::imex_adaptive::StepControl;
use super::{FIXED, Family, MethodInfo, StepError, check_finite};
use crate::OdeSystem;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "imex2",
    summary: "ARS(2,2,2), second order, fixed step, friction implicit: for scenes with friction",
    order: 2,
    family: Family::SplitImplicit,
    ..FIXED
};

/// Coefficient g.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
/// Coefficient d.
const DELTA: f64 = 1.0 - 0.5 / GAMMA;

/// State with both parts of its derivative.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Point {
    pub(super) y: Vec<f64>,
    pub(super) e: Vec<f64>,
    pub(super) i: Vec<f64>,
}

impl Point {
    fn new(y: &[f64]) -> Self {
        let zeros = vec![0.0; y.len()];
        Self {
            y: y.to_vec(),
            e: zeros.clone(),
            i: zeros,
        }
    }

    /// Evaluates both parts at a state without an implicit step.
    fn evaluate(&mut self, system: &mut dyn OdeSystem, t: f64) {
        system.split_stage(t, 0.0, &mut self.y, &mut self.e, &mut self.i);
    }
}

/// Makes one step of length `h` from `from` at `t` into `to`; `stage` is scratch for Y1.
fn advance(
    system: &mut dyn OdeSystem,
    t: f64,
    h: f64,
    from: &Point,
    stage: &mut Point,
    to: &mut Point,
) {
    for (k, y) in stage.y.iter_mut().enumerate() {
        *y = from.y[k] + h * GAMMA * from.e[k];
    }
    // Friction changes little between stages: that of the previous stage is the first estimate of the next.
    stage.i.copy_from_slice(&from.i);
    let a = h * GAMMA;
    system.split_stage(t + a, a, &mut stage.y, &mut stage.e, &mut stage.i);
    for (k, y) in to.y.iter_mut().enumerate() {
        let explicit = DELTA * from.e[k] + (1.0 - DELTA) * stage.e[k];
        *y = from.y[k] + h * (explicit + (1.0 - GAMMA) * stage.i[k]);
    }
    to.i.copy_from_slice(&stage.i);
    system.split_stage(t + h, a, &mut to.y, &mut to.e, &mut to.i);
}

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
