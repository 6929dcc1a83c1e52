//! Dormand and Prince's method of order 8 with error estimates of orders 5 and 3, dense output of order 7 and a step from a
//! tolerance: for smooth intervals and high accuracy.
//!
//! ```text
//! k_i = f(t + c_i h, y + h sum_{j<i} a_ij k_j)      i = 1..12;  y+ by row 13, whose k is the next step's first
//! err = h |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2),      |e| the RMS over the components of sum e_i k_i/(tolerance scale)
//! h+  = h clamp(0.9 err^(-1/8), 1/3, 6)
//! ```
//! [Hairer, Norsett, Wanner 1993, II.5 and II.10]. The continuous extension takes three more evaluations, only for steps with
//! samples inside. Results of a rejected step are discarded; the step after a rejection does not grow.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::dop853_coefficients::{A, C, D, E3, E5, EXTENDED, STAGES};
use super::weighted::{each_sum, set_scaled, set_sum};
use super::{ADAPTIVE, Family, MethodInfo, StepError, check_finite};
use crate::OdeSystem;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "dop853",
    summary: "Dormand-Prince 8(5,3), steps from the tolerance, dense output: for smooth motion and many digits",
    order: 8,
    family: Family::Explicit,
    ..ADAPTIVE
};

const SAFETY: f64 = 0.9;
const SHRINK: f64 = 1.0 / 3.0;
const GROW: f64 = 6.0;
/// Exponent of the step control.
const EXPONENT: f64 = 1.0 / 8.0;
/// Number of coefficients of the continuous extension besides the state at the start.
const DENSE: usize = 7;

/// Run with steps from a tolerance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Dop853 {
    tolerance: f64,
    clock: Clock,
    y: Vec<f64>,
    /// State at the start of the last step.
    before: Vec<f64>,
    /// Stages of the last step; `k[STAGES]` is f at `y` if `fresh`.
    k: Vec<Vec<f64>>,
    fresh: bool,
    /// Stages and result of the step being tried.
    trial: Vec<Vec<f64>>,
    next: Vec<f64>,
    scale: Vec<f64>,
    /// Continuous extension of the last step, if `extended`.
    dense: [Vec<f64>; DENSE],
    extended: bool,
}

impl Dop853 {
    /// Starts at (t, y) with a first step `h` (s) and a relative `tolerance` per step.
    pub fn new(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        let zeros = vec![0.0; y.len()];
        Self {
            tolerance,
            clock: Clock::new(h, t),
            y: y.to_vec(),
            before: y.to_vec(),
            k: vec![zeros.clone(); EXTENDED],
            fresh: false,
            trial: vec![zeros.clone(); EXTENDED],
            next: zeros.clone(),
            scale: zeros.clone(),
            dense: std::array::from_fn(|_| zeros.clone()),
            extended: false,
        }
    }

    /// Evaluates f at the current state.
    fn refresh(&mut self, system: &mut dyn OdeSystem) {
        if !self.fresh {
            system.derivative(self.clock.time, &self.y, &mut self.k[STAGES]);
            self.clock.counts.evaluations += 1;
            self.fresh = true;
        }
    }

    /// Computes all stages from `trial[0]`; the result is in `next`.
    fn stages(&mut self, system: &mut dyn OdeSystem) {
        for i in 1..=STAGES {
            set_sum(&mut self.next, &self.y, self.clock.h, A[i], &self.trial);
            if i < STAGES {
                system.derivative(
                    self.clock.time + C[i] * self.clock.h,
                    &self.next,
                    &mut self.trial[i],
                );
                self.clock.counts.evaluations += 1;
            }
        }
    }

    /// Returns the error of the module; infinite if a number is not finite.
    fn error(&mut self, system: &dyn OdeSystem) -> f64 {
        system.scale(&self.next, &mut self.scale);
        let (mut fifth, mut third) = (0.0, 0.0);
        let (tolerance, scale) = (self.tolerance, &self.scale[..]);
        each_sum::<{ E5.len() }>(E5, &self.trial, scale.len(), |c, error| {
            fifth += (error / (tolerance * scale[c])).powi(2);
        });
        each_sum::<{ E3.len() }>(E3, &self.trial, scale.len(), |c, error| {
            third += (error / (tolerance * scale[c])).powi(2);
        });
        if fifth == 0.0 && third == 0.0 {
            return 0.0;
        }
        let norm = self.clock.h * fifth / ((fifth + 0.01 * third) * self.y.len() as f64).sqrt();
        if norm.is_finite() && self.next.iter().all(|x| x.is_finite()) {
            norm
        } else {
            f64::INFINITY
        }
    }

    /// Computes the continuous extension of the last step.
    fn extend(&mut self, system: &mut dyn OdeSystem) {
        self.refresh(system);
        let (h, start) = (self.clock.taken, self.clock.time - self.clock.taken);
        for i in STAGES + 1..EXTENDED {
            set_sum(&mut self.next, &self.before, h, A[i], &self.k);
            system.derivative(start + C[i] * h, &self.next, &mut self.k[i]);
            self.clock.counts.evaluations += 1;
        }
        for c in 0..self.y.len() {
            let change = self.y[c] - self.before[c];
            let (first, last) = (h * self.k[0][c], h * self.k[STAGES][c]);
            self.dense[0][c] = change;
            self.dense[1][c] = first - change;
            self.dense[2][c] = 2.0 * change - (first + last);
        }
        for (row, dense) in D.iter().zip(&mut self.dense[3..]) {
            set_scaled::<{ D[0].len() }>(dense, h, row, &self.k);
        }
        self.extended = true;
    }
}

impl Method for Dop853 {
    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        self.refresh(system);
        self.trial[0].copy_from_slice(&self.k[STAGES]);
        check_finite(&[&self.trial[0]], self.clock.time)?;
        let mut limit = GROW;
        loop {
            self.clock.room()?;
            self.stages(system);
            let error = self.error(system);
            if error <= 1.0 {
                std::mem::swap(&mut self.k, &mut self.trial);
                std::mem::swap(&mut self.before, &mut self.y);
                std::mem::swap(&mut self.y, &mut self.next);
                let factor = SAFETY * error.max(1e-12).powf(-EXPONENT);
                self.clock.accept(factor.clamp(SHRINK, limit));
                system.project(self.clock.time, &mut self.y);
                (self.fresh, self.extended) = (false, false);
                return Ok(());
            }
            // 0 where the error is infinite.
            self.clock
                .reject((SAFETY * error.powf(-EXPONENT)).max(SHRINK));
            limit = 1.0;
        }
    }

    fields!(clock, y);

    fn inside(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        if !self.extended {
            self.extend(system);
        }
        let s = 1.0 - (self.clock.time - t) / self.clock.taken;
        let u = 1.0 - s;
        for (c, y) in y.iter_mut().enumerate() {
            let mut sum = 0.0;
            for (i, dense) in self.dense.iter().enumerate().rev() {
                sum = (sum + dense[c]) * if i % 2 == 0 { s } else { u };
            }
            *y = self.before[c] + sum;
        }
    }
}
