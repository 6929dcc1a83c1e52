//! Error against cost on published mechanisms.

use pinwheel_report::format::{limit, seconds};
use pinwheel_report::study::{Axis, Block, Cell, Chart, Column, Section, Series, Style, Table};
use pinwheel_studies::precision::front::cost_at;
use pinwheel_studies::precision::mechanisms::{MechanismStudy, MethodSolves};
use pinwheel_studies::precision::{Knob, Measure};

use super::figures;

/// Errors whose cost is shown, m or rad.
const ERRORS: [f64; 3] = [1e-4, 1e-7, 1e-10];

/// The section.
pub(super) fn section(found: &[MechanismStudy]) -> Section {
    let mut blocks = vec![Block::Text(
        "The same integrators on mechanisms whose solutions others published, in the saddle-point form with joints kept \
         by projection. There is no contact and nothing switches, so every method shows its order. The error is \
         the largest deviation of the published coordinates (m or rad) at the published times."
            .to_owned(),
    )];
    blocks.push(costs(found));
    for study in found {
        blocks.push(Block::Heading(format!(
            "{}: {} bodies, {} s",
            study.name, study.bodies, study.duration_s
        )));
        blocks.push(Block::Charts(vec![
            chart(study, Measure::Cpu),
            chart(study, Measure::Rhs),
        ]));
        blocks.push(Block::Details {
            summary: format!("{}: all runs, source", study.name),
            blocks: vec![Block::Text(study.source.clone()), runs(study)],
        });
    }
    Section {
        id: "mechanisms".to_owned(),
        title: "Published mechanisms".to_owned(),
        blocks,
    }
}

fn costs(found: &[MechanismStudy]) -> Block {
    let mut columns = vec![Column::text("Mechanism"), Column::text("Method")];
    for error in ERRORS {
        columns.push(Column::number(format!("CPU at {}", limit(error))));
        columns.push(Column::number("calls"));
    }
    let mut rows = Vec::new();
    for study in found {
        for series in &study.series {
            let mut row = vec![
                Cell::text(study.name.clone()),
                Cell::text(series.method.clone()),
            ];
            for error in ERRORS {
                let cost = |measure| cost_at(&series.points(measure), error);
                row.push(figures::cell(cost(Measure::Cpu), figures::cpu));
                row.push(figures::cell(cost(Measure::Rhs), figures::count));
            }
            rows.push(row);
        }
    }
    Block::Table(Table {
        caption: "Cost of an error on published mechanisms".to_owned(),
        columns,
        rows,
    })
}

fn chart(study: &MechanismStudy, measure: Measure) -> Chart {
    let series = study.series.iter().enumerate().map(|(k, series)| {
        let points = series.points(measure);
        let name = knob(series);
        Series {
            label: series.method.clone(),
            style: Style::Both,
            x: points.iter().map(|p| p.0).collect(),
            y: points.iter().map(|p| p.1).collect(),
            tags: series
                .points
                .iter()
                .filter(|p| p.error.is_some())
                .map(|p| format!("{name} {}", figures::setting(p.setting)))
                .collect(),
            colour: Some(k),
        }
    });
    let (title, axis) = match measure {
        Measure::Cpu => ("Error against CPU time", "CPU time (s)"),
        Measure::Rhs => ("Error against right-hand sides", "right-hand-side calls"),
    };
    Chart {
        title: title.to_owned(),
        x: Axis::log(axis),
        y: Axis::log("largest deviation (m or rad)"),
        series: series.collect(),
        note: String::new(),
    }
}

fn knob(series: &MethodSolves) -> &'static str {
    match series.knob {
        Knob::StepS => "step",
        Knob::Tolerance => "tolerance",
    }
}

fn runs(study: &MechanismStudy) -> Block {
    let mut rows = Vec::new();
    for series in &study.series {
        for point in &series.points {
            rows.push(vec![
                Cell::text(series.method.clone()),
                Cell::number(
                    format!("{} {}", knob(series), figures::setting(point.setting)),
                    point.setting,
                ),
                match (point.error, &point.failure) {
                    (Some(error), _) => Cell::number(format!("{error:.2e}"), error),
                    (None, reason) => Cell::text(reason.clone().unwrap_or_default()),
                },
                Cell::number(seconds(point.cpu_min_s), point.cpu_min_s),
                Cell::number(seconds(point.cpu_median_s), point.cpu_median_s),
                Cell::number(point.runs.to_string(), point.runs as f64),
                Cell::number(point.rhs_calls.to_string(), point.rhs_calls as f64),
                Cell::number(point.steps.to_string(), point.steps as f64),
            ]);
        }
    }
    Block::Table(Table {
        caption: format!("{}: all runs", study.name),
        columns: vec![
            Column::text("Method"),
            Column::number("Setting"),
            Column::number("Error"),
            Column::number("CPU, minimum"),
            Column::number("CPU, median"),
            Column::number("Runs"),
            Column::number("RHS calls"),
            Column::number("Steps"),
        ],
        rows,
    })
}
