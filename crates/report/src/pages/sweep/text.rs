//! Text of a sweep for a terminal.

use crate::format::joined;
use crate::terminal::{self, BAD, pairs, styled, titled};
use pinwheel_studies::StudyError;
use pinwheel_studies::sweep::{self, Plan, Row};
use pinwheel_timeseries::table::{Shown, Table};
use pinwheel_timeseries::{Ending, columns};

use super::{simulated_s, tolerances, uncertainty};

/// Largest number of figures of a sample; the page and summary.json have more.
const MOST_FIGURES: usize = 8;

/// Largest number of listed runs.
const MOST_RUNS: usize = 12;
/// Figures listed for each run.
const SHOWN: [(&str, &str, &str); 3] = [
    ("peak", columns::EXTERNAL_FORCE, "ext N"),
    ("peak", columns::INTERNAL_FORCE, "int N"),
    ("mean", columns::INPUT_TORQUE, "torque N m"),
];

/// Returns the list of planned runs.
///
/// # Errors
/// Run with an invalid scene.
pub fn list(plan: &Plan) -> Result<String, StudyError> {
    let engines = (0..plan.len()).map(|run| Ok(plan.run(run)?.engine.name().to_owned()));
    let engines = engines.collect::<Result<Vec<String>, StudyError>>()?;
    let mut table = Table::of("", engines.iter().enumerate())
        .integers("", "run", |(run, _)| Some(run + 1))
        .text("", "engine", |(_, engine)| *engine);
    for (place, key) in plan.keys().enumerate() {
        table = table.text("", key, |(run, _)| plan.values(*run)[place].to_string());
    }
    Ok(titled(&plan.sweep.name, [terminal::table(&table.done())]))
}

/// Returns endings of the runs and paths of the results; `table`: [its results](pinwheel_studies::sweep::results), `files`: pairs of
/// label and path.
pub fn text(plan: &Plan, rows: &[Row<'_>], table: &Table, files: &[(&str, String)]) -> String {
    let count = |wanted: &str| {
        let all = rows.iter();
        all.filter(|row| row.ending().word() == wanted).count()
    };
    let mut runs = vec![format!("{} finished", count("finished"))];
    for word in &Ending::WORDS[1..] {
        if count(word) > 0 {
            runs.push(styled(BAD, &format!("{} {word}", count(word))));
        }
    }
    let cpu: f64 = rows.iter().map(|row| row.cpu_s).sum();
    let simulated_s = simulated_s(plan);
    let row = |label: &str, value: String| (label.to_owned(), value);
    let mut facts = vec![
        row("runs", runs.join(", ")),
        row("varied", joined(", ", plan.keys())),
        row(
            "time",
            format!("{cpu:.1} s CPU for {simulated_s:.3} s simulated"),
        ),
    ];
    let mut refused = rows.iter().filter(|row| !row.is_gear());
    let none = refused.clone().count();
    if let Some(Ending::Unsupported { reason }) = refused.next().map(|row| row.ending()) {
        let all = rows.len();
        let words = format!("{none} of {all} runs, lost yield; the first: {reason}");
        facts.push(row("no gear", words));
    }
    let idle = sweep::idle(plan, rows);
    if !idle.is_empty() {
        let words = format!("{} on this scene: runs equal to the bit", idle.join(", "));
        facts.push(row("no effect", words));
    }
    let moving = || rows.iter().filter(|row| !row.quantities().is_empty());
    if moving().next().is_some() && moving().all(|row| row.uncertainty.is_none()) {
        let remedy = "not known; solver.integrator = \"auto\" verifies every run";
        facts.push(row("numerical error", remedy.to_owned()));
    }
    let sampled = sweep::tolerances(plan, table);
    for sample in &sampled {
        if sampled.len() > 1 {
            facts.push(row("sample", tolerances::place(sample)));
        }
        if let Some(of) = &sample.yielded {
            facts.push(row("yield", tolerances::yield_in_words(of)));
        }
        let shown = tolerances::shown(plan, sample).into_iter();
        for figure in shown.take(MOST_FIGURES) {
            let name = tolerances::in_full(&figure.def);
            facts.push(row(&name, tolerances::in_words(figure)));
        }
    }
    let result = match sampled.is_empty() {
        true => result(plan, rows),
        false => String::new(),
    };
    facts.extend(files.iter().map(|(word, place)| row(word, place.clone())));
    titled(&plan.sweep.name, [result, pairs(facts)])
}

/// Returns a table of the varied keys and the largest forces and mean torque of each run, or of the first ones.
fn result(plan: &Plan, rows: &[Row<'_>]) -> String {
    let first = rows.iter().enumerate().take(MOST_RUNS);
    let mut table = Table::of("", first).text("", "engine", |(_, row)| row.engine()[0]);
    for (place, key) in plan.keys().enumerate() {
        // The last part of a key is the label; the full key is below.
        let label = key.rsplit('.').next().unwrap_or(key);
        table = table.text("", label, |(run, _)| plan.values(*run)[place].to_string());
    }
    for (word, quantity, label) in SHOWN {
        let value = |row: Row<'_>| {
            let statistics = row.figure(quantity)?.statistics;
            Some(match word {
                "mean" => statistics.mean,
                _ => statistics.peak,
            })
        };
        let column = format!("{word}_{quantity}");
        table = table
            .number("", label, |(_, row)| value(**row))
            .shown(Shown::Digits(5))
            .uncertain(|(_, row)| uncertainty(**row, &column, value(**row)?));
    }
    let more = match rows.len().saturating_sub(MOST_RUNS) {
        0 => String::new(),
        more => format!("and {more} more in the results\n"),
    };
    terminal::table(&table.done().without_empty()) + &more
}
