//! Residuals of the stages over time, pins, places on a lobe and bodies.

use serde::Serialize;

use super::judged::Stage;

/// Places on a lobe.
const PLACES: usize = 24;

/// Horizontal axis of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// Time, s.
    Time,
    /// Number of the pin, ring pins first.
    Pins,
    /// Place of contact on a lobe, from the tip of one to that of the next: ring pins alone.
    Lobe,
    /// Coordinates, by their names.
    Coordinates,
}

/// Residual of a stage, as a share of what the stage is judged by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picture {
    /// The stage.
    pub stage: Stage,
    /// Horizontal axis.
    pub over: Over,
    /// Horizontal values.
    pub x: Vec<f64>,
    /// Names of the horizontal values, where numbers are none.
    pub names: Vec<String>,
    /// Curves: name and values; NaN where there is none.
    pub curves: Vec<(String, Vec<f64>)>,
}

impl Picture {
    /// Draws the largest residual of each row of named runs over time, s.
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

    /// Draws the root mean square of each column: of a pin, or of a named coordinate.
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

    /// Draws the root mean square at each place on a lobe, from pairs of a place, 0 to 1, and a residual.
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

/// Root mean square of numbered values; NaN where there is none.
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
