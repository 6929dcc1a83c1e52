//! One line for each pair, and behind it everything that was judged and measured of it.

use std::collections::BTreeMap;

use pinwheel_compare::comparison::{EngineEntry, Judgement, PairEntry};
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::{Check, Comparison, Outcome, Quantity, Track, Verdict};

use serde::Serialize;

use super::{Mark, mark, quantity_label};
use crate::format::{self, NONE, relative, relative_or_none, significant};
use crate::statement;

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
    outcome: Outcome,
    order: f64,
}

/// Pairs of one outcome.
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
    order: (Outcome, f64),
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

/// Pairs of one outcome that are listed without a fold.
const FEW: usize = 3;

/// The track's pairs and what was judged of its engines alone, by outcome, the gravest first. What differs is listed; of the
/// rest there are too many to be read, so that more than a few are folded.
pub(super) fn of_track(comparison: &Comparison, track: Track) -> Vec<PairGroup> {
    let mut groups: Vec<(Outcome, Vec<PairView>)> = Vec::new();
    for pair in listed(comparison, track) {
        match groups.last_mut() {
            Some((outcome, pairs)) if *outcome == pair.outcome => pairs.push(pair),
            _ => groups.push((pair.outcome, vec![pair])),
        }
    }
    let group = |(outcome, pairs): (Outcome, Vec<PairView>)| {
        let words = match outcome {
            Outcome::Finding => None,
            Outcome::NotResolved => Some("not resolved"),
            Outcome::Passed => Some("that hold"),
            Outcome::Stated => Some("not resolved for a stated reason"),
            Outcome::Nothing => Some("not judged"),
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
            let gravest = statement::gravest(pair);
            let (mark, said, of) = match gravest {
                Some(worst) => (
                    mark(&worst.verdict),
                    statement::entry(worst, relative),
                    place(comparison, &worst.quantity, worst.window.word()),
                ),
                None => (Mark::NOTHING, "not judged".to_owned(), String::new()),
            };
            let entries = || pair.entries.iter();
            let judged = sorted(entries().flat_map(|e| judged(comparison, e)).collect());
            let outcome = gravest.map_or(Outcome::Nothing, |e| e.verdict.outcome());
            let unjudged = entries().map(|e| (e.quantity.as_str(), e.window.word(), &e.verdict));
            PairView {
                id: pair_id(k),
                name: format!("{} \u{2194} {}", pair.a, pair.b),
                open: outcome == Outcome::Finding || track == Track::Measured,
                outcome,
                mark,
                said,
                of,
                unresolved: reasons_of(&judged),
                judged,
                unjudged: not_judged(comparison, unjudged),
                metrics: entries().map(|e| metric_row(comparison, e)).collect(),
                order: gravest.map_or(-1.0, statement::gravity),
            }
        })
        .collect();
    let engines = comparison.engines.iter().filter(|e| e.track == track);
    found.extend(engines.filter_map(|engine| alone(comparison, &engine.name, &engine.judged)));
    let graver = |a: &PairView, b: &PairView| b.outcome.cmp(&a.outcome);
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
    let rows = entries.iter().flat_map(|entry| {
        let of = (entry.quantity.as_str(), entry.window.word());
        entry.checks.iter().map(move |c| check(comparison, of, c))
    });
    let judged = sorted(rows.collect());
    let worst = judged.first()?;
    let exceeded = worst.order.0 == Outcome::Finding;
    Some(PairView {
        id: format!("alone-{name}"),
        name: format!("{name} \u{2194} load"),
        mark: worst.mark.clone(),
        said: format!("{}, {}", worst.mark.word, worst.words),
        of: place(comparison, &entries.first()?.quantity, worst.window),
        open: exceeded,
        outcome: worst.order.0,
        unresolved: Vec::new(),
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
    let statements = entry.judgements.iter().filter(|j| j.counts);
    let statements = statements.map(|j| judgement(comparison, of, j));
    let checks = entry.checks.iter().map(|c| check(comparison, of, c));
    statements.chain(checks).collect()
}

fn key(value: Option<f64>) -> String {
    // Seven digits sort as all do.
    value.map_or_else(String::new, |v| format!("{v:.6e}"))
}

fn judgement(comparison: &Comparison, of: (&str, &'static str), j: &Judgement) -> JudgedRow {
    let u = |u: Option<f64>| relative_or_none(u);
    let words = statement::verdict(&j.verdict, relative);
    let unresolved =
        statement::why(&j.verdict).map(|found| format!("{}: {}", found.who, found.why));
    let combined = j.combined();
    let against = match (&j.budget, combined) {
        (Some(budget), _) => format!(
            "u of numerics {}, inputs {}, data {}",
            relative(budget.numerical),
            relative(budget.input),
            relative(budget.data)
        ),
        (None, Some(sum)) => format!("U = {} + {} = {}", u(j.u_a), u(j.u_b), relative(sum)),
        (None, None) => format!("U = {} + {}", u(j.u_a), u(j.u_b)),
    };
    JudgedRow {
        mark: mark(&j.verdict),
        quantity: quantity_label(comparison, of.0).to_owned(),
        window: of.1,
        metric: statement::metric(j.metric),
        value: (relative_or_none(j.distance), key(j.distance)),
        against,
        bar: None,
        words,
        unresolved,
        order: (j.verdict.outcome(), combined.unwrap_or(f64::INFINITY)),
    }
}

fn check(comparison: &Comparison, of: (&str, &'static str), check: &Check) -> JudgedRow {
    let share = check.share();
    JudgedRow {
        mark: mark(&check.verdict()),
        quantity: quantity_label(comparison, of.0).to_owned(),
        window: of.1,
        metric: statement::metric(check.metric),
        value: (
            check
                .value
                .map_or_else(|| "not finite".to_owned(), relative),
            key(check.value),
        ),
        against: format!("limit {}", format::limit(check.limit)),
        bar: Some(format!("{:.1}", (100.0 * share).clamp(0.0, 100.0))),
        words: format!("{} of its limit", share_label(share)),
        unresolved: None,
        order: (check.verdict().outcome(), share),
    }
}

/// How much of a limit is used, without more digits than anyone reads.
fn share_label(share: f64) -> String {
    match share {
        s if !s.is_finite() => "not finite".to_owned(),
        s if s < 0.01 => "<\u{202f}1\u{202f}%".to_owned(),
        s if s < 10.0 => format!("{:.0}\u{202f}%", 100.0 * s),
        s => format!("{}\u{202f}\u{d7}", significant(s, 2)),
    }
}

/// Why the limits of a track are what they are, each reason once.
pub(super) fn reasons(comparison: &Comparison, track: Track) -> Vec<String> {
    let pairs = comparison.pairs.iter().filter(|p| p.track == track);
    let of_pairs = pairs.flat_map(|p| &p.entries).flat_map(|e| &e.checks);
    let engines = comparison.engines.iter().filter(|e| e.track == track);
    let alone = engines.flat_map(|e| &e.judged).flat_map(|e| &e.checks);
    let mut found: Vec<String> = Vec::new();
    for check in of_pairs.chain(alone) {
        if !found.contains(&check.reason) {
            found.push(check.reason.clone());
        }
    }
    found
}

/// Comparisons without a verdict, joined where the reason is one and the same.
fn not_judged<'a>(
    comparison: &Comparison,
    entries: impl Iterator<Item = (&'a str, &'a str, &'a Verdict)>,
) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for (quantity, window, verdict) in entries {
        let Verdict::NotJudged { reason } = verdict else {
            continue;
        };
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
