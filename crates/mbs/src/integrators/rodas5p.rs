//! RODAS5P: a Rosenbrock method of orders 5(4) with dense output of order 4 and a step from a tolerance, for stiff systems.
//!
//! ```text
//! (1/(h gamma) I - J) u_i = f(t + c_i h, y + sum_{j<i} a_ij u_j) + sum_{j<i} (C_ij/h) u_j + h d_i df/dt,    i = 1..8
//! y+ = (argument of the last stage) + u_8,      error = u_8,      J = df/dy at (t, y)
//! ```
//! [Steinebach 2023, BIT 63, 27], [Hairer & Wanner 1996, IV.7]. L-stable and stiffly accurate: components that relax within a
//! step are relaxed at its end. No iteration; a step costs 8 evaluations, one Jacobian and one matrix factorisation. J is the
//! system's own ([`OdeSystem::jacobian`]), else by central differences; the order requires an exact J. A rejected step keeps f
//! and J. Step control: `h+ = h clamp(0.9 err^(-1/5), 0.2, 5)`, err being the RMS over all components of error divided by
//! tolerance times the system's scale; the step after a rejection does not grow.
//!
//! A narrow ramp of f (regularised friction) is treated implicitly only by steps that end on it. Tolerance times the scale of
//! the rates must be smaller than the ramp, or the method jumps back and forth over it.

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Method, fields};
use super::rodas5p_coefficients::{A, C, D, GAMMA, H, STAGES, TIMES};
use super::{ADAPTIVE, Family, MethodInfo, StepError, check_finite};
use crate::OdeSystem;
use crate::differences::Differences;
use crate::jacobian::Jacobian;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "rodas5p",
    summary: "RODAS5P, Rosenbrock 5(4), steps from the tolerance, dense output: for friction and other stiffness at tight tolerances",
    order: 5,
    family: Family::Rosenbrock,
    ..ADAPTIVE
};

const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 5.0;
/// Exponent of the step control.
const EXPONENT: f64 = 0.2;

/// Run with steps from a tolerance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Rodas5p {
    tolerance: f64,
    clock: Clock,
    y: Vec<f64>,
    /// State at the start of the last step.
    before: Vec<f64>,
    /// Derivative f at the current state.
    f: Vec<f64>,
    /// Jacobian; `None` until the first step has read the system's structure.
    jacobian: Option<Jacobian>,
    /// Differences; `None` unless the system has no derivatives of its own.
    differences: Option<Differences>,
    /// Stages u of the last step, and the argument of a stage.
    u: Vec<Vec<f64>>,
    argument: Vec<f64>,
    scale: Vec<f64>,
    /// Continuous extension of the last step, if `extended`.
    dense: [Vec<f64>; H.len()],
    extended: bool,
}

impl Rodas5p {
    /// Starts at (t, y) with a first step `h` (s) and a relative `tolerance` per step.
    pub fn new(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        let zeros = vec![0.0; y.len()];
        Self {
            tolerance,
            clock: Clock::new(h, t),
            y: y.to_vec(),
            before: y.to_vec(),
            f: zeros.clone(),
            jacobian: None,
            differences: None,
            u: vec![zeros.clone(); STAGES],
            argument: zeros.clone(),
            scale: zeros.clone(),
            dense: std::array::from_fn(|_| zeros.clone()),
            extended: false,
        }
    }

    /// Evaluates f, J and df/dt at the current state.
    fn linearise(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        system.derivative(self.clock.time, &self.y, &mut self.f);
        self.clock.counts.evaluations += 1;
        check_finite(&[&self.f], self.clock.time)?;
        let n = self.y.len();
        let new = || Jacobian::new(&system.structure(), n);
        let jacobian = self.jacobian.get_or_insert_with(new);
        jacobian.clear();
        self.clock.counts.jacobians += 1;
        if !system.jacobian(self.clock.time, &self.y, jacobian) {
            let own = &mut self.differences;
            let own = own.get_or_insert_with(|| Differences::new(n));
            let (t, y, h) = (self.clock.time, &self.y, self.clock.h);
            self.clock.counts.evaluations += own.write(system, t, y, h, jacobian);
        }
        Ok(())
    }

    /// Computes all stages of a step; `argument` becomes y+. Returns false if a stage has no solution.
    fn stages(&mut self, system: &mut dyn OdeSystem) -> bool {
        let h = self.clock.h;
        let Some(jacobian) = &mut self.jacobian else {
            return false;
        };
        if !jacobian.factor(1.0 / (h * GAMMA)) {
            return false;
        }
        self.argument.copy_from_slice(&self.y);
        for i in 0..STAGES {
            let (known, rest) = self.u.split_at_mut(i);
            let u = &mut rest[0];
            if let Some(row) = A.get(i) {
                self.argument.copy_from_slice(&self.y);
                add(row, 1.0, known, &mut self.argument);
            } else {
                add(&[1.0], 1.0, &known[i - 1..], &mut self.argument);
            }
            if i == 0 {
                u.copy_from_slice(&self.f);
            } else {
                system.derivative(self.clock.time + TIMES[i] * h, &self.argument, u);
                self.clock.counts.evaluations += 1;
            }
            add(C[i], 1.0 / h, known, u);
            if D[i] != 0.0 {
                jacobian.add_time(h * D[i], u);
            }
            jacobian.solve(u);
        }
        add(&[1.0], 1.0, &self.u[STAGES - 1..], &mut self.argument);
        true
    }

    /// Returns the RMS of the scaled error; infinite if a number is not finite.
    fn error(&mut self, system: &dyn OdeSystem) -> f64 {
        system.scale(&self.argument, &mut self.scale);
        let mut sum = 0.0;
        for (error, scale) in self.u[STAGES - 1].iter().zip(&self.scale) {
            let relative = error / (self.tolerance * scale);
            sum += relative * relative;
        }
        let norm = (sum / self.y.len() as f64).sqrt();
        if norm.is_finite() && self.argument.iter().all(|x| x.is_finite()) {
            norm
        } else {
            f64::INFINITY
        }
    }

    fn extend(&mut self) {
        for (row, dense) in H.iter().zip(&mut self.dense) {
            dense.fill(0.0);
            add(row, 1.0, &self.u, dense);
        }
        self.extended = true;
    }
}

/// Adds weighted stages: sum += factor sum_j row_j u_j.
fn add(row: &[f64], factor: f64, u: &[Vec<f64>], sum: &mut [f64]) {
    for (&weight, u) in row.iter().zip(u) {
        let weight = weight * factor;
        for (sum, u) in sum.iter_mut().zip(u) {
            *sum += weight * u;
        }
    }
}

impl Method for Rodas5p {
    fn advance(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        self.linearise(system)?;
        let mut limit = GROW;
        loop {
            self.clock.room()?;
            let error = if self.stages(system) {
                self.error(system)
            } else {
                f64::INFINITY
            };
            let factor = SAFETY * error.max(1e-10).powf(-EXPONENT);
            if error <= 1.0 {
                std::mem::swap(&mut self.before, &mut self.y);
                std::mem::swap(&mut self.y, &mut self.argument);
                self.clock.accept(factor.clamp(SHRINK, limit));
                system.project(self.clock.time, &mut self.y);
                self.extended = false;
                return Ok(());
            }
            self.clock.reject(factor.max(SHRINK));
            limit = 1.0;
        }
    }

    fields!(clock, y);

    fn inside(&mut self, _system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        if !self.extended {
            self.extend();
        }
        let s = 1.0 - (self.clock.time - t) / self.clock.taken;
        let u = 1.0 - s;
        for (c, y) in y.iter_mut().enumerate() {
            let bend = self.dense[0][c] + s * (self.dense[1][c] + s * self.dense[2][c]);
            *y = u * self.before[c] + s * (self.y[c] + u * bend);
        }
    }
}
