//! Every metric of every pair, for those who want to look deeper.

use pinwheel_compare::comparison::PairEntry;
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::{Comparison, Quantity, Track, Verdict};

use super::{Mark, mark};
use crate::format::{self, relative_or_none, significant};

/// One pair with all its quantities and windows.
pub(super) struct PairView {
    pub(super) id: String,
    pub(super) a: String,
    pub(super) b: String,
    pub(super) rows: Vec<PairRow>,
}

/// One quantity in one window.
pub(super) struct PairRow {
    pub(super) window: &'static str,
    pub(super) quantity: String,
    pub(super) mark: Mark,
    /// In the order of [`COLUMNS`].
    pub(super) cells: Vec<String>,
    /// Why there are no metrics or no verdict.
    pub(super) reason: String,
}

/// Names of the metrics and what they mean.
pub(super) const COLUMNS: [(&str, &str); 13] = [
    ("L2", "RMS of the difference over the larger RMS"),
    ("L\u{221e}", "largest difference over the larger peak"),
    ("end", "difference of the last sample, relative"),
    ("mean", "difference of the means, relative"),
    ("peak", "difference of the peaks, relative"),
    ("rms", "difference of the RMS values, relative"),
    ("mean a/b", "mean of the first over mean of the second"),
    ("peak a/b", "peak of the first over peak of the second"),
    ("rms a/b", "RMS of the first over RMS of the second"),
    (
        "M",
        "Sprague\u{2013}Geers magnitude, first measured on second",
    ),
    ("P", "Sprague\u{2013}Geers phase"),
    (
        "C",
        "Sprague\u{2013}Geers comprehensive error, larger over smaller",
    ),
    (
        "largest difference",
        "in the quantity's unit, and where it is",
    ),
];

/// The anchor of a pair's details; a native pair may stand in several tracks.
pub(super) fn pair_id(track: Track, pair: usize) -> String {
    format!("pair-{track}-{pair}")
}

/// The pairs that stand in a track's matrices or belong to the track.
pub(super) fn of_track(comparison: &Comparison, track: Track) -> Vec<PairView> {
    let in_matrix = |k: usize| {
        comparison
            .matrices
            .iter()
            .filter(|matrix| matrix.track == track)
            .any(|matrix| matrix.cells.iter().any(|cell| cell.pair == k))
    };
    comparison
        .pairs
        .iter()
        .enumerate()
        .filter(|(k, pair)| pair.track == track || in_matrix(*k))
        .map(|(k, pair)| PairView {
            id: pair_id(track, k),
            a: pair.a.clone(),
            b: pair.b.clone(),
            rows: pair
                .entries
                .iter()
                .map(|entry| row(comparison, entry))
                .collect(),
        })
        .collect()
}

fn row(comparison: &Comparison, entry: &PairEntry) -> PairRow {
    let quantity = comparison
        .quantities
        .iter()
        .find(|q| q.name == entry.quantity);
    let reason = match &entry.verdict {
        Verdict::NotJudged { reason } => reason.clone(),
        _ => String::new(),
    };
    PairRow {
        window: entry.window.word(),
        quantity: quantity.map_or_else(|| entry.quantity.clone(), |q| q.label.clone()),
        mark: mark(&entry.verdict),
        cells: match &entry.metrics {
            Some(metrics) => cells(metrics, quantity),
            None => vec![format::NONE.to_owned(); COLUMNS.len()],
        },
        reason,
    }
}

fn cells(metrics: &PairMetrics, quantity: Option<&Quantity>) -> Vec<String> {
    let ratio =
        |value: Option<f64>| value.map_or_else(|| format::NONE.to_owned(), |v| significant(v, 6));
    let errors = metrics.sprague_geers;
    vec![
        relative_or_none(metrics.relative_l2),
        relative_or_none(metrics.relative_linf),
        relative_or_none(metrics.end_value),
        relative_or_none(metrics.mean_difference),
        relative_or_none(metrics.peak_difference),
        relative_or_none(metrics.rms_difference),
        ratio(metrics.mean_ratio),
        ratio(metrics.peak_ratio),
        ratio(metrics.rms_ratio),
        relative_or_none(errors.map(|e| e.magnitude)),
        relative_or_none(errors.map(|e| e.phase)),
        relative_or_none(metrics.sprague_geers_c),
        largest(metrics, quantity),
    ]
}

/// The largest difference with its unit, channel and time.
fn largest(metrics: &PairMetrics, quantity: Option<&Quantity>) -> String {
    let Some((value, worst)) = metrics.difference_max.zip(metrics.worst.as_ref()) else {
        return format::NONE.to_owned();
    };
    let unit = quantity.map_or("", |q| q.unit.as_str());
    let channel = match quantity {
        Some(q) if q.channels.len() > 1 => format!(", no. {}", worst.channel),
        _ => String::new(),
    };
    let time = (worst.time_s * 1e9).round() / 1e9;
    format!(
        "{}\u{202f}{unit} at {time}\u{202f}s{channel}",
        significant(value, 2)
    )
}
