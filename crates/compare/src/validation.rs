//! A simulation against measured data: ASME V&V 20-2009.
//!
//! E = S - D; u_val^2 = u_num^2 + u_input^2 + u_D^2. Where |E| <= k u_val the data cannot tell the model from the
//! truth at that level; else the model is off by something in E - k u_val to E + k u_val. The three parts are standard
//! uncertainties (one standard deviation), which add as squares because their causes are independent.

use serde::Serialize;

/// k for about 95 %.
pub const COVERAGE: f64 = 2.0;

/// The three parts of the validation uncertainty, relative as the error is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Budget {
    /// u_num: of the simulation's numerics.
    pub numerical: f64,
    /// u_input: of the scene's inputs.
    pub input: f64,
    /// u_D: of the data.
    pub data: f64,
}

/// Uncertainties that the owner of measured data states: standard uncertainties, relative to the larger of simulation
/// and data as the metric is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataUncertainty {
    /// Name of the measured participant.
    pub engine: String,
    /// Quantity, a pattern.
    pub quantity: String,
    /// u_D.
    pub data: f64,
    /// u_input: how far the uncertain inputs move this quantity of the simulation.
    pub input: f64,
}

impl Budget {
    /// The budget where u_num comes from a bound: a grid convergence index covers about 95 % (k = 2).
    #[must_use]
    pub fn new(numerical_bound: f64, input: f64, data: f64) -> Self {
        Self {
            numerical: numerical_bound / COVERAGE,
            input,
            data,
        }
    }

    /// u_val.
    #[must_use]
    pub fn validation(&self) -> f64 {
        self.numerical.hypot(self.input).hypot(self.data)
    }

    /// Shares of the three parts in u_val^2, for a bar: numerical, input, data; `None` where all are 0.
    #[must_use]
    pub fn shares(&self) -> Option<[f64; 3]> {
        let whole = self.validation();
        let share = |part: f64| (part / whole).powi(2);
        (whole > 0.0).then(|| [self.numerical, self.input, self.data].map(share))
    }

    /// Returns the bound below which an error cannot be distinguished from zero: k u_val.
    #[must_use]
    pub fn bound(&self) -> f64 {
        COVERAGE * self.validation()
    }
}
