//! RODAS5P: a Rosenbrock method of orders 5(4) with dense output of order 4 and a step from a tolerance, for stiff systems.
//!
//! ```text
//! (1/(h gamma) I - J) u_i = f(t + c_i h, y + sum_{j<i} a_ij u_j) + sum_{j<i} (C_ij/h) u_j + h d_i df/dt,    i = 1..8
//! y+ = (argument of the last stage) + u_8,      error = u_8,      J = df/dy at (t, y)
//! ```
//! [Steinebach 2023, BIT 63, 27], [Hairer & Wanner 1996, IV.7]. L-stable and stiffly accurate: what relaxes within a step is at
//! its rest at the end of the step. No iteration; a step costs 8 evaluations, one Jacobian and the factors of one matrix.
//! J is the system's own where it has one ([`OdeSystem::jacobian`]), else central differences; it must be exact, or the order is
//! lost. A rejected step keeps f and J. Step control: `h+ = h clamp(0.9 err^(-1/5), 0.2, 5)`, err being the RMS over all
//! components of error divided by tolerance times the system's scale; the step after a rejection does not grow.
//!
//! A narrow ramp of f (regularised friction) is only treated implicitly by steps that land on it: tolerance times the scale of
//! the rates must be smaller than the ramp, or the method jumps to and fro over it.

use super::rodas5p_coefficients::{A, C, D, GAMMA, H, STAGES, TIMES};
use super::{MethodInfo, StepCounts, StepError, Stepper, short_step};
use crate::OdeSystem;
use crate::differences::Differences;
use crate::jacobian::Jacobian;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "rodas5p",
    summary: "RODAS5P, Rosenbrock 5(4), steps from the tolerance, dense output: for friction and other stiffness at tight tolerances",
    order: 5,
    adaptive: true,
};

const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 5.0;
/// The step's exponent.
const EXPONENT: f64 = 0.2;

/// What is made when the first step shows how the system's f depends on y.
#[derive(Debug, Clone)]
struct Slopes {
    jacobian: Jacobian,
    /// `None` until the system has refused to tell its own.
    differences: Option<Differences>,
}

/// A run with steps from a tolerance.
#[derive(Debug, Clone)]
pub struct Rodas5p {
    tolerance: f64,
    time: f64,
    /// Next step to try, and the last one taken.
    h: f64,
    taken: f64,
    counts: StepCounts,
    y: Vec<f64>,
    /// State at the start of the last step.
    before: Vec<f64>,
    /// f at the current state.
    f: Vec<f64>,
    slopes: Option<Slopes>,
    /// u of the last step, and the argument of a stage.
    u: Vec<Vec<f64>>,
    argument: Vec<f64>,
    scale: Vec<f64>,
    /// Continuous extension of the last step, if `extended`.
    dense: [Vec<f64>; H.len()],
    extended: bool,
}

impl Rodas5p {
    /// Starts at (t, y) with a first step `h` (s) and a relative `tolerance` a step.
    #[must_use]
    pub fn new(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        let zeros = vec![0.0; y.len()];
        Self {
            tolerance,
            time: t,
            h,
            taken: h,
            counts: StepCounts::default(),
            y: y.to_vec(),
            before: y.to_vec(),
            f: zeros.clone(),
            slopes: None,
            u: vec![zeros.clone(); STAGES],
            argument: zeros.clone(),
            scale: zeros.clone(),
            dense: std::array::from_fn(|_| zeros.clone()),
            extended: false,
        }
    }

    /// f, J and df/dt at the current state.
    fn linearise<S: OdeSystem>(&mut self, system: &mut S) -> Result<(), StepError> {
        system.derivative(self.time, &self.y, &mut self.f);
        self.counts.evaluations += 1;
        if !self.f.iter().all(|x| x.is_finite()) {
            return Err(StepError::NotFinite { time: self.time });
        }
        let n = self.y.len();
        let slopes = self.slopes.get_or_insert_with(|| Slopes {
            jacobian: Jacobian::new(&system.structure(), n),
            differences: None,
        });
        slopes.jacobian.clear();
        self.counts.jacobians += 1;
        if !system.jacobian(self.time, &self.y, &mut slopes.jacobian) {
            let own = slopes
                .differences
                .get_or_insert_with(|| Differences::new(n));
            let (t, y) = (self.time, &self.y);
            self.counts.evaluations += own.write(system, t, y, self.h, &mut slopes.jacobian);
        }
        Ok(())
    }

    /// All stages of a step; `argument` becomes y+. False if a stage has no solution.
    fn stages<S: OdeSystem>(&mut self, system: &mut S) -> bool {
        let h = self.h;
        let Some(Slopes { jacobian, .. }) = &mut self.slopes else {
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
                system.derivative(self.time + TIMES[i] * h, &self.argument, u);
                self.counts.evaluations += 1;
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

    /// RMS of the scaled error; infinite if anything is not finite.
    fn error<S: OdeSystem>(&mut self, system: &S) -> f64 {
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

/// sum += factor sum_j row_j u_j.
fn add(row: &[f64], factor: f64, u: &[Vec<f64>], sum: &mut [f64]) {
    for (&weight, u) in row.iter().zip(u) {
        let weight = weight * factor;
        for (sum, u) in sum.iter_mut().zip(u) {
            *sum += weight * u;
        }
    }
}

impl<S: OdeSystem> Stepper<S> for Rodas5p {
    fn step(&mut self, system: &mut S) -> Result<(), StepError> {
        self.linearise(system)?;
        let mut limit = GROW;
        loop {
            if !(self.h > 4.0 * f64::EPSILON * self.time.abs().max(f64::MIN_POSITIVE)) {
                return Err(StepError::StepTooSmall { time: self.time });
            }
            let error = if self.stages(system) {
                self.error(system)
            } else {
                f64::INFINITY
            };
            let factor = SAFETY * error.max(1e-10).powf(-EXPONENT);
            if error <= 1.0 {
                std::mem::swap(&mut self.before, &mut self.y);
                std::mem::swap(&mut self.y, &mut self.argument);
                self.taken = self.h;
                self.time += self.h;
                self.h = short_step(self.h * factor.clamp(SHRINK, limit));
                system.settle(self.time, &mut self.y);
                self.extended = false;
                self.counts.steps += 1;
                return Ok(());
            }
            self.counts.rejected += 1;
            self.h = short_step(self.h * factor.max(SHRINK));
            limit = 1.0;
        }
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> &[f64] {
        &self.y
    }

    fn next_step(&self) -> f64 {
        self.h
    }

    fn shorten(&mut self, longest: f64) {
        self.h = self.h.min(longest);
    }

    fn interpolate(&mut self, system: &mut S, t: f64, y: &mut [f64]) {
        if self.counts.steps == 0 || (self.time - t).abs() < 1e-9 * self.taken {
            y.copy_from_slice(&self.y);
            return;
        }
        if !self.extended {
            self.extend();
        }
        let s = 1.0 - (self.time - t) / self.taken;
        let u = 1.0 - s;
        for (c, y) in y.iter_mut().enumerate() {
            let bend = self.dense[0][c] + s * (self.dense[1][c] + s * self.dense[2][c]);
            *y = u * self.before[c] + s * (self.y[c] + u * bend);
        }
        system.settle(t, y);
    }

    fn counts(&self) -> StepCounts {
        self.counts
    }
}
