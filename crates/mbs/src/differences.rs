//! Finite-difference Jacobians for systems without an analytic one.

use serde::{Deserialize, Serialize};

use crate::{Jacobian, OdeSystem};

/// Difference step, relative to a component's scale, for which rounding and truncation errors are equal.
const SHARE: f64 = 6e-6;
/// Difference step of the time, relative to the current step.
const TIME_SHARE: f64 = 1e-4;

/// Derivatives by central differences, for systems without their own.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Differences {
    y: Vec<f64>,
    scale: Vec<f64>,
    ahead: Vec<f64>,
    behind: Vec<f64>,
}

impl Differences {
    pub(crate) fn new(dimension: usize) -> Self {
        let zeros = vec![0.0; dimension];
        Self {
            y: zeros.clone(),
            scale: zeros.clone(),
            ahead: zeros.clone(),
            behind: zeros,
        }
    }

    /// Writes all derivatives at (t, y), for a step of `h` (s); returns the number of evaluations.
    pub(crate) fn write(
        &mut self,
        system: &mut dyn OdeSystem,
        t: f64,
        y: &[f64],
        h: f64,
        jacobian: &mut Jacobian,
    ) -> u64 {
        jacobian.clear();
        system.scale(y, &mut self.scale);
        self.y.copy_from_slice(y);
        let first = y.len() - jacobian.time.len();
        for (k, &here) in y.iter().enumerate() {
            let step = SHARE * self.scale[k];
            let (high, low) = (here + step, here - step);
            self.y[k] = high;
            system.derivative(t, &self.y, &mut self.ahead);
            self.y[k] = low;
            system.derivative(t, &self.y, &mut self.behind);
            self.y[k] = here;
            let inverse = (high - low).recip();
            let (part, column) = match &mut jacobian.position {
                Some(position) if k < first => (position, k),
                _ => (&mut jacobian.rate, k - first),
            };
            let derivatives = self.ahead[first..].iter().zip(&self.behind[first..]);
            for (row, (ahead, behind)) in derivatives.enumerate() {
                part.add(row, column, (ahead - behind) * inverse);
            }
        }
        let (late, early) = (t + TIME_SHARE * h, t - TIME_SHARE * h);
        system.derivative(late, y, &mut self.ahead);
        system.derivative(early, y, &mut self.behind);
        let inverse = (late - early).recip();
        let derivatives = self.ahead[first..].iter().zip(&self.behind[first..]);
        for (time, (ahead, behind)) in jacobian.time.iter_mut().zip(derivatives) {
            *time = (ahead - behind) * inverse;
        }
        2 * (y.len() as u64 + 1)
    }
}
