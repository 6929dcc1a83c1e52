//! Limits of a gear: the answer as text, and every limit in a table.

use crate::figure::number;
use crate::format::{NONE, joined, significant};
use crate::study::{Block, Mark, Question, Section, Tile};
use pinwheel_studies::design::{Answer, Limit, Limits};
use pinwheel_timeseries::table::Table;

/// Question that the limits answer.
pub(super) const QUESTION: &str = "bears its load";

/// Formats a value with the unit of a limit.
fn with_unit(limit: &Limit, value: Option<f64>) -> String {
    let value = value.map_or_else(|| NONE.to_owned(), number);
    format!("{value} {}", limit.def.unit).trim_end().to_owned()
}

/// Formats a margin with three digits, because two round a margin near 1 to 1.
fn margin(margin: f64) -> String {
    significant(margin, 3)
}

/// Returns the name of a limit: its figure, and the kind if it has two.
fn named(limit: &Limit) -> String {
    let parts = [&*limit.def.label, limit.of].into_iter();
    joined(", ", parts.filter(|part| !part.is_empty()))
}

/// Returns the answer and its decisive limit.
pub fn answer(limits: &Limits) -> (String, String) {
    let Some((limit, by)) = limits.tightest().zip(limits.margin.map(margin)) else {
        return ("not judged".to_owned(), String::new());
    };
    let word = match limits.bears_its_load {
        Answer::Yes => format!("yes, margin {by}"),
        Answer::No => format!("no: {}", with_unit(limit, limit.worst)),
        _ => format!("margin {by}, as far as judged"),
    };
    let (name, allowed) = (named(limit), with_unit(limit, limit.permissible));
    (word, format!("{name}: {allowed} by {}", limit.source))
}

/// Returns the answer as a sentence.
pub(super) fn sentence(limits: &Limits) -> String {
    let parts = <[String; 2]>::from(answer(limits)).into_iter();
    joined("; ", parts.filter(|part| !part.is_empty()))
}

/// Returns the limits that were not judged, with the key to state for each.
pub(super) fn unjudged(limits: &Limits) -> Option<String> {
    let open = limits.each.iter().filter(|limit| limit.margin.is_none());
    let open = open.map(|limit| format!("{} ({})", named(limit), limit.source));
    Some(joined("; ", open)).filter(|open| !open.is_empty())
}

/// Returns the mark of the answer, which is good only if every limit was judged.
fn mark(limits: &Limits) -> Mark {
    match limits.bears_its_load {
        Answer::Yes => Mark::Good,
        Answer::No if limits.exceeded().is_some() => Mark::Bad,
        Answer::No => Mark::Warn,
        _ => Mark::None,
    }
}

pub(crate) fn tile(limits: &Limits) -> Tile {
    let (word, why) = answer(limits);
    let open = || limits.each.iter().filter(|limit| limit.margin.is_none());
    let why = match open().next() {
        Some(first) if open().count() == limits.each.len() => first.source.clone(),
        // The table has the source of the limit.
        _ => why.split(" by ").next().unwrap_or_default().to_owned(),
    };
    Question::Bears.answered(mark(limits), word, why)
}

/// Tile of two gears: their margins, and the decisive limit of the second.
pub(crate) fn both_bear(both: [&Limits; 2]) -> Tile {
    let [from, to] = both.map(|limits| limits.margin.map_or_else(|| NONE.to_owned(), margin));
    Tile {
        value: format!("margin {from} \u{2192} {to}"),
        ..tile(both[1])
    }
}

/// Returns the table of every limit.
pub(super) fn table(limits: &Limits) -> Table {
    let of = |value: Option<f64>| value.map_or_else(|| NONE.to_owned(), number);
    Table::of("Limits", &limits.each)
        .text("", "Limit", |limit| named(limit))
        .number("", "At worst", |limit| limit.worst)
        .display(move |limit| of(limit.worst))
        .number("", "Allowed", |limit| limit.permissible)
        .display(move |limit| of(limit.permissible))
        .text("", "Unit", |limit| &*limit.def.unit)
        .number("", "Margin", |limit| limit.margin)
        .display(|limit| limit.margin.map_or_else(|| NONE.to_owned(), margin))
        .text("", "By", |limit| &*limit.source)
        .done()
}

pub(super) fn section(limits: &Limits) -> Section {
    Section::new("limits", "Limits")
        .with(
            "Loads of the parts at the rated load against what they may bear. A value counts with its numerical uncertainty and the worse end \
             of its bands. Fatigue of pins and discs, impacts, oil and heat are left out. `[limits]` states limits of yours: \
             one that is exceeded ends the command with status 1.",
        )
        .with(Block::Table(table(limits)))
}
