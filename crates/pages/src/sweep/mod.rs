//! A sweep's page: figures over what was varied, and every run in a table.

use pinwheel_compare::quantities;
use pinwheel_report::format::{count, seconds, significant};
use pinwheel_report::study::{
    Axis, Block, Cell, Chart, Column as Heading, Mark, Section, Series, Study, Style, Table, Tile,
    Verdict, render,
};
use pinwheel_studies::sweep::{Column, Plan, Results, RunRecord};

use pinwheel_studies::Provenance;

use crate::PageError;

mod text;

pub use text::{list, text};

/// Rows of the table of runs at most; the CSV has all.
const MOST_ROWS: usize = 500;
/// Curves of a chart at most: more cannot be told apart.
const MOST_SERIES: usize = 8;
/// Charts at most.
const MOST_CHARTS: usize = 24;
/// A numeric axis whose values span more than this factor is logarithmic.
const LOG_SPAN: f64 = 30.0;

/// The page of a finished sweep; `table`: [its results](pinwheel_studies::sweep::results).
///
/// # Errors
/// The page cannot be made.
pub fn page(
    plan: &Plan,
    records: &[RunRecord],
    table: &Results,
    made: &Provenance,
) -> Result<String, PageError> {
    let unfinished = records
        .iter()
        .filter(|record| !record.ending.is_finished())
        .count();
    let cpu: f64 = records.iter().map(|record| record.cpu_s).sum();
    let tile = |label: &str, value: String, detail: String| Tile {
        label: label.to_owned(),
        value,
        unit: String::new(),
        detail,
    };
    let sweep = &plan.sweep;
    let varied: Vec<String> = sweep
        .axes
        .iter()
        .flat_map(|axis| {
            axis.keys
                .iter()
                .map(|(key, list)| format!("{key} ({})", list.len()))
        })
        .collect();
    let lead = if sweep.description.is_empty() {
        format!(
            "{} runs of the scene {} over {}.",
            records.len(),
            sweep.scene,
            varied.join(" x ")
        )
    } else {
        sweep.description.clone()
    };
    let mut sections = Vec::new();
    let (charts, note) = charts(plan, table);
    if !charts.is_empty() {
        let mut blocks = vec![Block::Text(note)];
        blocks.push(Block::Charts(charts));
        sections.push(Section {
            id: "figures".to_owned(),
            title: "Figures".to_owned(),
            blocks,
        });
    }
    sections.push(Section {
        id: "runs".to_owned(),
        title: "Runs".to_owned(),
        blocks: runs(plan, table),
    });
    sections.push(Section {
        id: "sweep".to_owned(),
        title: "Sweep file".to_owned(),
        blocks: vec![Block::Code(sweep.text.trim_end().to_owned())],
    });
    let mut versions = made.versions();
    for record in records {
        let version = (record.engine.clone(), record.engine_version.clone());
        if !versions.contains(&version) {
            versions.push(version);
        }
    }
    let study = Study {
        title: sweep.name.clone(),
        eyebrow: "Sweep".to_owned(),
        lead,
        verdict: (unfinished > 0).then(|| Verdict {
            good: false,
            headline: format!("{unfinished} of {} runs did not finish", records.len()),
            detail: "They are in the table with the reason, and gaps in the figures.".to_owned(),
        }),
        tiles: vec![
            tile(
                "Runs",
                count(records.len() as u64),
                sweep.engines.join(", "),
            ),
            tile("Varied", varied.len().to_string(), varied.join(", ")),
            tile(
                "Simulated",
                seconds(plan.duration_s()),
                "all runs together".to_owned(),
            ),
            tile(
                "Processor time",
                seconds(cpu),
                "the engines', all runs together".to_owned(),
            ),
        ],
        sections,
        command: made.command.clone(),
        versions,
        machine: made.machine.rows(),
    };
    Ok(render(&study)?)
}

/// A figure that is charted: column, heading, unit.
struct Figure<'a> {
    column: &'a str,
    values: &'a [Option<f64>],
    label: String,
    unit: String,
}

/// Numeric figures that are not the same in every run.
fn figures<'a>(table: &'a Results) -> Vec<Figure<'a>> {
    const WORDS: [(&str, &str); 3] = [("mean_", "mean"), ("peak_", "peak"), ("rms_", "rms")];
    let mut list = Vec::new();
    for (name, column) in &table.columns {
        let Column::Number(values) = column else {
            continue;
        };
        let (label, unit) = if name == "efficiency" {
            (
                "Efficiency, by means, with what the contact law creates".to_owned(),
                String::new(),
            )
        } else if name == "efficiency_accounted" {
            (
                "Efficiency, what the contact law creates taken out".to_owned(),
                String::new(),
            )
        } else if let Some((word, quantity)) = WORDS
            .iter()
            .find_map(|(prefix, word)| name.strip_prefix(prefix).map(|rest| (word, rest)))
        {
            let (label, unit) = quantities::label_and_unit(quantity);
            (format!("{label}, {word}"), unit)
        } else {
            continue;
        };
        let mut present = values.iter().flatten();
        let first = present.next();
        if first.is_some_and(|first| present.any(|value| value != first)) {
            list.push(Figure {
                column: name,
                values,
                label,
                unit,
            });
        }
    }
    // Peaks of forces and means of torques say most; the rest follows in its order.
    let rank = |figure: &Figure<'_>| match figure.column {
        "peak_external_sleeve_force_n" => 0,
        "peak_internal_sleeve_force_n" => 1,
        "mean_input_torque_n_m" => 2,
        "efficiency_accounted" => 3,
        name if name.starts_with("rms_") || name.ends_with("_rad") => 5,
        _ => 4,
    };
    list.sort_by_key(rank);
    list
}

/// The charts and a sentence on how they are laid out.
fn charts(plan: &Plan, table: &Results) -> (Vec<Chart>, String) {
    let keys: Vec<&str> = plan.keys().collect();
    let at = |place: usize, run: usize| plan.runs[run].values[place].1.number();
    let distinct = |place: usize| {
        let mut values: Vec<f64> = (0..plan.runs.len())
            .filter_map(|run| at(place, run))
            .collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    // The axis with most values lies along x.
    let numeric =
        (0..keys.len()).filter(|&place| (0..plan.runs.len()).all(|run| at(place, run).is_some()));
    let along = numeric
        .map(|place| (place, distinct(place)))
        .filter(|(_, values)| values.len() > 1)
        .max_by(|a, b| {
            // Of two with as many values the first.
            a.1.len().cmp(&b.1.len()).then(b.0.cmp(&a.0))
        });
    let Some((along, places)) = along else {
        return (Vec::new(), String::new());
    };
    let log = places[0] > 0.0 && places[places.len() - 1] / places[0] > LOG_SPAN;
    // Keys that change in step with x say nothing more.
    let with_x: Vec<usize> = plan
        .sweep
        .axes
        .iter()
        .scan(0, |start, axis| {
            let range = *start..*start + axis.keys.len();
            *start = range.end;
            Some(range)
        })
        .find(|range| range.contains(&along))
        .map_or_else(Vec::new, Iterator::collect);
    let name = |run: usize| {
        let others = plan.runs[run]
            .values
            .iter()
            .enumerate()
            .filter(|(place, _)| !with_x.contains(place));
        let mut words: Vec<String> = others
            .map(|(place, (_, value))| {
                format!(
                    "{} {value}",
                    keys[place].rsplit('.').next().unwrap_or_default()
                )
            })
            .collect();
        if plan.sweep.engines.len() > 1 {
            words.push(plan.runs[run].engine.clone());
        }
        if words.is_empty() {
            "all runs".to_owned()
        } else {
            words.join(", ")
        }
    };
    let mut series: Vec<(String, Vec<usize>)> = Vec::new();
    for run in 0..plan.runs.len() {
        let label = name(run);
        match series.iter_mut().find(|(known, _)| *known == label) {
            Some((_, runs)) => runs.push(run),
            None => series.push((label, vec![run])),
        }
    }
    for (_, runs) in &mut series {
        runs.sort_by(|&a, &b| {
            at(along, a)
                .partial_cmp(&at(along, b))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
    }
    let shown = series.len().min(MOST_SERIES);
    // Evenly over all of them, both ends included.
    let pick = |k: usize| {
        if shown > 1 {
            k * (series.len() - 1) / (shown - 1)
        } else {
            0
        }
    };
    let chart = |figure: &Figure<'_>| Chart {
        title: figure.label.clone(),
        x: if log {
            Axis::log(keys[along])
        } else {
            Axis::linear(keys[along])
        },
        y: Axis::linear(if figure.unit.is_empty() {
            figure.label.clone()
        } else {
            format!("{} ({})", figure.label, figure.unit)
        }),
        series: (0..shown)
            .map(|k| {
                let (label, runs) = &series[pick(k)];
                Series {
                    label: label.clone(),
                    style: Style::Both,
                    x: runs
                        .iter()
                        .map(|&run| at(along, run).unwrap_or(f64::NAN))
                        .collect(),
                    y: runs
                        .iter()
                        .map(|&run| figure.values[run].unwrap_or(f64::NAN))
                        .collect(),
                    tags: runs.iter().map(|&run| format!("run {}", run + 1)).collect(),
                    colour: None,
                }
            })
            .collect(),
        note: String::new(),
    };
    let all = figures(table);
    let list = all.iter().take(MOST_CHARTS).map(chart).collect();
    let mut note = format!(
        "Each point is a run, its figures taken of the window that the table names. Along the axis: {}.",
        keys[along]
    );
    if shown < series.len() {
        note.push_str(&format!(
            " {shown} of {} combinations of the other keys are drawn; the table has all.",
            series.len()
        ));
    }
    if all.len() > MOST_CHARTS {
        note.push_str(&format!(
            " {MOST_CHARTS} of {} figures that change are drawn.",
            all.len()
        ));
    }
    (list, note)
}

/// The table of runs.
fn runs(plan: &Plan, table: &Results) -> Vec<Block> {
    let varied = plan.keys().count();
    let keep = |name: &str| {
        !["min_", "max_"]
            .iter()
            .any(|prefix| name.starts_with(prefix))
            && name != "reason"
    };
    let columns: Vec<&(String, Column)> = table
        .columns
        .iter()
        .filter(|(name, column)| {
            let empty = (0..column.len()).all(|row| column.cell(row).is_empty());
            keep(name) && !empty
        })
        .collect();
    // Key columns are the plan's own; figures are shaded from the column's least to its largest.
    let figure = |name: &str| {
        ["mean_", "peak_", "rms_"]
            .iter()
            .any(|prefix| name.starts_with(prefix))
            || name.starts_with("efficiency")
    };
    let ends: Vec<Option<(f64, f64)>> = columns
        .iter()
        .map(|(name, column)| match column {
            Column::Number(values) if figure(name) => {
                let low = values
                    .iter()
                    .flatten()
                    .copied()
                    .fold(f64::INFINITY, f64::min);
                let high = values
                    .iter()
                    .flatten()
                    .copied()
                    .fold(f64::NEG_INFINITY, f64::max);
                (high > low).then_some((low, high))
            }
            _ => None,
        })
        .collect();
    let cell = |k: usize, row: usize| {
        let (name, column) = columns[k];
        match column {
            Column::Number(values) => match values[row] {
                Some(value) => {
                    let text = if k < 2 + varied {
                        plan.runs[row].values[k - 2].1.to_string()
                    } else {
                        significant(value, 5)
                    };
                    let cell = Cell::number(text, value);
                    match ends[k] {
                        Some((low, high)) => cell.heated(0.6 * (value - low) / (high - low)),
                        None => cell,
                    }
                }
                None => Cell::text(""),
            },
            Column::Whole(values) => values[row].map_or_else(
                || Cell::text(""),
                |value| Cell::number(value.to_string(), value as f64),
            ),
            Column::Text(values) => {
                let text = values[row].clone().unwrap_or_default();
                let mark = if name == "status" && text != "finished" {
                    Mark::Bad
                } else {
                    Mark::None
                };
                Cell::text(text).marked(mark)
            }
        }
    };
    let rows = table.rows().min(MOST_ROWS);
    let mut blocks = Vec::new();
    if rows < table.rows() {
        blocks.push(Block::Text(format!(
            "The first {rows} of {} runs; results.csv has all.",
            table.rows()
        )));
    }
    blocks.push(Block::Table(Table {
        caption: "Every run: what was varied, how it ended, and its figures over the window"
            .to_owned(),
        columns: columns
            .iter()
            .map(|(name, column)| match column {
                Column::Text(_) => Heading::text(name),
                _ => Heading::number(name),
            })
            .collect(),
        rows: (0..rows)
            .map(|row| (0..columns.len()).map(|k| cell(k, row)).collect())
            .collect(),
    }));
    let reasons: Vec<String> = match table.column("reason") {
        Some(Column::Text(values)) => values
            .iter()
            .enumerate()
            .take(MOST_ROWS)
            .filter_map(|(row, reason)| {
                reason
                    .as_ref()
                    .map(|reason| format!("Run {}: {reason}", row + 1))
            })
            .collect(),
        _ => Vec::new(),
    };
    if !reasons.is_empty() {
        blocks.push(Block::Details {
            summary: "Why runs did not finish".to_owned(),
            blocks: vec![Block::List(reasons)],
        });
    }
    blocks
}
