//! Headline figures of every engine of a track, window by window.

use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::{Comparison, Quantity, Track, quantities};
use pinwheel_courses::norms::Statistics;

use super::banner::VISIBLE_SHARE;
use super::window_label;
use crate::format;

/// One table: engines down, figures across.
pub(super) struct FigureTable {
    pub(super) window: String,
    /// Quantities with their unit and number of columns.
    pub(super) groups: Vec<ColumnGroup>,
    pub(super) rows: Vec<FigureRow>,
    pub(super) efficiency: bool,
}

/// The columns of one quantity.
pub(super) struct ColumnGroup {
    pub(super) label: String,
    pub(super) unit: String,
    pub(super) columns: Vec<&'static str>,
}

/// One engine's figures.
pub(super) struct FigureRow {
    pub(super) engine: String,
    pub(super) style: usize,
    pub(super) cells: Vec<FigureCell>,
    pub(super) efficiency: FigureCell,
}

/// One figure.
pub(super) struct FigureCell {
    pub(super) text: String,
    /// Below it: `± 0.007`, or another word.
    pub(super) below: String,
    /// What it is sorted by.
    pub(super) key: String,
}

/// A name of a statistic and how to take it.
type Column = (&'static str, fn(&Statistics) -> f64);

fn columns(quantity: &Quantity) -> &'static [Column] {
    if quantity.name == quantities::OUTPUT_TORQUE {
        &[("mean", |s| s.mean)]
    } else if quantity.is_torque() {
        &[("mean", |s| s.mean), ("min", |s| s.min), ("max", |s| s.max)]
    } else {
        &[("max", |s| s.max), ("mean", |s| s.mean), ("rms", |s| s.rms)]
    }
}

pub(super) fn tables(comparison: &Comparison, track: Track, styles: &[usize]) -> Vec<FigureTable> {
    let loads: Vec<&Quantity> = comparison
        .quantities
        .iter()
        .filter(|q| q.is_load())
        .collect();
    comparison
        .windows
        .iter()
        .map(|window| {
            let rows: Vec<FigureRow> = comparison
                .engines
                .iter()
                .zip(styles)
                .filter(|(e, _)| e.track == track || e.track == Track::Native)
                .filter_map(|(engine, &style)| row(engine, style, window.kind, &loads))
                .collect();
            FigureTable {
                window: window_label(comparison, window.kind),
                groups: loads
                    .iter()
                    .map(|q| ColumnGroup {
                        label: q.label.clone(),
                        unit: q.unit.clone(),
                        columns: columns(q).iter().map(|(name, _)| *name).collect(),
                    })
                    .collect(),
                efficiency: rows.iter().any(|row| row.efficiency.text != format::NONE),
                rows,
            }
        })
        .filter(|table| !table.rows.is_empty() && !table.groups.is_empty())
        .collect()
}

fn row(
    engine: &EngineSummary,
    style: usize,
    window: pinwheel_compare::WindowKind,
    loads: &[&Quantity],
) -> Option<FigureRow> {
    let figures = engine.figures.iter().find(|f| f.window == window)?;
    let cell = |value: Option<f64>, u: Option<f64>| {
        let bounded = value.map(|value| format::bounded(value, u, 0.0));
        let (text, below) = bounded.unwrap_or_else(|| (format::NONE.to_owned(), String::new()));
        FigureCell {
            text,
            below,
            key: value.map_or_else(String::new, |v| v.to_string()),
        }
    };
    let cells = loads
        .iter()
        .flat_map(|q| {
            let statistics = figures.quantities.get(&q.name);
            let known = engine
                .uncertainty
                .iter()
                .find(|u| u.window == window && u.quantity == q.name);
            columns(q).iter().map(move |(name, of)| {
                let u = known.and_then(|known| match *name {
                    "mean" => known.mean.u(),
                    "rms" => known.rms.u(),
                    "max" if !q.is_torque() => known.peak.u(),
                    _ => None,
                });
                cell(statistics.map(of), u)
            })
        })
        .collect();
    let percent = figures.efficiency.map(|e| 100.0 * e);
    let mut efficiency = cell(percent, None);
    let own = figures.efficiency.zip(figures.efficiency_accounted);
    if let Some((_, own)) = own.filter(|(plain, own)| (plain - own).abs() > VISIBLE_SHARE) {
        let own = format::figure(100.0 * own);
        efficiency.below = format!("{own} by losses");
    }
    Some(FigureRow {
        engine: engine.name.clone(),
        style,
        cells,
        efficiency,
    })
}
