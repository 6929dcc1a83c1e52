//! Explicit Runge-Kutta methods with a fixed step, from their Butcher tableau.
//!
//! ```text
//! k_i = f(t + c_i h, y + h sum_{j<i} a_ij k_j),   y+ = y + h sum b_i k_i
//! ```
//! Between steps the state is the cubic Hermite polynomial through both ends and their
//! derivatives [Hairer, Norsett, Wanner 1993, II.6]; the derivative at the end is the first stage
//! of the next step and is evaluated once. Times are n h, not sums of h.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::weighted::{Row, set_sum};
use super::{StepError, check_finite};
use crate::OdeSystem;

/// Coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tableau {
    /// Stage weights.
    pub a: &'static [Row],
    /// Step weights.
    pub b: Row,
    /// Stage times.
    pub c: &'static [f64],
}

/// Fixed-step run of one tableau.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FixedStep {
    /// Tableau of the run; not saved.
    #[serde(skip, default = "none")]
    tableau: &'static Tableau,
    clock: Clock,
    y: Vec<f64>,
    /// State and derivative one step ago.
    y_before: Vec<f64>,
    f_before: Vec<f64>,
    stages: Vec<Vec<f64>>,
    /// True if `stages[0]` holds f at the current state.
    fresh: bool,
    scratch: Vec<f64>,
}

/// Returns a placeholder for the tableau until it is restored.
fn none() -> &'static Tableau {
    &super::heun::TABLEAU
}

impl FixedStep {
    /// Starts at (t, y) with step `h` (s).
    pub fn new(tableau: &'static Tableau, h: f64, t: f64, y: &[f64]) -> Self {
        let n = y.len();
        Self {
            tableau,
            clock: Clock::fixed(h, t),
            y: y.to_vec(),
            y_before: y.to_vec(),
            f_before: vec![0.0; n],
            stages: vec![vec![0.0; n]; tableau.a.len()],
            fresh: false,
            scratch: vec![0.0; n],
        }
    }

    fn evaluate_first_stage(&mut self, system: &mut dyn OdeSystem) {
        if !self.fresh {
            system.derivative(self.clock.time, &self.y, &mut self.stages[0]);
            self.clock.counts.evaluations += 1;
            self.fresh = true;
        }
    }
}

impl Method for FixedStep {
    fields!(clock, y);

    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        let (h, t, end) = (self.clock.h, self.clock.time, self.clock.end());
        self.evaluate_first_stage(system);
        for i in 1..self.stages.len() {
            let (known, rest) = self.stages.split_at_mut(i);
            set_sum(&mut self.scratch, &self.y, h, self.tableau.a[i], known);
            system.derivative(t + self.tableau.c[i] * h, &self.scratch, &mut rest[0]);
            self.clock.counts.evaluations += 1;
        }
        set_sum(&mut self.scratch, &self.y, h, self.tableau.b, &self.stages);
        system.project(end, &mut self.scratch);
        check_finite(&[&self.scratch], end)?;
        std::mem::swap(&mut self.y_before, &mut self.y);
        std::mem::swap(&mut self.f_before, &mut self.stages[0]);
        std::mem::swap(&mut self.y, &mut self.scratch);
        self.fresh = false;
        self.clock.advance();
        Ok(())
    }

    fn inside(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        self.evaluate_first_stage(system);
        let h = self.clock.h;
        let s = 1.0 + (t - self.clock.time) / h;
        let u = 1.0 - s;
        let (w0, w1) = ((1.0 + 2.0 * s) * u * u, (1.0 + 2.0 * u) * s * s);
        let (d0, d1) = (h * s * u * u, -h * s * s * u);
        for (i, y) in y.iter_mut().enumerate() {
            *y = w0 * self.y_before[i]
                + w1 * self.y[i]
                + d0 * self.f_before[i]
                + d1 * self.stages[0][i];
        }
    }

    fn resume(&mut self, saved: Self) {
        let tableau = self.tableau;
        *self = Self { tableau, ..saved };
    }
}
