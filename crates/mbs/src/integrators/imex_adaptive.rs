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

use super::imex::Point;
use super::{ADAPTIVE, Family, MethodInfo};
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

/// Control of the step by the error estimate of the module.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StepControl {
    target: f64,
    scale: Vec<f64>,
}

impl StepControl {
    /// Creates the control for a relative `tolerance` of the entire run.
    pub(super) fn new(tolerance: f64, dimension: usize) -> Self {
        Self {
            target: tolerance * tolerance.sqrt(),
            scale: vec![0.0; dimension],
        }
    }

    /// True if a step of length `h` is accepted; with the length of the next one or of the next attempt, relative to it.
    pub(super) fn judge(
        &mut self,
        system: &dyn OdeSystem,
        h: f64,
        from: &Point,
        to: &Point,
    ) -> (bool, f64) {
        let share = self.error(system, h, from, to) / self.target;
        // A step that cannot be evaluated is far too long.
        let factor = if share.is_finite() {
            (SAFETY * share.powf(-1.0 / 3.0)).clamp(SHRINK, GROW)
        } else {
            SHRINK
        };
        let accepted = share <= 1.0;
        (accepted, if accepted { factor } else { factor.min(SAFETY) })
    }

    /// Returns the error estimate of the module; NaN or infinite if a number is.
    fn error(&mut self, system: &dyn OdeSystem, h: f64, from: &Point, to: &Point) -> f64 {
        system.scale(&to.y, &mut self.scale);
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
