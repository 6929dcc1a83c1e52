//! The figures of one quantity, and the columns they take.

use serde::{Deserialize, Serialize};

/// Figures of one quantity over the window, all its channels together; NaN where one is not finite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    #[serde(deserialize_with = "number")]
    pub mean: f64,
    /// Smallest value.
    #[serde(deserialize_with = "number")]
    pub min: f64,
    /// Largest value.
    #[serde(deserialize_with = "number")]
    pub max: f64,
    /// Root mean square.
    #[serde(deserialize_with = "number")]
    pub rms: f64,
    /// Largest magnitude.
    #[serde(deserialize_with = "number")]
    pub peak: f64,
    /// How far the means of the window's halves are from its mean: what the window's place does to the mean.
    #[serde(default)]
    pub drift: f64,
}

/// A number, or nothing for one that is not finite: JSON has no others.
fn number<'de, D: serde::Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(source)?.unwrap_or(f64::NAN))
}

/// Figures in the order of their columns.
pub(super) const FIGURES: [(&str, fn(&Spread) -> f64); 5] = [
    ("mean", |s| s.mean),
    ("min", |s| s.min),
    ("max", |s| s.max),
    ("rms", |s| s.rms),
    ("peak", |s| s.peak),
];

/// Columns of figures that runs with these quantities may have; without motion there are none.
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
