//! A sweep on a terminal.

use pinwheel_report::terminal::{self, BAD, TITLE, pairs, styled};
use pinwheel_studies::sweep::{self, Plan, RunRecord};
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::table::Table;

use super::{simulated_s, tolerances};

/// Figures of a sample at most; the page and summary.json have more.
const MOST_FIGURES: usize = 8;

/// The runs that a sweep asks for.
#[must_use]
pub fn list(plan: &Plan) -> String {
    let mut table = Table::of("", &plan.runs)
        .whole("", "run", |run| Some(run.number))
        .text("", "engine", |run| &run.engine);
    for (place, key) in plan.keys().enumerate() {
        table = table.text("", key, |run| run.values[place].1.to_string());
    }
    let table = terminal::table(&table.done());
    format!("{}\n{table}", styled(TITLE, &plan.sweep.name))
}

/// How the runs ended and where the results are; `files`: pairs of a word and a place.
#[must_use]
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
    let row = |label: &str, value: String| (label.to_owned(), value);
    let mut rows = vec![
        row("runs", runs.join(", ")),
        row("varied", plan.keys().collect::<Vec<_>>().join(", ")),
        row(
            "time",
            format!("{cpu:.1} s CPU for {:.3} s simulated", simulated_s(plan)),
        ),
    ];
    let sampled = sweep::tolerances(plan, &sweep::results(plan, records));
    for found in &sampled {
        if sampled.len() > 1 {
            rows.push(row("sample", tolerances::place(found)));
        }
        if let Some(of) = &found.yielded {
            rows.push(row("yield", tolerances::yield_in_words(of)));
        }
        for figure in tolerances::shown(plan, found)
            .into_iter()
            .take(MOST_FIGURES)
        {
            let name = tolerances::named(&figure.name);
            rows.push(row(&name, tolerances::in_words(figure)));
        }
    }
    rows.extend(files.iter().map(|(word, place)| row(word, place.clone())));
    format!("{}\n{}", styled(TITLE, &plan.sweep.name), pairs(rows))
}
