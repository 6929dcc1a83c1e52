//! Figures of one quantity, with their columns.

use pinwheel_timeseries::norms::Statistics;
use serde::{Deserialize, Serialize};

/// Figures of one quantity over the window, jointly over its channels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WindowStatistics {
    /// Values of the figures.
    #[serde(flatten)]
    pub statistics: Statistics,
    /// Distance of the means of the window's halves from its mean, the effect of the window's position.
    #[serde(default)]
    pub drift: f64,
    /// Uncertainty of the figures from sampling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling: Option<Statistics>,
}

/// Figures in the order of their columns.
pub(super) const FIGURES: [(&str, fn(&Statistics) -> f64); 5] = [
    ("mean", |s| s.mean),
    ("min", |s| s.min),
    ("max", |s| s.max),
    ("rms", |s| s.rms),
    ("peak", |s| s.peak),
];

/// Returns the columns of figures that runs with these quantities may have; none without motion.
pub(super) fn columns_of<'a>(
    quantities: impl Iterator<Item = &'a str>,
    moves: bool,
) -> impl Iterator<Item = String> {
    let powers = ["efficiency", "efficiency_accounted"];
    let powers = powers.into_iter().filter(move |_| moves).map(str::to_owned);
    powers.chain(quantities.flat_map(|quantity| {
        let names = FIGURES.iter().map(|(figure, _)| *figure);
        names
            .map(move |figure| format!("{figure}_{quantity}"))
            .collect::<Vec<_>>()
    }))
}
