//! The pairwise matrices: numbers on a ground whose depth is their magnitude.

use pinwheel_compare::comparison::{Cell, Matrix};
use pinwheel_compare::{Comparison, Metric, Track, WindowKind};

use super::pairs::pair_id;
use super::{Mark, mark, quantity_label, window_label};
use crate::format;

/// Decades of the colour scale: from rounding to unrelated.
const DECADES: f64 = 12.0;

/// One matrix.
pub(super) struct MatrixView {
    pub(super) title: String,
    pub(super) window: &'static str,
    pub(super) engines: Vec<String>,
    pub(super) rows: Vec<MatrixRow>,
}

/// One engine's row.
pub(super) struct MatrixRow {
    pub(super) engine: String,
    /// `None` on the diagonal.
    pub(super) cells: Vec<Option<CellView>>,
}

/// One pair.
pub(super) struct CellView {
    pub(super) text: String,
    /// The uncertainty of that number, `± 3·10⁻⁷`, or else how it was measured.
    pub(super) u: String,
    /// 0 to 1 on the colour scale, for the style sheet.
    pub(super) heat: String,
    pub(super) mark: Mark,
    /// The details of the pair further down.
    pub(super) target: String,
    /// What a screen reader says.
    pub(super) spoken: String,
}

pub(super) fn of_track(comparison: &Comparison, track: Track) -> Vec<MatrixView> {
    comparison
        .matrices
        .iter()
        .filter(|matrix| matrix.track == track)
        .map(|matrix| view(comparison, matrix))
        .collect()
}

fn view(comparison: &Comparison, matrix: &Matrix) -> MatrixView {
    let rows = (0..matrix.engines.len())
        .map(|i| MatrixRow {
            engine: matrix.engines[i].clone(),
            cells: (0..matrix.engines.len())
                .map(|j| {
                    matrix
                        .cell(i, j)
                        .map(|cell| cell_view(comparison, matrix, cell))
                })
                .collect(),
        })
        .collect();
    MatrixView {
        title: window_label(comparison, matrix.window),
        window: matrix.window.word(),
        engines: matrix.engines.clone(),
        rows,
    }
}

fn cell_view(comparison: &Comparison, matrix: &Matrix, cell: &Cell) -> CellView {
    let result = &cell.result;
    let mark = mark(result);
    let metric = result.metric.map_or("", Metric::label);
    let mut of = metric.to_owned();
    if let Some(name) = &cell.quantity {
        let label = quantity_label(comparison, name).to_lowercase();
        of = format!("{of} of the {label}");
    }
    let window = match matrix.window {
        WindowKind::Whole => "whole run",
        kind => kind.word(),
    };
    CellView {
        spoken: format!(
            "{} and {}, {window}, {}, {of}",
            matrix.engines[cell.column], matrix.engines[cell.row], mark.word
        ),
        text: format::relative_or_none(result.difference.map(f64::abs)),
        // A limit's figure has none.
        u: match result.combined() {
            Some(u) => format!("\u{b1}\u{202f}{}", format::relative(u)),
            None => metric.to_owned(),
        },
        heat: format!("{:.2}", result.difference.map_or(0.0, |d| heat(d.abs()))),
        mark,
        target: pair_id(cell.pair),
    }
}

/// Where a relative difference stands between 10^-12 (0) and 1 (1).
fn heat(relative: f64) -> f64 {
    if relative > 0.0 {
        (1.0 + relative.log10() / DECADES).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_is_logarithmic() {
        assert_eq!(heat(0.0), 0.0);
        assert_eq!(heat(1.0), 1.0);
        assert_eq!(heat(3.0), 1.0);
        assert!((heat(1e-6) - 0.5).abs() < 1e-12);
        assert_eq!(heat(f64::NAN), 0.0);
    }
}
