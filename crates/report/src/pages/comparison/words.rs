//! Verdicts, quantities and engines as text, for the page and the terminal.

use crate::format::{distinct, grouped};
use pinwheel_compare::comparison::{Pair, PairEntry};
use pinwheel_compare::{Against, Assessment, Comparison, Quantity, SharedModel, Verdict};
use pinwheel_engines::info;

/// Returns the entries of some pairs, each with its pair.
pub(super) fn entries<'a>(
    pairs: impl IntoIterator<Item = &'a Pair>,
) -> impl Iterator<Item = (&'a Pair, &'a PairEntry)> {
    let pairs = pairs.into_iter();
    pairs.flat_map(|pair| pair.entries.iter().map(move |entry| (pair, entry)))
}

/// Returns the gravest entry of a pair, among equals the one with the largest share of its bound. `None` without any judged
/// entry.
pub(super) fn gravest(pair: &Pair) -> Option<&PairEntry> {
    let known = |entry: &&PairEntry| entry.result.rank() > 0 || entry.result.interval().is_some();
    Assessment::gravest(pair.entries.iter().filter(known), |entry| &entry.result)
}

/// Returns a quantity of the comparison.
pub(super) fn quantity<'a>(comparison: &'a Comparison, name: &str) -> Option<&'a Quantity> {
    comparison.quantities.iter().find(|q| q.name == name)
}

/// Returns the label of a quantity, or the name of an unknown one.
pub(super) fn label<'a>(comparison: &'a Comparison, name: &'a str) -> &'a str {
    quantity(comparison, name).map_or(name, |q| &q.label)
}

/// Returns a verdict with its numbers, formatted by `number`.
pub(super) fn verdict(result: &Assessment, number: fn(f64) -> String) -> String {
    let word = result.verdict.word();
    let text = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
    if result.verdict == Verdict::Inconclusive {
        return match result.combined() {
            Some(sum) => format!("{word}, U = {}", number(sum)),
            None => word.to_owned(),
        };
    }
    let interval = result.interval().map(|[low, high]| {
        let aim = match result.predicted {
            0.0 => String::new(),
            predicted => format!(", {} predicted", number(predicted)),
        };
        format!("{} to {}{aim}", number(low), number(high))
    });
    match (result.verdict, result.against, interval) {
        (Verdict::NotCompared, _, Some(interval)) => format!("{word}, models {interval}"),
        (_, Against::ModelTolerance, Some(interval)) => {
            let tolerance = result.tolerance.filter(|t| *t > 0.0);
            let tolerance = tolerance.map(|t| format!(", tolerance {}", number(t)));
            format!("{word}, models {interval}{}", tolerance.unwrap_or_default())
        }
        (Verdict::Agree, Against::NumericalError, _) => {
            format!("{word} to {}", text(result.bound))
        }
        (Verdict::Differ, Against::NumericalError, _) => {
            let both = result.difference.zip(result.bound);
            let off = text(both.map(|(d, bound)| d - bound));
            format!("{word} by at least {off}")
        }
        (Verdict::Agree, Against::Measurement, _) => {
            format!("{word}, no model error above {}", text(result.bound))
        }
        (Verdict::Differ, Against::Measurement, Some(interval)) => {
            format!("{word}, model error {interval}")
        }
        (Verdict::Agree | Verdict::Differ, Against::Limit, _) => match result.difference {
            Some(_) => format!("{word}, {:.0} % of the limit", 100.0 * result.share()),
            None => format!("{word}, not finite"),
        },
        _ => word.to_owned(),
    }
}

/// Returns the counts of all verdicts of a comparison: `444 comparisons: 296 agree, 0 differ, 148 inconclusive
/// (recordings)`.
pub(super) fn counts(comparison: &Comparison) -> String {
    let counts = comparison.counts;
    let groups = groups(comparison);
    let mut inconclusive = groups.join(", ");
    let open = counts.inconclusive_actionable;
    if open > 0 {
        let others = if groups.is_empty() { "" } else { "; others: " };
        inconclusive = format!("{open} to act on{others}{inconclusive}");
    }
    if !inconclusive.is_empty() {
        inconclusive = format!(" ({inconclusive})");
    }
    let off = counts.differ - counts.differ_actionable;
    let measured = match off {
        0 => String::new(),
        off => format!(" ({off} from measured data)"),
    };
    format!(
        "{} comparisons: {} agree, {} differ{measured}, {} inconclusive{inconclusive}",
        counts.compared(),
        counts.agree,
        counts.differ,
        counts.inconclusive
    )
}

/// Returns remarks on missing windows, and on those in which the load changes.
pub(super) fn of_windows(comparison: &Comparison) -> impl Iterator<Item = String> {
    let absent = comparison.absent_windows.iter();
    let absent = absent.map(|w| format!("No {} window: {}.", w.kind.word(), w.reason));
    absent.chain(comparison.windows.iter().filter_map(|w| w.remark()))
}

/// Returns remarks on measured data, each with its name.
pub(super) fn of_measured(comparison: &Comparison) -> impl Iterator<Item = String> {
    let rigs = comparison.engines.iter();
    let rigs = rigs.filter(|e| e.track == SharedModel::Measured);
    let notes = rigs.flat_map(|e| e.cost.notes.iter().map(move |note| (&e.name, note)));
    notes.map(|(name, note)| format!("{name}: {note}"))
}

fn results(comparison: &Comparison) -> impl Iterator<Item = &Assessment> {
    let pairs = comparison.pairs.iter().flat_map(|pair| &pair.entries);
    let alone = comparison.engines.iter().flat_map(|engine| &engine.judged);
    pairs.map(|e| &e.result).chain(alone.map(|e| &e.result))
}

/// Returns the groups of participants that leave verdicts inconclusive without a possible action.
pub(super) fn groups(comparison: &Comparison) -> Vec<&'static str> {
    let groups = results(comparison).map(|one| one.group);
    distinct(groups.filter(|group| !group.is_empty()))
}

/// Returns each participant that leaves a verdict inconclusive with a possible action, with its first reason and the
/// remedy.
pub(super) fn inconclusive(comparison: &Comparison) -> Vec<(String, String)> {
    let open = results(comparison).filter(|one| one.actionable);
    let open = grouped(open.filter_map(why)).into_iter();
    open.map(|(who, mut whys)| (who, whys.swap_remove(0)))
        .collect()
}

/// Returns the participant that leaves a verdict inconclusive, with the reason and a remedy if there is one.
pub(super) fn why(result: &Assessment) -> Option<(String, String)> {
    let who = result.participant.clone()?;
    let why = match result.remedy.as_str() {
        "" => result.reason.clone(),
        remedy => format!("{}; {remedy}", result.reason),
    };
    Some((who, why))
}

/// Returns an engine's name without its track, for places beside the track's name.
pub(super) fn short(engine: &str) -> &str {
    info(engine).map_or(engine, |info| info.short)
}
