//! Table of a sweep: a row for each run, a column for each key or figure.

use pinwheel_compare::limits::fits;
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::table::{Mark, Table, Values};

use crate::sweep::axis::Value;
use crate::sweep::row::Row;
use crate::sweep::spread::FIGURES;
use crate::sweep::{Limit, Plan, statics};

/// Column that is 1 if a run is within the specification, else 0.
const WITHIN: &str = "within_specification";

type FigureOfRun = fn(Row<'_>) -> Option<f64>;

/// Figures of a run without a channel.
const FIGURES_OF_RUNS: [(&str, FigureOfRun); 6] = [
    ("diverged_at_s", diverged_at_s),
    ("window_from_s", |r| Some(r.window_s[0])),
    ("window_to_s", |r| Some(r.window_s[1])),
    ("efficiency", |r| r.efficiency),
    ("efficiency_accounted", |r| r.efficiency_accounted),
    ("energy_remainder_share", |r| r.energy_remainder_share),
];

fn diverged_at_s(row: Row<'_>) -> Option<f64> {
    match row.ending() {
        Ending::Diverged { time_s, .. } => Some(time_s),
        _ => None,
    }
}

/// Returns the results of all runs, or of the first ones, in the plan's order, which does not depend on the number of threads.
pub fn results(plan: &Plan, rows: &[Row<'_>]) -> Table {
    // For people columns have their names in files; least and largest values are left out, as the peak covers them.
    let mut table = Table::of(
        "Every run: what was varied, how it ended, and its figures over the window",
        rows.iter().enumerate(),
    )
    .integers("run", "run", |(run, _)| Some(run + 1))
    .text("engine", "engine", |(_, row)| row.engine()[0]);
    for (place, key) in plan.keys().enumerate() {
        let values = (0..rows.len()).map(|run| plan.values(run)[place]);
        table = table.column(key, key, varied(&values.collect::<Vec<_>>()));
    }
    table = table
        .text("status", "status", |(_, row)| row.ending().word())
        .marked(|(_, row)| Mark::bad(!row.is_finished()));
    for (name, of) in FIGURES_OF_RUNS {
        table = table.number(name, name, |(_, row)| of(**row));
    }
    table = table
        .integers("steps", "steps", |(_, row)| Some(row.steps))
        .integers("rhs_calls", "rhs_calls", |(_, row)| Some(row.rhs_calls));
    for quantity in quantities(plan, rows) {
        for (figure, of) in FIGURES {
            let name = format!("{figure}_{quantity}");
            let label = if matches!(figure, "min" | "max") {
                ""
            } else {
                &name
            };
            table = table.number(&name, label, |(_, row)| {
                Some(of(&row.figure(quantity)?.statistics))
            });
        }
    }
    for FigureDef { key, .. } in statics::columns() {
        let wanted = plan.sweep.measure.iter().any(|pattern| fits(pattern, &key));
        if wanted && rows.iter().any(|row| row.balance(&key).is_some()) {
            table = table.number(&key, &key, |(_, row)| row.balance(&key));
        }
    }
    let limits = &plan.sweep.specification;
    if !limits.is_empty() {
        let so_far = table.so_far();
        let kept = (0..rows.len()).map(|row| Some(i64::from(keeps(so_far, limits, row))));
        let kept = Values::Integers(kept.collect());
        table = table.column(WITHIN, WITHIN, kept);
    }
    table.text("reason", "", |(_, row)| row.reason()).done()
}

/// Returns the runs that did not finish, without those whose sampled values make no gear.
pub fn broken<'a>(rows: &[Row<'a>]) -> impl Iterator<Item = Row<'a>> + Clone {
    let broken = |row: &Row<'_>| row.is_gear() && !row.is_finished();
    rows.iter().copied().filter(broken)
}

/// Returns the cost of each run. It is no part of the results, which repeat to the bit.
pub fn costs(rows: &[Row<'_>]) -> Table {
    Table::of("What each run cost", rows.iter().enumerate())
        .integers("run", "run", |(run, _)| Some(run + 1))
        .text("engine", "engine", |(_, row)| row.engine()[0])
        .number("wall_s", "wall_s", |(_, row)| row.wall_s)
        .number("cpu_s", "cpu_s", |(_, row)| row.cpu_s)
        .done()
}

/// True if a run is within all limits.
pub(super) fn keeps(table: &Table, limits: &[Limit], row: usize) -> bool {
    let holds = |limit: &Limit| limit.holds(table.number(&limit.figure, row));
    limits.iter().all(holds)
}

/// Returns the quantities that the sweep measures, in order of their first appearance.
fn quantities<'a>(plan: &Plan, rows: &[Row<'a>]) -> Vec<&'a str> {
    let mut list: Vec<&str> = Vec::new();
    for name in rows.iter().flat_map(|row| row.quantities()) {
        let wanted = plan.sweep.measure.iter().any(|pattern| fits(pattern, name));
        if wanted && !list.contains(&name.as_str()) {
            list.push(name);
        }
    }
    list
}

/// Returns the column of a varied key, of numbers if all its values are numbers.
fn varied(values: &[&Value]) -> Values {
    let integer = |value: &&Value| match value {
        Value::Whole(x) => Some(*x),
        _ => None,
    };
    if values.iter().all(|value| integer(value).is_some()) {
        Values::Integers(values.iter().map(integer).collect())
    } else if values.iter().all(|value| value.number().is_some()) {
        Values::Number(values.iter().map(|value| value.number()).collect())
    } else {
        Values::Text(values.iter().map(|value| Some(value.to_string())).collect())
    }
}
