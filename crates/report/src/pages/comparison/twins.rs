//! Engines with contacts of their own and native runs with the same contacts, as text and as a table.

use crate::format::significant;
use crate::study::Block;
use crate::table::named;
use pinwheel_compare::Verdict as Judged;
use pinwheel_studies::comparison::{MatchedContactRun, Outcome};
use pinwheel_timeseries::table::{Mark, Table};

use super::words;

pub(super) fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share.abs(), 2))
}

fn value(of: f64) -> String {
    significant(of, 4)
}

/// Returns a sentence on an engine and its matched native run.
pub(super) fn line(twin: &MatchedContactRun) -> Option<String> {
    let worst = twin.worst()?;
    let (what, unit) = (&worst.def.label, &worst.def.unit);
    let engine = words::short(&twin.engine);
    let own = format!("{engine} has {}", twin.contacts);
    let [by_engine, by_twin, by_scene] = [worst.engine, worst.twin, worst.scene].map(value);
    let law = format!(
        "this scene's law gives {by_scene} {unit}, {} from that: a difference of models",
        percent(worst.of_law())
    );
    let [off, tolerance] = [worst.difference(), twin.tolerance].map(percent);
    let verdict = match twin.verdict {
        Judged::Agree => format!("agree to {off}"),
        _ => format!("differ by {off}, more than {tolerance}"),
    };
    Some(format!(
        "{own}. Native with these: {what} {by_twin} {unit}, the engine {by_engine}: {verdict}; {law}"
    ))
}

/// Returns the table for a page.
pub(super) fn blocks(outcome: &Outcome) -> Vec<Block> {
    let rows = outcome.twins.iter();
    let rows = rows.flat_map(|twin| twin.figures.iter().map(move |figure| (twin, figure)));
    let table = Table::of("Engines with contacts of their own, like with like", rows)
        .text("", "Engine", |(twin, _)| &twin.engine)
        .text("", "Figure", |(_, of)| named(&of.def.label, &of.def.unit))
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
        .marked(|(twin, figure)| Mark::of(figure.difference().abs() <= twin.tolerance))
        .done();
    let blocks = (!table.is_empty()).then(|| table.into());
    blocks.into_iter().collect()
}
