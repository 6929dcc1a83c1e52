//! Quantity that changes linearly over time.

use serde::{Deserialize, Serialize};

/// Value that changes linearly over time: value + slope (t - from).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LinearSignal {
    /// Value at `from_s`.
    pub value: f64,
    /// Change per second.
    pub slope: f64,
    /// Start time, s.
    pub from_s: f64,
}

impl LinearSignal {
    /// Returns the value at time `t`, s.
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.value + self.slope * (t - self.from_s)
    }
}
