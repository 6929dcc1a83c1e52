//! Least, mean and largest of some values.

use serde::Serialize;

/// Least, mean and largest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Least.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

impl Spread {
    /// Returns the spread of `values`; not finite if empty.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let (mut min, mut max, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0_u32);
        for value in values {
            (min, max) = (min.min(value), max.max(value));
            sum += value;
            count += 1;
        }
        Self {
            min,
            mean: sum / f64::from(count),
            max,
        }
    }
}
