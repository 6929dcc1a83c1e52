//! Table of a sweep: a row for each run, a column for each key or figure.

use pinwheel_compare::limits::fits;
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::table::{Mark, Table, Values};

use crate::sweep::axis::Value;
use crate::sweep::record::RunRecord;
use crate::sweep::spread::FIGURES;
use crate::sweep::{Limit, Plan, statics};

/// Column that is 1 if a run is within the specification, else 0.
const WITHIN: &str = "within_specification";

type FigureOfRun = fn(&RunRecord) -> Option<f64>;

/// Figures of a run without a channel.
const FIGURES_OF_RUNS: [(&str, FigureOfRun); 6] = [
    ("diverged_at_s", diverged_at_s),
    ("window_from_s", |r| Some(r.window_s[0])),
    ("window_to_s", |r| Some(r.window_s[1])),
    ("efficiency", |r| r.efficiency),
    ("efficiency_accounted", |r| r.efficiency_accounted),
    ("energy_remainder_share", |r| r.energy_remainder_share),
];

fn diverged_at_s(record: &RunRecord) -> Option<f64> {
    match record.ending {
        Ending::Diverged { time_s, .. } => Some(time_s),
        _ => None,
    }
}

/// Returns the results of all runs in the plan's order, which does not depend on the number of threads.
pub fn results(plan: &Plan, records: &[RunRecord]) -> Table {
    // For people columns have their names in files; least and largest values are left out, as the peak covers them.
    let mut table = Table::of(
        "Every run: what was varied, how it ended, and its figures over the window",
        plan.runs.iter().zip(records),
    )
    .whole("run", "run", |(run, _)| Some(run.number))
    .text("engine", "engine", |(run, _)| &run.engine);
    for (place, key) in plan.keys().enumerate() {
        table = table
            .column(key, key, varied(plan, place))
            .said(|(run, _)| run.values[place].1.to_string());
    }
    table = table
        .text("status", "status", |(_, record)| record.ending.word())
        .marked(|(_, record)| Mark::bad(!record.ending.is_finished()));
    for (name, of) in FIGURES_OF_RUNS {
        table = table.number(name, name, |(_, record)| of(record));
    }
    table = table
        .whole("steps", "steps", |(_, record)| Some(record.steps))
        .whole("rhs_calls", "rhs_calls", |(_, r)| Some(r.rhs_calls));
    for quantity in quantities(plan, records) {
        for (figure, of) in FIGURES {
            let name = format!("{figure}_{quantity}");
            let label = if matches!(figure, "min" | "max") {
                ""
            } else {
                &name
            };
            table = table.number(&name, label, |(_, record)| {
                Some(of(&record.figures.get(quantity)?.statistics))
            });
        }
    }
    for FigureDef { key, .. } in statics::columns() {
        let wanted = plan.sweep.measure.iter().any(|pattern| fits(pattern, &key));
        if wanted && records.iter().any(|r| r.balances.contains_key(&*key)) {
            table = table.number(&key, &key, |(_, r)| r.balances.get(&*key).copied());
        }
    }
    let limits = &plan.sweep.specification;
    if !limits.is_empty() {
        let so_far = table.so_far();
        let kept = (0..records.len()).map(|row| Some(i64::from(keeps(so_far, limits, row))));
        let kept = Values::Whole(kept.collect());
        table = table.column(WITHIN, WITHIN, kept);
    }
    table
        .text("reason", "", |(_, record)| record.reason())
        .done()
}

/// Returns the records of runs that did not finish, without those whose sampled values make no gear.
pub fn broken<'a>(
    plan: &'a Plan,
    records: &'a [RunRecord],
) -> impl Iterator<Item = &'a RunRecord> + Clone {
    let runs = plan.runs.iter().zip(records);
    let broken = runs.filter(|(run, record)| run.refused.is_none() && !record.ending.is_finished());
    broken.map(|(_, record)| record)
}

/// Returns the cost of each run. It is no part of the results, which repeat to the bit.
pub fn costs(plan: &Plan, records: &[RunRecord]) -> Table {
    Table::of("What each run cost", plan.runs.iter().zip(records))
        .whole("run", "run", |(run, _)| Some(run.number))
        .text("engine", "engine", |(run, _)| &run.engine)
        .number("wall_s", "wall_s", |(_, record)| record.wall_s)
        .number("cpu_s", "cpu_s", |(_, record)| record.cpu_s)
        .done()
}

/// True if a run is within all limits.
pub(super) fn keeps(table: &Table, limits: &[Limit], row: usize) -> bool {
    let holds = |limit: &Limit| limit.holds(table.number(&limit.figure, row));
    limits.iter().all(holds)
}

/// Returns the quantities of the records that the sweep measures, in order of their first appearance.
fn quantities<'a>(plan: &Plan, records: &'a [RunRecord]) -> Vec<&'a str> {
    let mut list: Vec<&str> = Vec::new();
    for name in records.iter().flat_map(|record| &record.quantities) {
        let wanted = plan.sweep.measure.iter().any(|pattern| fits(pattern, name));
        if wanted && !list.contains(&name.as_str()) {
            list.push(name);
        }
    }
    list
}

/// Returns the column of a varied key, of numbers if all its values are numbers.
fn varied(plan: &Plan, place: usize) -> Values {
    let values: Vec<&Value> = plan.runs.iter().map(|run| &run.values[place].1).collect();
    let whole = |value: &&Value| match value {
        Value::Whole(x) => Some(*x),
        _ => None,
    };
    if values.iter().all(|value| whole(value).is_some()) {
        Values::Whole(values.iter().map(whole).collect())
    } else if values.iter().all(|value| value.number().is_some()) {
        Values::Number(values.iter().map(|value| value.number()).collect())
    } else {
        Values::Text(values.iter().map(|value| Some(value.to_string())).collect())
    }
}
