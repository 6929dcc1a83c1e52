//! A quantity that changes linearly over time.

use serde::{Deserialize, Serialize};

/// Value that changes linearly over time: value + slope (t - from).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LinearSignal {
    /// At `from_s`.
    pub value: f64,
    /// Its change a second.
    pub slope: f64,
    /// s
    pub from_s: f64,
}

impl LinearSignal {
    /// Its value at time `t`, s.
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.value + self.slope * (t - self.from_s)
    }
}
