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

use super::{FIXED, Family, MethodInfo};
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
    pub(super) fn new(y: &[f64]) -> Self {
        let zeros = vec![0.0; y.len()];
        Self {
            y: y.to_vec(),
            e: zeros.clone(),
            i: zeros,
        }
    }

    /// Evaluates both parts at a state without an implicit step.
    pub(super) fn evaluate(&mut self, system: &mut dyn OdeSystem, t: f64) {
        system.split_stage(t, 0.0, &mut self.y, &mut self.e, &mut self.i);
    }
}

/// Makes one step of length `h` from `from` at `t` into `to`; `stage` is scratch for Y1.
pub(super) fn advance(
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
