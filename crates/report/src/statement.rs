//! What a pair's verdicts amount to, in a line: for pages and terminals alike.

use pinwheel_compare::comparison::{Pair, PairEntry};
use pinwheel_compare::{Check, Comparison, Metric, Outcome, Verdict};
use pinwheel_engines::info;

/// The number that a verdict rests on.
#[derive(Debug, Clone, Copy)]
pub struct Figure {
    /// How it was measured.
    pub metric: Metric,
    /// Relative; `None` where it is not finite.
    pub value: Option<f64>,
}

/// The entry of a pair that says most against it: the gravest outcome, and among equals the largest number. `None` where
/// nothing was judged or stated.
#[must_use]
pub fn gravest(pair: &Pair) -> Option<&PairEntry> {
    let says = |entry: &&PairEntry| {
        let model = matches!(entry.verdict, Verdict::ModelDifference { .. });
        entry.verdict.outcome() != Outcome::Nothing || model
    };
    let entries = pair.entries.iter().filter(says);
    entries.max_by(|a, b| gravity(a).total_cmp(&gravity(b)))
}

/// Orders entries: by outcome, and among equals by their number, which is below 1e3.
#[must_use]
pub fn gravity(entry: &PairEntry) -> f64 {
    let number = match &entry.verdict {
        Verdict::Agree { to } => *to,
        Verdict::Differ { at_least } => *at_least,
        Verdict::NotResolved { u, .. } => u.unwrap_or(1.0),
        Verdict::ModelDifference { low, high, .. } => low.abs().max(high.abs()),
        Verdict::NotDistinguishable { level } => *level,
        Verdict::ModelError { low, high } => low.abs().max(high.abs()),
        Verdict::Within | Verdict::Exceeded => share(entry),
        Verdict::NotJudged { .. } => 0.0,
    };
    1e3 * f64::from(entry.verdict.outcome() as u8) + number.min(999.0)
}

/// How much of a limit is used, of the nearest one.
fn share(entry: &PairEntry) -> f64 {
    entry.checks.iter().map(Check::share).fold(0.0, f64::max)
}

/// The number that an entry's verdict rests on: the check nearest its limit, or the largest distance that was judged.
#[must_use]
pub fn figure(entry: &PairEntry) -> Option<Figure> {
    if matches!(entry.verdict, Verdict::Within | Verdict::Exceeded) {
        let nearest = entry
            .checks
            .iter()
            .max_by(|a, b| a.share().total_cmp(&b.share()))?;
        return Some(Figure {
            metric: nearest.metric,
            value: nearest.value,
        });
    }
    let size = |value: Option<f64>| value.map_or(f64::INFINITY, f64::abs);
    let judged = entry.judgements.iter().filter(|j| j.counts);
    let largest = judged.max_by(|a, b| size(a.distance).total_cmp(&size(b.distance)))?;
    Some(Figure {
        metric: largest.metric,
        value: largest.distance,
    })
}

/// A verdict with its numbers, which `number` writes.
#[must_use]
pub fn verdict(verdict: &Verdict, number: fn(f64) -> String) -> String {
    match verdict {
        Verdict::Agree { to } => format!("agree to {}", number(*to)),
        Verdict::Differ { at_least } => format!("differ by at least {}", number(*at_least)),
        Verdict::NotResolved { u: Some(u), .. } => format!("not resolved, U = {}", number(*u)),
        Verdict::NotResolved { .. } => "not resolved".to_owned(),
        Verdict::ModelDifference {
            low,
            high,
            predicted,
            tolerance,
            ..
        } => {
            let aim = if *predicted == 0.0 {
                String::new()
            } else {
                format!(", {} predicted", number(*predicted))
            };
            let stated = tolerance.filter(|t| *t > 0.0);
            let stated = stated.map_or_else(String::new, |t| format!(", {} stated", number(t)));
            format!("models {} to {}{aim}{stated}", number(*low), number(*high))
        }
        Verdict::NotDistinguishable { level } => {
            format!("no model error above {}", number(*level))
        }
        Verdict::ModelError { low, high } => {
            format!("model error {} to {}", number(*low), number(*high))
        }
        Verdict::Within | Verdict::Exceeded | Verdict::NotJudged { .. } => {
            verdict.word().to_owned()
        }
    }
}

/// What an entry says.
#[must_use]
pub fn entry(entry: &PairEntry, number: fn(f64) -> String) -> String {
    let said = verdict(&entry.verdict, number);
    match entry.verdict {
        Verdict::Within | Verdict::Exceeded => {
            format!("{said}, {:.0} % of its limit", 100.0 * share(entry))
        }
        _ => said,
    }
}

/// Who is not resolved, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unresolved {
    /// The participant whose numerical uncertainty is not known well enough.
    pub who: String,
    /// Why, and what would do where something would.
    pub why: String,
    /// No setting would change it.
    pub stated: bool,
}

/// Each participant that is not resolved, with its first reason.
#[must_use]
pub fn unresolved(comparison: &Comparison) -> Vec<Unresolved> {
    let mut told: Vec<Unresolved> = Vec::new();
    let pairs = comparison.pairs.iter().flat_map(|pair| &pair.entries);
    let alone = comparison.engines.iter().flat_map(|engine| &engine.judged);
    let all = pairs.map(|e| &e.verdict).chain(alone.map(|e| &e.verdict));
    for found in all.filter_map(why) {
        if !told.iter().any(|known| known.who == found.who) {
            told.push(found);
        }
    }
    told
}

/// Whose fault it is that a verdict is not resolved.
#[must_use]
pub fn why(verdict: &Verdict) -> Option<Unresolved> {
    let Verdict::NotResolved {
        participant,
        reason,
        remedy,
        stated,
        ..
    } = verdict
    else {
        return None;
    };
    let why = if *stated {
        reason.clone()
    } else {
        format!("{reason}; {remedy}")
    };
    Some(Unresolved {
        who: participant.clone(),
        why,
        stated: *stated,
    })
}

/// An engine's name where its track is said beside it.
#[must_use]
pub fn short(engine: &str) -> &str {
    info(engine).map_or(engine, |info| info.short)
}

/// What a metric is called.
#[must_use]
pub fn metric(metric: Metric) -> &'static str {
    match metric {
        Metric::RelativeL2 => "relative L2",
        Metric::RelativeLinf => "relative L\u{221e}",
        Metric::Mean => "mean",
        Metric::Peak => "peak",
        Metric::Rms => "rms",
        Metric::SpragueGeers => "Sprague\u{2013}Geers C",
        Metric::MeanAgainstLoad => "mean against the load",
    }
}
