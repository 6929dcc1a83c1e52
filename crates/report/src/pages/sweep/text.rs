//! Text of a sweep for a terminal.

use crate::format::joined;
use crate::terminal::{self, BAD, pairs, styled, titled};
use pinwheel_studies::sweep::{self, Plan, RunRecord};
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
pub fn list(plan: &Plan) -> String {
    let mut table = Table::of("", &plan.runs)
        .whole("", "run", |run| Some(run.number))
        .text("", "engine", |run| &run.engine);
    for (place, key) in plan.keys().enumerate() {
        table = table.text("", key, |run| run.values[place].1.to_string());
    }
    titled(&plan.sweep.name, [terminal::table(&table.done())])
}

/// Returns endings of the runs and paths of the results; `files`: pairs of label and path.
pub fn text(plan: &Plan, records: &[RunRecord], files: &[(&str, String)]) -> String {
    let count = |wanted: &str| {
        let all = records.iter();
        all.filter(|record| record.ending.word() == wanted).count()
    };
    let mut runs = vec![format!("{} finished", count("finished"))];
    for word in &Ending::WORDS[1..] {
        if count(word) > 0 {
            runs.push(styled(BAD, &format!("{} {word}", count(word))));
        }
    }
    let cpu: f64 = records.iter().map(|record| record.cpu_s).sum();
    let simulated_s = simulated_s(plan);
    let row = |label: &str, value: String| (label.to_owned(), value);
    let mut rows = vec![
        row("runs", runs.join(", ")),
        row("varied", joined(", ", plan.keys())),
        row(
            "time",
            format!("{cpu:.1} s CPU for {simulated_s:.3} s simulated"),
        ),
    ];
    let mut refused = plan.runs.iter().filter_map(|run| run.refused.as_ref());
    let none = refused.clone().count();
    rows.extend(refused.next().map(|first| {
        let all = records.len();
        row(
            "no gear",
            format!("{none} of {all} runs, lost yield; the first: {first}"),
        )
    }));
    let idle = sweep::idle(plan, records);
    if !idle.is_empty() {
        let words = format!("{} on this scene: runs equal to the bit", idle.join(", "));
        rows.push(row("no effect", words));
    }
    let moving = || records.iter().filter(|r| !r.figures.is_empty());
    if moving().next().is_some() && moving().all(|record| record.uncertainty.is_none()) {
        let remedy = "not known; solver.integrator = \"auto\" verifies every run";
        rows.push(row("numerical error", remedy.to_owned()));
    }
    let sampled = sweep::tolerances(plan, &sweep::results(plan, records));
    for found in &sampled {
        if sampled.len() > 1 {
            rows.push(row("sample", tolerances::place(found)));
        }
        if let Some(of) = &found.yielded {
            rows.push(row("yield", tolerances::yield_in_words(of)));
        }
        let shown = tolerances::shown(plan, found).into_iter();
        for figure in shown.take(MOST_FIGURES) {
            let name = tolerances::in_full(&figure.def);
            rows.push(row(&name, tolerances::in_words(figure)));
        }
    }
    let result = match sampled.is_empty() {
        true => result(plan, records),
        false => String::new(),
    };
    rows.extend(files.iter().map(|(word, place)| row(word, place.clone())));
    titled(&plan.sweep.name, [result, pairs(rows)])
}

/// Returns a table of the varied keys and the largest forces and mean torque of each run, or of the first ones.
fn result(plan: &Plan, records: &[RunRecord]) -> String {
    let rows = plan.runs.iter().zip(records).take(MOST_RUNS);
    let mut table = Table::of("", rows).text("", "engine", |(run, _)| &run.engine);
    for (place, key) in plan.keys().enumerate() {
        // The last part of a key is the label; the full key is below.
        let label = key.rsplit('.').next().unwrap_or(key);
        table = table.text("", label, |(run, _)| run.values[place].1.to_string());
    }
    for (word, quantity, label) in SHOWN {
        let value = |record: &RunRecord| {
            let statistics = record.figures.get(quantity)?.statistics;
            Some(match word {
                "mean" => statistics.mean,
                _ => statistics.peak,
            })
        };
        let column = format!("{word}_{quantity}");
        table = table
            .number("", label, |(_, record)| value(record))
            .shown(Shown::Digits(5))
            .uncertain(|(_, record)| uncertainty(record, &column, value(record)?));
    }
    let more = match records.len().saturating_sub(MOST_RUNS) {
        0 => String::new(),
        more => format!("and {more} more in the results\n"),
    };
    terminal::table(&table.done().without_empty()) + &more
}
