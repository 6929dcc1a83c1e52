//! Engines with contacts of their own beside native runs with the same contacts, in words and as a table.

use pinwheel_compare::Verdict as Judged;
use pinwheel_report::format::significant;
use pinwheel_report::study::{Block, Tone, Verdict};
use pinwheel_report::words;
use pinwheel_studies::comparison::{Outcome, Twin, TwinFigure};
use pinwheel_timeseries::columns;
use pinwheel_timeseries::table::{Mark, Table};

/// A figure's name and unit.
fn name(figure: &TwinFigure) -> (String, &'static str) {
    match figure.quantity {
        columns::EXTERNAL_FORCE => (format!("{} external force, mean over time", figure.of), "N"),
        columns::INTERNAL_FORCE => (format!("{} internal force, mean over time", figure.of), "N"),
        _ => (format!("{} driver torque", figure.of), "N m"),
    }
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share.abs(), 2))
}

fn value(of: f64) -> String {
    significant(of, 4)
}

/// What an engine and its twin come to.
fn line(twin: &Twin) -> Option<String> {
    let worst = twin.worst()?;
    let (what, unit) = name(worst);
    let engine = words::short(&twin.engine);
    let own = format!("{engine} has {}", twin.contacts);
    let [by_engine, by_twin, by_scene] = [worst.engine, worst.twin, worst.scene].map(value);
    let law = format!(
        "this scene's law gives {by_scene} {unit}, {} from that: a difference of models",
        percent(worst.of_law())
    );
    Some(match twin.verdict {
        Judged::Agree => format!(
            "{own}. Native with these: {what} {by_twin} {unit}, the engine {by_engine}: agree to {}; {law}",
            percent(worst.difference())
        ),
        _ => format!(
            "{own}. Native with these: {what} {by_twin} {unit}, the engine {by_engine}: differ by {}, more than {}; {law}",
            percent(worst.difference()),
            percent(twin.tolerance)
        ),
    })
}

/// What a terminal says: engines that differ from their twins one by one, the others in a sentence, and the largest
/// difference of models.
pub(super) fn lines(found: &Outcome) -> Vec<String> {
    let differ = |twin: &&Twin| twin.verdict == Judged::Differ;
    let mut lines: Vec<String> = found.twins.iter().filter(differ).filter_map(line).collect();
    let agree = found
        .twins
        .iter()
        .filter(|twin| twin.verdict == Judged::Agree);
    let agree = agree.filter_map(|twin| {
        let off = percent(twin.worst()?.difference());
        Some(format!("{} {off}", words::short(&twin.engine)))
    });
    let agree: Vec<String> = agree.collect();
    if !agree.is_empty() {
        lines.push(format!("like with like: {}", agree.join(", ")));
    }
    if let Some(largest) = found.largest().filter(|largest| largest.share.abs() > SEEN) {
        let quantity = match largest.figure.quantity {
            columns::EXTERNAL_FORCE => "ext N",
            columns::INTERNAL_FORCE => "int N",
            _ => "torque N m",
        };
        let why = match largest.explained {
            true => "by its own law",
            false => "not explained",
        };
        let [here, there] = [largest.figure.scene, largest.figure.engine];
        lines.push(format!(
            "largest difference: {quantity} {} here, {} by {} {why}",
            significant(here, 3),
            significant(there, 3),
            words::short(largest.engine)
        ));
    }
    lines
}

/// Difference of models from which on it is told.
const SEEN: f64 = 0.03;

/// A verdict that twins change.
pub(super) fn verdict(found: &Outcome) -> Option<Verdict> {
    let differs = found
        .twins
        .iter()
        .find(|twin| twin.verdict == Judged::Differ);
    let counts = words::counts(&found.comparison);
    if let Some(twin) = differs {
        return Some(Verdict {
            tone: Tone::Bad,
            headline: "Differs".to_owned(),
            detail: format!("{}; {counts}", line(twin)?),
        });
    }
    if !found.is_unexplained() {
        return None;
    }
    let largest = found.largest()?;
    let (what, unit) = name(largest.figure);
    Some(Verdict {
        tone: Tone::Open,
        headline: "Not confirmed".to_owned(),
        detail: format!(
            "{what}: {} {unit} here, {} by {}; {counts}",
            value(largest.figure.scene),
            value(largest.figure.engine),
            words::short(largest.engine)
        ),
    })
}

/// The table of a page.
pub(super) fn blocks(found: &Outcome) -> Vec<Block> {
    let rows = found.twins.iter();
    let rows = rows.flat_map(|twin| twin.figures.iter().map(move |figure| (twin, figure)));
    let table = Table::of("Engines with contacts of their own, like with like", rows)
        .text("", "Engine", |(twin, _)| &twin.engine)
        .text("", "Figure", |(_, figure)| {
            let (what, unit) = name(figure);
            format!("{what} ({unit})")
        })
        .text("", "engine", |(_, figure)| value(figure.engine))
        .text("", "native, same contacts", |(_, figure)| {
            value(figure.twin)
        })
        .text("", "native, scene's law", |(_, figure)| value(figure.scene))
        .text("", "Verdict", |(twin, figure)| {
            let off = figure.difference().abs();
            match off <= twin.tolerance {
                true => format!("agree to {}", percent(off)),
                false => format!("differ by {}", percent(off)),
            }
        })
        .marked(
            |(twin, figure)| match figure.difference().abs() <= twin.tolerance {
                true => Mark::Good,
                false => Mark::Bad,
            },
        )
        .done();
    match table.is_empty() {
        true => Vec::new(),
        false => vec![table.into()],
    }
}
