//! One line for each pair, and behind it everything that was judged and measured of it.

use std::collections::BTreeMap;

use pinwheel_compare::comparison::{EngineEntry, PairEntry};
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::{Against, Assessment, Comparison, Metric, Quantity, Track, Verdict};

use serde::Serialize;

use super::{Mark, mark, quantity_label};
use crate::format::{self, NONE, relative, relative_or_none, significant};
use crate::words;

/// One pair, or one engine against the load.
pub(super) struct PairView {
    pub(super) id: String,
    pub(super) name: String,
    pub(super) mark: Mark,
    /// What its verdicts amount to.
    pub(super) said: String,
    /// Of which quantity and window.
    pub(super) of: String,
    /// Shown unfolded: it differs, or is what one came for.
    pub(super) open: bool,
    pub(super) judged: Vec<JudgedRow>,
    /// Why rows are not resolved, each reason once.
    pub(super) unresolved: Vec<String>,
    /// Quantities and windows without a verdict, by reason.
    pub(super) unjudged: Vec<(String, String)>,
    pub(super) metrics: Vec<MetricRow>,
    /// As [`Assessment::rank`].
    rank: u8,
    order: f64,
}

/// Pairs of one verdict.
pub(super) struct PairGroup {
    /// What they have in common where they are too many to be listed at once.
    pub(super) folded: Option<String>,
    pub(super) pairs: Vec<PairView>,
}

/// One number that was judged.
pub(super) struct JudgedRow {
    pub(super) mark: Mark,
    pub(super) quantity: String,
    pub(super) window: &'static str,
    pub(super) metric: &'static str,
    pub(super) value: (String, String),
    /// What it was held against.
    pub(super) against: String,
    /// Value over that, in per cent for the bar.
    pub(super) bar: Option<String>,
    pub(super) words: String,
    unresolved: Option<String>,
    order: (u8, f64),
}

/// One quantity in one window.
#[derive(Serialize)]
pub(super) struct MetricRow {
    pub(super) window: &'static str,
    pub(super) quantity: String,
    /// In the order of [`COLUMNS`].
    pub(super) cells: Vec<String>,
}

/// Names of the metrics and what they mean.
const COLUMNS: [(&str, &str); 13] = [
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

/// The anchor of a pair's details.
pub(super) fn pair_id(pair: usize) -> String {
    format!("pair-{pair}")
}

/// Pairs of one verdict that are listed without a fold.
const FEW: usize = 3;

/// The track's pairs and what was judged of its engines alone, by verdict, the gravest first. What differs is listed; of the
/// rest there are too many to be read, so that more than a few are folded.
pub(super) fn of_track(comparison: &Comparison, track: Track) -> Vec<PairGroup> {
    let mut groups: Vec<(u8, Vec<PairView>)> = Vec::new();
    for pair in listed(comparison, track) {
        match groups.last_mut() {
            Some((rank, pairs)) if *rank == pair.rank => pairs.push(pair),
            _ => groups.push((pair.rank, vec![pair])),
        }
    }
    let group = |(rank, pairs): (u8, Vec<PairView>)| {
        let words = match rank {
            0 => Some("not compared"),
            1 => Some("that agree"),
            2 => Some("inconclusive, with nothing to act on"),
            3 => Some("inconclusive"),
            _ => None,
        };
        let words = words.filter(|_| pairs.len() > FEW && track != Track::Measured);
        PairGroup {
            folded: words.map(|words| format!("{} {words}", pairs.len())),
            pairs,
        }
    };
    groups.into_iter().map(group).collect()
}

fn listed(comparison: &Comparison, track: Track) -> Vec<PairView> {
    let pairs = comparison.pairs.iter().enumerate();
    let mut found: Vec<PairView> = pairs
        .filter(|(_, pair)| pair.track == track)
        .map(|(k, pair)| {
            let gravest = words::gravest(pair);
            let (mark, said, of) = match gravest {
                Some(worst) => (
                    mark(&worst.result),
                    words::verdict(&worst.result, relative),
                    place(comparison, &worst.quantity, worst.window.word()),
                ),
                None => (Mark::NOTHING, "not compared".to_owned(), String::new()),
            };
            let entries = || pair.entries.iter();
            let judged = sorted(entries().flat_map(|e| judged(comparison, e)).collect());
            let rank = gravest.map_or(0, |e| e.result.rank());
            let unjudged = entries().map(|e| (e.quantity.as_str(), e.window.word(), &e.result));
            PairView {
                id: pair_id(k),
                name: format!("{} \u{2194} {}", pair.a, pair.b),
                open: rank == 4 || track == Track::Measured,
                rank,
                mark,
                said,
                of,
                unresolved: reasons_of(&judged),
                judged,
                unjudged: not_judged(comparison, unjudged),
                metrics: entries().map(|e| metric_row(comparison, e)).collect(),
                order: gravest.map_or(-1.0, |e| e.result.share()),
            }
        })
        .collect();
    let engines = comparison.engines.iter().filter(|e| e.track == track);
    found.extend(engines.filter_map(|engine| alone(comparison, &engine.name, &engine.judged)));
    let graver = |a: &PairView, b: &PairView| b.rank.cmp(&a.rank);
    found.sort_by(|a, b| graver(a, b).then(b.order.total_cmp(&a.order)));
    found
}

/// Why rows are not resolved, each reason once.
fn reasons_of(judged: &[JudgedRow]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for reason in judged.iter().filter_map(|row| row.unresolved.as_ref()) {
        if !found.contains(reason) {
            found.push(reason.clone());
        }
    }
    found
}

/// What was judged of an engine without another one.
fn alone(comparison: &Comparison, name: &str, entries: &[EngineEntry]) -> Option<PairView> {
    let compared = entries.iter().filter(|entry| entry.result.rank() > 0);
    let rows = compared.map(|e| row(comparison, (&e.quantity, e.window.word()), &e.result));
    let judged = sorted(rows.collect());
    let worst = judged.first()?;
    Some(PairView {
        id: format!("alone-{name}"),
        name: format!("{name} \u{2194} load"),
        mark: worst.mark.clone(),
        said: worst.words.clone(),
        of: place(comparison, &entries.first()?.quantity, worst.window),
        open: worst.order.0 == 4,
        rank: worst.order.0,
        unresolved: reasons_of(&judged),
        unjudged: Vec::new(),
        metrics: Vec::new(),
        order: 1.0,
        judged,
    })
}

/// The gravest first, then those nearest to what they were held against.
fn sorted(mut rows: Vec<JudgedRow>) -> Vec<JudgedRow> {
    rows.sort_by(|a, b| {
        let outcomes = b.order.0.cmp(&a.order.0);
        outcomes.then(b.order.1.total_cmp(&a.order.1))
    });
    rows
}

fn place(comparison: &Comparison, quantity: &str, window: &str) -> String {
    let label = quantity_label(comparison, quantity).to_lowercase();
    format!("{label}, {window}")
}

fn judged(comparison: &Comparison, entry: &PairEntry) -> Vec<JudgedRow> {
    let of = (entry.quantity.as_str(), entry.window.word());
    let deciding = entry
        .assessments
        .iter()
        .filter(|one| one.decides && one.metric.is_some());
    deciding.map(|one| row(comparison, of, one)).collect()
}

fn key(value: Option<f64>) -> String {
    // Seven digits sort as all do.
    value.map_or_else(String::new, |v| format!("{v:.6e}"))
}

fn row(comparison: &Comparison, of: (&str, &'static str), one: &Assessment) -> JudgedRow {
    let against = match (&one.budget, one.against) {
        (Some(budget), _) => format!(
            "u of numerics {}, inputs {}, data {}",
            relative(budget.numerical),
            relative(budget.input),
            relative(budget.data)
        ),
        (None, Against::Limit) => {
            format!(
                "limit {}",
                one.bound.map_or_else(|| NONE.to_owned(), format::limit)
            )
        }
        (None, _) => {
            let sum = one.combined();
            let sum = sum.map_or_else(String::new, |sum| format!(" = {}", relative(sum)));
            let [a, b] = [one.u_a, one.u_b].map(relative_or_none);
            format!("U = {a} + {b}{sum}")
        }
    };
    let share = one.share();
    let bar = (one.against == Against::Limit).then(|| 100.0 * share);
    JudgedRow {
        mark: mark(one),
        quantity: quantity_label(comparison, of.0).to_owned(),
        window: of.1,
        metric: one.metric.map_or("", Metric::label),
        value: (relative_or_none(one.difference), key(one.difference)),
        against,
        bar: bar.map(|bar| format!("{:.1}", bar.clamp(0.0, 100.0))),
        words: words::verdict(one, relative),
        unresolved: words::why(one).map(|(who, why)| format!("{who}: {why}")),
        order: (one.rank(), share),
    }
}

/// Why the limits and tolerances of a track are what they are, each reason once.
pub(super) fn reasons(comparison: &Comparison, track: Track) -> Vec<String> {
    let pairs = comparison.pairs.iter().filter(|p| p.track == track);
    let of_pairs = pairs.flat_map(|p| &p.entries).flat_map(|e| &e.assessments);
    let engines = comparison.engines.iter().filter(|e| e.track == track);
    let alone = engines.flat_map(|e| &e.judged).map(|e| &e.result);
    let mut found: Vec<String> = Vec::new();
    let compared = |one: &&Assessment| matches!(one.verdict, Verdict::Agree | Verdict::Differ);
    for one in of_pairs.chain(alone).filter(compared) {
        if !one.reason.is_empty() && !found.contains(&one.reason) {
            found.push(one.reason.clone());
        }
    }
    found
}

/// Comparisons without a verdict, joined where the reason is one and the same.
fn not_judged<'a>(
    comparison: &Comparison,
    entries: impl Iterator<Item = (&'a str, &'a str, &'a Assessment)>,
) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    let without = entries.filter(|(.., found)| found.verdict == Verdict::NotCompared);
    for (quantity, window, Assessment { reason, .. }) in without {
        let what = place(comparison, quantity, window);
        match found.iter_mut().find(|(_, known)| known == reason) {
            Some((list, _)) => list.push_str(&format!("; {what}")),
            None => found.push((what, reason.clone())),
        }
    }
    found
}

/// Every metric of every pair, by the pair's name: what the page's script unfolds.
#[derive(Serialize)]
pub(super) struct AllMetrics<'a> {
    columns: [(&'static str, &'static str); 13],
    pairs: BTreeMap<&'a str, &'a [MetricRow]>,
}

pub(super) fn all_metrics<'a>(pairs: impl Iterator<Item = &'a PairView>) -> AllMetrics<'a> {
    AllMetrics {
        columns: COLUMNS,
        pairs: pairs
            .map(|pair| (pair.name.as_str(), pair.metrics.as_slice()))
            .collect(),
    }
}

fn metric_row(comparison: &Comparison, entry: &PairEntry) -> MetricRow {
    let quantity = comparison
        .quantities
        .iter()
        .find(|q| q.name == entry.quantity);
    MetricRow {
        window: entry.window.word(),
        quantity: quantity.map_or_else(|| entry.quantity.clone(), |q| q.label.clone()),
        cells: match &entry.metrics {
            Some(metrics) => cells(metrics, quantity),
            None => vec![NONE.to_owned(); COLUMNS.len()],
        },
    }
}

fn cells(metrics: &PairMetrics, quantity: Option<&Quantity>) -> Vec<String> {
    let ratio = |value: Option<f64>| value.map_or_else(|| NONE.to_owned(), |v| significant(v, 6));
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
        return NONE.to_owned();
    };
    let unit = quantity.map_or("", |q| q.unit.as_str());
    let channel = match quantity {
        Some(q) if q.channels.len() > 1 => format!(", no. {}", worst.channel),
        _ => String::new(),
    };
    format!(
        "{}\u{202f}{unit} at {}\u{202f}s{channel}",
        significant(value, 2),
        format::plain(worst.time_s)
    )
}
