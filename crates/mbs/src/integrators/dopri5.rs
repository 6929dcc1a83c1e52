//! Dormand and Prince's pair of orders 5(4) with dense output of order 4 and a step from a tolerance.
//!
//! ```text
//! k_i = f(t + c_i h, y + h sum_{j<i} a_ij k_j)      i = 1..7, the last stage is the next step's first
//! y+  = y + h sum b_i k_i,    error = h sum e_i k_i
//! ```
//! Coefficients and continuous extension: [Dormand & Prince 1980], [Hairer, Norsett, Wanner 1993, II.5-6]. Step control
//! (proportional-integral, [Gustafsson 1991]): `h+ = h clamp(0.9 err^-0.17 err_before^0.04, 0.2, 5)`, err being the RMS over
//! all components of error divided by tolerance times the system's scale. Results of a rejected step are discarded: only its
//! error shortens the next attempt, and the step after a rejection does not grow.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::weighted::{Row, each_sum, set_sum};
use super::{ADAPTIVE, Family, MethodInfo, StepError, check_finite};
use crate::OdeSystem;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "dopri5",
    summary: "Dormand-Prince 5(4), steps from the tolerance, dense output",
    order: 5,
    family: Family::Explicit,
    ..ADAPTIVE
};

const STAGES: usize = 7;

/// Lower triangle of a, row by row.
const A: [Row; STAGES] = [
    &[],
    &[(0, 1.0 / 5.0)],
    &[(0, 3.0 / 40.0), (1, 9.0 / 40.0)],
    &[(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)],
    &[
        (0, 19372.0 / 6561.0),
        (1, -25360.0 / 2187.0),
        (2, 64448.0 / 6561.0),
        (3, -212.0 / 729.0),
    ],
    &[
        (0, 9017.0 / 3168.0),
        (1, -355.0 / 33.0),
        (2, 46732.0 / 5247.0),
        (3, 49.0 / 176.0),
        (4, -5103.0 / 18656.0),
    ],
    &[
        (0, 35.0 / 384.0),
        (2, 500.0 / 1113.0),
        (3, 125.0 / 192.0),
        (4, -2187.0 / 6784.0),
        (5, 11.0 / 84.0),
    ],
];
const C: [f64; STAGES] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
/// Difference of b and the weights of the embedded method.
const E: Row = &[
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339_200.0),
    (5, 22.0 / 525.0),
    (6, -1.0 / 40.0),
];
/// Fourth coefficient of the continuous extension.
const D: Row = &[
    (0, -12_715_105_075.0 / 11_282_082_432.0),
    (2, 87_487_479_700.0 / 32_700_410_799.0),
    (3, -10_690_763_975.0 / 1_880_347_072.0),
    (4, 701_980_252_875.0 / 199_316_789_632.0),
    (5, -1_453_857_185.0 / 822_651_844.0),
    (6, 69_997_945.0 / 29_380_423.0),
];

const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 5.0;
/// Gains of the proportional-integral control for order 5.
const PROPORTIONAL: f64 = 0.2 - 0.75 * INTEGRAL;
const INTEGRAL: f64 = 0.04;

/// Run with steps from a tolerance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Dopri5 {
    tolerance: f64,
    clock: Clock,
    last_error: f64,
    y: Vec<f64>,
    next: Vec<f64>,
    k: Vec<Vec<f64>>,
    /// True if `k[0]` is f at the current state.
    fresh: bool,
    scale: Vec<f64>,
    dense: Dense,
}

/// Continuous extension of a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Dense {
    /// End of the step and its length, s.
    pub(super) end: f64,
    pub(super) taken: f64,
    /// State y0, then the coefficients.
    coefficients: [Vec<f64>; 5],
}

impl Dense {
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            end: 0.0,
            taken: 0.0,
            coefficients: std::array::from_fn(|_| vec![0.0; dimension]),
        }
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        (self.end, self.taken) = (other.end, other.taken);
        self.coefficients.clone_from(&other.coefficients);
    }

    /// Writes the state at `t`, which lies inside the step.
    pub(super) fn interpolate(&self, t: f64, y: &mut [f64]) {
        let s = 1.0 - (self.end - t) / self.taken;
        let u = 1.0 - s;
        for (c, y) in y.iter_mut().enumerate() {
            let d = |k: usize| self.coefficients[k][c];
            *y = d(0) + s * (d(1) + u * (d(2) + s * (d(3) + u * d(4))));
        }
    }
}

impl Dopri5 {
    /// Starts at (t, y) with a first step `h` (s) and a relative `tolerance` per step.
    pub fn new(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        let zeros = vec![0.0; y.len()];
        Self {
            tolerance,
            clock: Clock::new(h, t),
            last_error: 1e-4,
            y: y.to_vec(),
            next: zeros.clone(),
            k: vec![zeros.clone(); STAGES],
            fresh: false,
            scale: zeros.clone(),
            dense: Dense::new(y.len()),
        }
    }

    /// Restarts at (t, y) with a first step `h` (s); counts continue.
    pub(super) fn restart(&mut self, h: f64, t: f64, y: &[f64]) {
        self.clock = Clock {
            counts: self.clock.counts,
            ..Clock::new(h, t)
        };
        (self.last_error, self.fresh) = (1e-4, false);
        self.y.copy_from_slice(y);
    }

    /// Returns the last step's continuous extension.
    pub(super) fn dense(&self) -> &Dense {
        &self.dense
    }

    /// Computes all stages from `k[0]`; the result is in `next`.
    fn stages(&mut self, system: &mut dyn OdeSystem) {
        let h = self.clock.h;
        for i in 1..STAGES {
            let (known, rest) = self.k.split_at_mut(i);
            set_sum(&mut self.next, &self.y, h, A[i], known);
            let t = self.clock.time + C[i] * h;
            if i + 1 < STAGES {
                system.derivative(t, &self.next, &mut rest[0]);
            } else {
                system.derivative_at_end(t, &self.next, false, &mut rest[0]);
            }
            self.clock.counts.evaluations += 1;
        }
    }

    /// Returns the RMS of the scaled error; not finite if a number is not.
    fn error(&mut self, system: &dyn OdeSystem) -> f64 {
        system.scale(&self.next, &mut self.scale);
        let (mut sum, h, tolerance, scale) = (0.0, self.clock.h, self.tolerance, &self.scale[..]);
        each_sum::<{ E.len() }>(E, &self.k, scale.len(), |c, error| {
            let relative = h * error / (tolerance * scale[c]);
            sum += relative * relative;
        });
        (sum / self.y.len() as f64).sqrt()
    }

    fn remember(&mut self) {
        let h = self.clock.h;
        let n = self.y.len();
        let (y, next) = (&self.y[..n], &self.next[..n]);
        let (first, last) = (&self.k[0][..n], &self.k[STAGES - 1][..n]);
        let [d0, d1, d2, d3, d4] = self.dense.coefficients.each_mut().map(|d| &mut d[..n]);
        each_sum::<{ D.len() }>(D, &self.k, n, |c, fourth| {
            let change = next[c] - y[c];
            let bend = h * first[c] - change;
            (d0[c], d1[c], d2[c]) = (y[c], change, bend);
            (d3[c], d4[c]) = (change - h * last[c] - bend, h * fourth);
        });
        (self.dense.end, self.dense.taken) = (self.clock.time + h, h);
    }
}

impl Method for Dopri5 {
    fields!(clock, y);

    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        let time = self.clock.time;
        if !self.fresh {
            system.derivative(time, &self.y, &mut self.k[0]);
            self.clock.counts.evaluations += 1;
            self.fresh = true;
        }
        check_finite(&[&self.k[0]], time)?;
        let mut limit = GROW;
        loop {
            self.clock.room()?;
            self.stages(system);
            let error = self.error(system);
            if error <= 1.0 {
                let floor = error.max(1e-10);
                let factor = SAFETY * floor.powf(-PROPORTIONAL) * self.last_error.powf(INTEGRAL);
                self.remember();
                self.clock.accept(factor.clamp(SHRINK, limit));
                self.last_error = floor.max(1e-4);
                std::mem::swap(&mut self.y, &mut self.next);
                self.k.swap(0, STAGES - 1);
                system.project(self.clock.time, &mut self.y);
                return Ok(());
            }
            // 0 where the error is infinite.
            self.clock.reject((SAFETY * error.powf(-0.2)).max(SHRINK));
            if !pinwheel_faults::armed(pinwheel_faults::Fault::ForgottenRejection) {
                limit = 1.0;
            }
        }
    }

    fn evaluated_state(&self) -> Option<&[f64]> {
        Some(&self.y)
    }

    fn inside(&mut self, _system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        self.dense.interpolate(t, y);
    }
}
