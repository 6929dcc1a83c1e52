//! Comparison of a simulation with measured data by ASME V&V 20-2009.
//!
//! E = S - D; u_val^2 = u_num^2 + u_input^2 + u_D^2. Where |E| <= k u_val the data cannot distinguish the model from the truth;
//! otherwise the model error is within E - k u_val to E + k u_val. The three parts are standard uncertainties (one standard
//! deviation), which add as squares because their causes are independent.

use serde::Serialize;

/// Coverage factor k for about 95 %.
pub const COVERAGE: f64 = 2.0;

/// Parts of the validation uncertainty, relative to the same figure as the error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Budget {
    /// u_num: standard uncertainty of the simulation's numerics.
    pub numerical: f64,
    /// u_input: standard uncertainty from the scene's inputs.
    pub input: f64,
    /// u_D: standard uncertainty of the data.
    pub data: f64,
}

/// Uncertainties that the owner of measured data states: standard uncertainties, relative to the larger of simulation
/// and data as the metric is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataUncertainty {
    /// Name of the measured participant.
    pub engine: String,
    /// Pattern of quantities.
    pub quantity: String,
    /// u_D: standard uncertainty of the data.
    pub data: f64,
    /// u_input: change of this quantity of the simulation with the uncertain inputs.
    pub input: f64,
}

impl Budget {
    /// Returns the budget with u_num from a bound: a grid convergence index covers about 95 % (k = 2).
    pub fn new(numerical_bound: f64, input: f64, data: f64) -> Self {
        Self {
            numerical: numerical_bound / COVERAGE,
            input,
            data,
        }
    }

    /// Returns u_val.
    pub fn validation(&self) -> f64 {
        self.numerical.hypot(self.input).hypot(self.data)
    }

    /// Returns the shares of numerical, input and data uncertainty in u_val^2; `None` where all are 0.
    pub fn shares(&self) -> Option<[f64; 3]> {
        let total = self.validation();
        let share = |part: f64| (part / total).powi(2);
        (total > 0.0).then(|| [self.numerical, self.input, self.data].map(share))
    }

    /// Returns the bound below which an error cannot be distinguished from zero: k u_val.
    pub fn bound(&self) -> f64 {
        COVERAGE * self.validation()
    }
}
