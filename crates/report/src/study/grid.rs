//! Figures over a grid of parameters: the reader chooses the axes.

use serde::Serialize;

/// Figures of runs over every combination of some axes. The page draws lines along one axis, a map over two, and a panel
/// for each value of a third; what is on none of them is chosen. Every combination can be reached.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Grid {
    /// What was varied.
    pub axes: Vec<GridAxis>,
    /// What was found; the first is shown first.
    pub figures: Vec<GridFigure>,
    /// Of each run its place on every axis.
    pub runs: Vec<Vec<usize>>,
}

/// A parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct GridAxis {
    /// Name and unit.
    pub label: String,
    /// Values in words.
    pub values: Vec<String>,
    /// The same as numbers in the label's unit, where they are some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub numbers: Option<Vec<f64>>,
}

/// A figure of every run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct GridFigure {
    /// Name and unit.
    pub label: String,
    /// Of each run.
    pub values: Vec<Option<f64>>,
    /// How far each may be off, in the same unit; `None` where that is not known.
    pub uncertainty: Vec<Option<f64>>,
}
