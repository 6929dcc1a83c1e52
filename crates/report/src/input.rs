//! What a report is made from: a comparison, the time series behind it, and facts that only the caller
//! knows. Every string may hold any characters: all are escaped.

use pinwheel_compare::{Comparison, Participant};
use pinwheel_timeseries::table::Table;

use crate::animation::Animation;

/// Everything on the page.
#[derive(Debug, Clone)]
pub struct ReportInput<'a> {
    /// The comparison.
    pub comparison: &'a Comparison,
    /// The same participants the comparison was made from: their time series are drawn.
    pub participants: &'a [Participant],
    /// The gearbox in motion, if there is one to show, and the time it begins at, s.
    pub animation: Option<(Animation, f64)>,
    /// What was modelled, what was left out, what was assumed, each with the reason.
    pub model: Vec<Table>,
    /// Versions of the program and its parts, e.g. (`pinwheel`, `0.1.0`).
    pub versions: Vec<(String, String)>,
    /// The machine, e.g. (`processor`, ...), (`operating system`, ...).
    pub machine: Vec<(String, String)>,
    /// The command that repeats this comparison.
    pub command: String,
    /// The scene file with every key, as run.
    pub scene_toml: String,
    /// Date or run number shown in the footer; `None` keeps the page reproducible byte for byte.
    pub made: Option<String>,
}
