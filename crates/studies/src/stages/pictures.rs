//! Plots of the residuals of the stages over time, pins, positions on a lobe and coordinates.

use serde::Serialize;

use super::judged::Stage;

/// Number of bins along a lobe.
const PLACES: usize = 24;

/// Horizontal axis of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// Time, s.
    Time,
    /// Number of the pin, ring pins first.
    Pins,
    /// Position of the contact on a lobe, from tip to tip; ring pins only.
    Lobe,
    /// Coordinates, by their names.
    Coordinates,
}

/// Plot of the residual of a stage, relative to the quantity that the stage is judged by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picture {
    /// Stage of the residual.
    pub stage: Stage,
    /// Horizontal axis.
    pub over: Over,
    /// Horizontal values.
    pub x: Vec<f64>,
    /// Names of the horizontal values if they are not numbers.
    pub names: Vec<String>,
    /// Curves: name and values; NaN where undefined.
    pub curves: Vec<(String, Vec<f64>)>,
}

impl Picture {
    /// Plots the largest residual of each row of named runs over time, s.
    pub(super) fn over_time(stage: Stage, times: &[f64], runs: &[(&str, &[Vec<f64>])]) -> Self {
        let most = |row: &Vec<f64>| row.iter().fold(0.0, |most: f64, off| most.max(off.abs()));
        let curve = |(name, rows): &(&str, &[Vec<f64>])| {
            let values = rows.iter().map(most);
            ((*name).to_owned(), values.collect())
        };
        Self {
            stage,
            over: Over::Time,
            x: times.to_vec(),
            names: Vec::new(),
            curves: runs.iter().map(curve).collect(),
        }
    }

    /// Plots the root mean square of each column, for pins or for named coordinates.
    pub(super) fn over_columns(stage: Stage, rows: &[Vec<f64>], names: Vec<String>) -> Self {
        let count = rows.first().map_or(0, Vec::len);
        let all = rows.iter().flat_map(|row| row.iter().copied().enumerate());
        let over = match names.is_empty() {
            true => Over::Pins,
            false => Over::Coordinates,
        };
        Self {
            stage,
            over,
            x: (0..count).map(|column| column as f64).collect(),
            names,
            curves: vec![("residual".to_owned(), mean(count, all))],
        }
    }

    /// Plots the root mean square at each position on a lobe, from pairs of a position, 0 to 1, and a residual.
    pub(super) fn over_lobe(stage: Stage, at: impl Iterator<Item = (f64, f64)>) -> Self {
        let place = |(lobe, off)| ((lobe * PLACES as f64) as usize % PLACES, off);
        let centre = |place: usize| (place as f64 + 0.5) / PLACES as f64;
        Self {
            stage,
            over: Over::Lobe,
            x: (0..PLACES).map(centre).collect(),
            names: Vec::new(),
            curves: vec![("ring pins".to_owned(), mean(PLACES, at.map(place)))],
        }
    }
}

/// Returns the root mean square of numbered values; NaN without a value.
fn mean(count: usize, values: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); count];
    for (number, off) in values {
        let (square, of) = &mut sums[number];
        *square += off * off;
        *of += 1.0;
    }
    let root = |(square, of): &(f64, f64)| (square / of).sqrt();
    sums.iter().map(root).collect()
}
