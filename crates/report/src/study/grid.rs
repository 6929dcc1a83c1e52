//! Figures over a grid of parameters, with selectable axes.

use serde::Serialize;

/// Figures of runs over every combination of some axes. The page draws lines along one axis, a map over two, and a panel
/// for each value of a third; the reader selects values of the other axes.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Grid {
    /// Varied keys.
    pub axes: Vec<GridAxis>,
    /// Figures of the runs, in display order.
    pub figures: Vec<GridFigure>,
    /// Index of each run on every axis.
    pub runs: Vec<Vec<usize>>,
}

/// Parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct GridAxis {
    /// Name and unit.
    pub label: String,
    /// Values as text.
    pub values: Vec<String>,
    /// Values as numbers in the label's unit; `None` if they are not numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub numbers: Option<Vec<f64>>,
}

/// Figure of every run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct GridFigure {
    /// Name and unit.
    pub label: String,
    /// Value of each run.
    pub values: Vec<Option<f64>>,
    /// Uncertainty of each, in the same unit; `None` if unknown.
    pub uncertainty: Vec<Option<f64>>,
}
