//! Limits that figures are to keep.

use serde::Serialize;

/// A limit of a specification, on a column of the results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limit {
    /// The column.
    pub figure: String,
    /// Not less than that.
    pub least: Option<f64>,
    /// Not more than that.
    pub most: Option<f64>,
}

impl Limit {
    /// Whether a figure keeps it; what is not there does not.
    #[must_use]
    pub fn holds(&self, value: Option<f64>) -> bool {
        value.is_some_and(|x| {
            self.least.is_none_or(|least| x >= least) && self.most.is_none_or(|most| x <= most)
        })
    }
}
