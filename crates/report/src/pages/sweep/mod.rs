//! Page of a sweep: figures over the varied keys, and every run in a table.

use crate::format::{count, counted, joined, plain, readable_unit, relative, seconds, significant};
use crate::study::{
    Block, Decision, Grid, GridAxis, GridFigure, Mark, Question, Section, Study, Tile, Tone,
    Verdict,
};
use crate::table::named;
use pinwheel_compare::quantities;
use pinwheel_studies::Provenance;
use pinwheel_studies::sweep::{self, Axis, Plan, Row, STATICS, SampleResult, Value, definition};
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::table::{Column, Table, Values};

mod text;
mod tolerances;

pub use text::{list, text};

/// Largest number of rows in the table of runs; the CSV has all.
const MOST_ROWS: usize = 500;
/// Largest number of selectable figures.
const MOST_FIGURES: usize = 40;

/// Returns the page of a finished sweep; `table`: [its results](pinwheel_studies::sweep::results).
pub fn page(plan: &Plan, rows: &[Row<'_>], table: &Table, origin: &Provenance) -> String {
    let unfinished = sweep::broken(rows).count();
    let sweep = &plan.sweep;
    let keys = sweep.axes.iter().flat_map(|axis| &axis.keys);
    let varied = keys.map(|(key, list)| format!("{key} ({})", list.len()));
    let varied: Vec<String> = varied.collect();
    let sampled = sweep::tolerances(plan, table);
    let over = match sampled.is_empty() {
        true => varied.join(" x "),
        false => format!("samples of {}", varied.join(", ")),
    };
    let runs_done = rows.len();
    let mut lead = match sweep.description.as_str() {
        "" => format!("{runs_done} runs of the scene {} over {over}.", sweep.scene),
        description => description.to_owned(),
    };
    let idle = sweep::idle(plan, rows);
    if !idle.is_empty() {
        let idle = idle.join(", ");
        lead += &format!(
            " No effect on this scene: {idle}. Runs that differ in nothing else are equal to the bit."
        );
    }
    let mut sections = Vec::new();
    if !sampled.is_empty() {
        sections.push(tolerances::section(plan, table, &sampled));
    }
    // Over random values there is no line to draw.
    let most = if sampled.is_empty() { MOST_FIGURES } else { 1 };
    let grid = grid(plan, rows, table, most);
    let answer = answer(&grid, plan);
    let decision = decision(plan, &sampled, grid.figures.first());
    if sampled.is_empty()
        && !grid.figures.is_empty()
        && grid.axes.iter().any(|axis| axis.values.len() > 1)
    {
        sections.push(Section::new("figures", "Figures").with(Block::Grid(grid)));
    }
    let all = Section::new("runs", "Runs").with(runs(plan, rows));
    // Folded if other sections come before.
    sections.push(match sections.is_empty() {
        true => all,
        false => all.folded("Every run: what was varied, how it ended, its figures"),
    });
    let file = Block::Code(sweep.text.trim_end().to_owned());
    let file = Section::new("sweep", "Sweep file").with(file);
    sections.push(file.folded("What was asked for"));
    let versions = rows
        .iter()
        .map(|row| row.engine().map(str::to_owned).into());
    let lost = (unfinished > 0).then(|| Verdict {
        tone: Tone::Bad,
        headline: format!("{unfinished} of {runs_done} runs did not finish"),
        detail: "They are in the table with the reason, and gaps in the figures.".to_owned(),
    });
    let cpu = seconds(rows.iter().map(|row| row.cpu_s).sum());
    let mut tiles = vec![
        Tile::new("Runs", count(runs_done as u64), sweep.engines.join(", ")),
        Tile::new("Varied", varied.len().to_string(), varied.join(", ")),
        Tile::new("Processor time", cpu, "the engines', all runs together"),
    ];
    let simulated_s = simulated_s(plan);
    if simulated_s > 0.0 {
        tiles.push(Tile::new(
            "Simulated",
            seconds(simulated_s),
            "all runs together",
        ));
    }
    let study = Study {
        title: sweep.name.clone(),
        eyebrow: "Sweep".to_owned(),
        lead,
        verdict: lost
            .or_else(|| tolerances::verdict(&sampled))
            .or_else(|| tolerances::spread(plan, &sampled))
            .or(answer),
        decision,
        tiles,
        sections,
        versions: versions.collect(),
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

fn decision(plan: &Plan, sampled: &[SampleResult], first: Option<&GridFigure>) -> Decision {
    let sweep = &plan.sweep;
    let engines = sweep.engines.len();
    let count = counted(engines, "engine", "engines");
    let right = Question::Right.answered(Mark::warn(engines == 1), count, sweep.engines.join(", "));
    let bears = tolerances::bears(sampled);
    let sampled = tolerances::sure(plan, sampled);
    let sure = first.map(|figure| {
        let known = figure.values.iter().zip(&figure.uncertainty);
        let shares = known.filter_map(|(value, off)| Some(off.as_ref()? / value.as_ref()?.abs()));
        let widest = shares.filter(|share| share.is_finite()).reduce(f64::max);
        let answer = widest.map_or("not known".to_owned(), |widest| {
            format!("to {}", relative(widest))
        });
        let why = format!("{}, numerical", figure.label);
        Question::Sure.answered(Mark::warn(widest.is_none()), answer, why)
    });
    let command = format!("pinwheel compare {}", sweep.scene);
    let next = Tile::next(&command, "whether other engines agree on the scene");
    [Some(right), bears, sampled.or(sure), Some(next)]
}

/// Returns the range of the first figure over the runs with its uncertainty, or the statement that no trend exceeds the
/// uncertainty.
fn answer(grid: &Grid, plan: &Plan) -> Option<Verdict> {
    let figure = grid.figures.first()?;
    let parts = |label: &str| -> (String, String) {
        let unit = label.strip_suffix(')').and_then(|l| l.rsplit_once(" ("));
        match unit {
            Some((name, unit)) => (name.to_owned(), format!(" {unit}")),
            None => (label.to_owned(), String::new()),
        }
    };
    let (name, unit) = parts(&figure.label);
    let known = figure.values.iter().enumerate();
    let known = known.filter_map(|(run, value)| Some((run, (*value)?)));
    let (least, low) = known.clone().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (most, high) = known.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let bound = |run: usize| match figure.uncertainty.get(run).copied().flatten() {
        Some(u) => format!(" \u{b1}\u{202f}{}", significant(u, 1)),
        None => String::new(),
    };
    let at = |run: usize| {
        let places = grid.axes.iter().zip(&grid.runs[run]);
        let named = places.filter(|(axis, _)| axis.values.len() > 1);
        let words = named.map(|(axis, place)| {
            let (name, unit) = parts(&axis.label);
            format!("{} {}{unit}", name.to_lowercase(), axis.values[*place])
        });
        joined(", ", words)
    };
    let off = figure.uncertainty.iter().flatten().copied();
    let off = off.fold(f64::NAN, f64::max);
    let [from, to] = [(low, least), (high, most)]
        .map(|(value, run)| format!("{}{}", significant(value, 4), bound(run)));
    let headline = match high - low <= 2.0 * off {
        true => format!("{name}: no trend beyond what the runs may be off by"),
        false => format!("{name}: {from} to {to}{unit}"),
    };
    let (least, most, runs) = (at(least), at(most), plan.len());
    Some(Verdict {
        tone: Tone::Neutral,
        headline,
        detail: format!("Least at {least}; largest at {most}; over {runs} runs."),
    })
}

/// Returns the simulated time of all runs, s; balances have none.
fn simulated_s(plan: &Plan) -> f64 {
    let engines = plan.sweep.engines.iter().cycle();
    let moving = (0..plan.len())
        .zip(engines)
        .filter(|(_, engine)| *engine != STATICS);
    moving.fold(0.0, |sum, (run, _)| sum + plan.duration_s(run))
}

/// Returns heading and unit of a column, if it is a figure.
fn heading(name: &str, rows: &[Row<'_>]) -> Option<(String, String)> {
    let share = match name {
        "efficiency" => Some("Efficiency"),
        "efficiency_accounted" => Some("Efficiency by what is lost"),
        _ => None,
    };
    if let Some(words) = share {
        return Some((words.to_owned(), String::new()));
    }
    if rows.iter().any(|row| row.balance(name).is_some()) {
        let FigureDef { label, unit, .. } = definition(name);
        return Some((label.into_owned(), unit.into_owned()));
    }
    let (word, quantity) = name.split_once('_')?;
    let (label, unit) = quantities::label_and_unit(quantity);
    let is_known = ["mean", "peak", "rms"].contains(&word);
    is_known.then(|| (format!("{label}, {word}"), unit))
}

/// Returns a column of differing numbers as a figure.
fn figure(column: &Column, rows: &[Row<'_>]) -> Option<GridFigure> {
    let Values::Number(values) = &column.values else {
        return None;
    };
    let (label, unit) = heading(&column.name, rows)?;
    let mut present = values.iter().flatten();
    let first = present.next()?;
    present.find(|value| *value != first)?;
    let (unit, factor) = readable_unit(&unit, largest(values.iter().flatten()));
    let scaled = |value: &Option<f64>| value.map(|v| factor * v);
    let off = rows.iter().zip(values);
    let off = off.map(|(row, value)| Some(factor * uncertainty(*row, &column.name, (*value)?)?));
    Some(GridFigure {
        label: named(&label, &unit),
        values: values.iter().map(scaled).collect(),
        uncertainty: off.collect(),
    })
}

/// Returns the largest magnitude.
fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let values = values.into_iter();
    values.fold(0.0, |most, value| value.abs().max(most))
}

/// Returns a grid of the varied keys, and of several engines, with the first `most` figures that differ between runs.
fn grid(plan: &Plan, rows: &[Row<'_>], table: &Table, most: usize) -> Grid {
    let mut axes: Vec<GridAxis> = plan.sweep.axes.iter().map(axis).collect();
    let engines = &plan.sweep.engines;
    if engines.len() > 1 {
        axes.push(GridAxis {
            label: "engine".to_owned(),
            values: engines.clone(),
            numbers: None,
        });
    }
    let mut columns: Vec<&Column> = table.columns.iter().collect();
    // Peaks of forces and means of torques come first; the rest follows in its order.
    columns.sort_by_key(|column| match column.name.as_str() {
        "peak_external_sleeve_force_n" => 0,
        "peak_internal_sleeve_force_n" => 1,
        "mean_input_torque_n_m" => 2,
        "efficiency_accounted" => 3,
        name if name.starts_with("rms_") || name.ends_with("_rad") => 5,
        _ => 4,
    });
    let columns = columns.into_iter();
    let figures = columns.filter_map(|column| figure(column, rows));
    Grid {
        figures: figures.take(most).collect(),
        runs: (0..plan.len()).map(|run| plan.places(run)).collect(),
        axes,
    }
}

/// Returns an axis with readable labels and units; of keys that change together the first, with the others' names.
fn axis(axis: &Axis) -> GridAxis {
    let Some((key, values)) = axis.keys.first() else {
        return GridAxis::default();
    };
    // Units of keys that quantities do not have.
    const OWN: [(&str, &str); 2] = [("_n_s_m", "N s/m"), ("_kg_m3", "kg/m\u{b3}")];
    let name = |key: &str| {
        let key = key.rsplit('.').next().unwrap_or(key);
        let mut own = OWN.iter();
        match own.find_map(|(suffix, unit)| Some((key.strip_suffix(suffix)?, *unit))) {
            Some((stem, unit)) => (quantities::label_and_unit(stem).0, unit.to_owned()),
            None => quantities::label_and_unit(key),
        }
    };
    let (mut label, unit) = name(key);
    for (other, _) in &axis.keys[1..] {
        label.push_str(&format!(" with {}", name(other).0.to_lowercase()));
    }
    let numbers: Option<Vec<f64>> = values.iter().map(Value::number).collect();
    let Some(numbers) = numbers else {
        return GridAxis {
            label,
            values: values.iter().map(ToString::to_string).collect(),
            numbers: None,
        };
    };
    let (unit, factor) = readable_unit(&unit, largest(&numbers));
    let numbers: Vec<f64> = numbers.iter().map(|v| factor * v).collect();
    GridAxis {
        label: named(&label, &unit),
        values: numbers.iter().map(|v| plain(*v)).collect(),
        numbers: Some(numbers),
    }
}

/// Returns the uncertainty of a figure: the engine's own, that of sampling, and for means the effect of the window's
/// position.
fn uncertainty(row: Row<'_>, column: &str, value: f64) -> Option<f64> {
    let torque = column.contains("torque") || column == "efficiency";
    let [forces, driver] = row.uncertainty.unwrap_or([f64::NAN; 2]);
    let share = if torque { driver } else { forces };
    let numerical = value.abs() * share + row.sampling(column).unwrap_or(0.0);
    let mean_of = column.strip_prefix("mean_");
    let spread = mean_of.and_then(|quantity| row.figure(quantity));
    let drift = spread.map_or(f64::NAN, |spread| spread.drift);
    // Unknown parts add nothing; without any the result is unknown.
    let parts = [numerical, drift].into_iter();
    parts.filter(|part| part.is_finite()).reduce(f64::hypot)
}

/// Returns the table of runs.
fn runs(plan: &Plan, rows: &[Row<'_>]) -> Vec<Block> {
    let all = rows.len();
    let first = &rows[..all.min(MOST_ROWS)];
    let reasons = first.iter().enumerate().filter_map(|(run, row)| {
        let reason = Some(row.reason()).filter(|reason| !reason.is_empty())?;
        Some(format!("Run {}: {reason}", run + 1))
    });
    let reasons: Vec<String> = reasons.collect();
    let mut shown = sweep::results(plan, first).without_empty();
    // Figures are shaded from the column's least to its largest.
    for column in &mut shown.columns {
        if let Some(place) = plan.keys().position(|key| key == column.name) {
            let value = |run: usize| Some(plan.values(run)[place].to_string());
            column.display = (0..first.len()).map(value).collect();
            continue;
        }
        let mut prefixes = ["mean_", "peak_", "rms_", "efficiency"].iter();
        let figure = prefixes.any(|prefix| column.name.starts_with(prefix));
        let Values::Number(values) = &column.values else {
            continue;
        };
        let there = || values.iter().flatten().copied();
        let low = there().fold(f64::INFINITY, f64::min);
        let high = there().fold(f64::NEG_INFINITY, f64::max);
        if figure && high > low {
            let shade = |value: &Option<f64>| value.map(|v| 0.6 * (v - low) / (high - low));
            column.shades = values.iter().map(shade).collect();
        }
    }
    let mut blocks = Vec::new();
    if shown.len() < all {
        let count = shown.len();
        blocks.push(format!("The first {count} of {all} runs; results.csv has all.").into());
    }
    blocks.push(shown.into());
    if !reasons.is_empty() {
        let title = "Remarks on runs: how they ended, and which figures to read with care";
        blocks.push(Block::folded(title, Block::List(reasons)));
    }
    blocks
}
