//! Text of `pinwheel calibrate` on stdout.

use std::collections::BTreeMap;

use pinwheel_report::terminal::{self, BAD, GOOD, styled};
use pinwheel_studies::calibration::{COVERAGE, Outcome, Row, SHARPNESS};
use pinwheel_timeseries::table::{Shown, Table};

/// Coverage and sharpness, a row an engine.
#[must_use]
pub fn text(found: &Outcome) -> String {
    let mut text = format!("{} gears\n", found.gears);
    for (figures, title) in [(false, "time series"), (true, "their means, peaks and RMS")] {
        let count = |of: &BTreeMap<String, usize>, row: &Row| match row.engine.as_str() {
            "all" => of.values().sum::<usize>(),
            engine => of.get(engine).copied().unwrap_or(0),
        };
        let rows = found.rows(figures);
        let mut table = Table::of("", &rows)
            .text("", title, |row| &row.engine)
            .whole("", "stated", |row| Some(row.cases))
            .number("", "covered (%)", |row| 100.0 * row.coverage())
            .shown(Shown::Decimals(1))
            .number("", "u / error, median", |row| row.sharpness)
            .shown(Shown::Decimals(1))
            .number("", "error / u, largest", |row| row.worst)
            .shown(Shown::Decimals(2));
        if !figures {
            table = table
                .whole("", "not resolved", |row| {
                    Some(count(&found.not_resolved, row))
                })
                .whole("", "no truth", |row| Some(count(&found.without_truth, row)));
        }
        text.push_str(&terminal::table(&table.done()));
        text.push('\n');
    }
    text.push_str(&format!(
        "{} comparisons of engines with each other, {} false alarms\n",
        found.comparisons,
        found.alarms.len()
    ));
    for alarm in &found.alarms {
        let (off, bound) = (alarm.result.difference, alarm.result.bound);
        text.push_str(&format!(
            "false alarm: {}, {}, {}, {}: {:.1e} against {:.1e}\n",
            alarm.scene,
            alarm.engines,
            alarm.quantity,
            alarm.window.word(),
            off.unwrap_or(f64::NAN),
            bound.unwrap_or(f64::NAN)
        ));
    }
    for left in &found.left_out {
        text.push_str(&format!("left out: {left}\n"));
    }
    let verdict = if found.is_honest() {
        styled(GOOD, "uncertainties are honest")
    } else {
        styled(BAD, "UNCERTAINTIES ARE NOT HONEST")
    };
    format!(
        "{text}{verdict}: at least {:.0} % of the errors are to be within what was stated, and that below {SHARPNESS} times \
         the error in the median",
        100.0 * COVERAGE
    )
}
