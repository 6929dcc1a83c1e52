//! The stability study.

mod damping;
mod maps;
mod text;

pub use text::text;

use pinwheel_report::format;
use pinwheel_report::study::{
    self, Axis, Block, Cell, Chart, Column, Mark, Section, Series, Study, Style, Table, Tile, Tone,
    Verdict,
};
use pinwheel_studies::divergence::{Horizon, VISIBLE};
use pinwheel_studies::survey::Survey;

use pinwheel_studies::Provenance;
use pinwheel_studies::survey::judged;

use crate::PageError;

/// The whole page.
///
/// # Errors
/// The page cannot be made.
pub fn page(survey: &Survey, made: &Provenance) -> Result<String, PageError> {
    let mut sections = maps::sections(survey);
    sections.insert(0, scenes(survey));
    sections.push(divergence(survey));
    sections.extend(drift(survey));
    sections.extend(damping::section(survey));
    Ok(study::render(&Study {
        title: "Stability on hard cases".to_owned(),
        eyebrow: "Pinwheel stability study".to_owned(),
        lead: "Every hard scene with every formulation and integrator: the largest step that works, the error at the paper's step, \
               what fails first, and where the energy goes."
            .to_owned(),
        verdict: Some(verdict(survey)),
        tiles: tiles(survey),
        sections,
        command: made.command.clone(),
        versions: made.versions(),
        machine: made.machine.rows(),
    })?)
}

fn verdict(survey: &Survey) -> Verdict {
    let (done, all) = survey.done();
    let rows = survey.rows.iter().flatten().count();
    let unserved = judged::unserved(survey);
    let served = format!("{} %", 100.0 * judged::SERVED);
    let stopped = if done < all {
        format!(" The study was stopped: {done} of {all} pieces are done.")
    } else {
        String::new()
    };
    let detail = format!(
        "Forces against a converged run, at a step of {} or the tolerance in the column's head.{stopped}",
        format::seconds(survey.plan.atlas.step_s)
    );
    if rows == 0 {
        Verdict {
            tone: Tone::Bad,
            headline: "No scene of the atlas is done yet".to_owned(),
            detail,
        }
    } else if unserved.is_empty() {
        Verdict {
            tone: Tone::of(done == all),
            headline: format!(
                "Each of the {rows} scenes has a method that gives it within {served}"
            ),
            detail,
        }
    } else {
        Verdict {
            tone: Tone::Bad,
            headline: format!(
                "{} of {rows} scenes have no method within {served}: {}",
                unserved.len(),
                unserved.join(", ")
            ),
            detail,
        }
    }
}

fn tiles(survey: &Survey) -> Vec<Tile> {
    let rows = || survey.rows.iter().flatten();
    let cells = || rows().flat_map(|row| &row.cells);
    let tile = |label: &str, value: String, unit: &str, detail: String| Tile {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
        detail,
    };
    let failed = cells().filter(|cell| cell.failure.is_some()).count();
    let mut tiles = vec![tile(
        "Scene and method",
        cells().count().to_string(),
        "pairs",
        format!(
            "{failed} of them fail at {}",
            format::seconds(survey.plan.atlas.step_s)
        ),
    )];
    let bests = rows().filter_map(|row| judged::best(row).map(|(_, error)| (error, &row.scene)));
    if let Some((error, scene)) = bests.max_by(|a, b| a.0.total_cmp(&b.0)) {
        tiles.push(tile(
            "Hardest scene",
            format::relative(error),
            "",
            format!("{scene}, error of the forces with the best method"),
        ));
    }
    let growth = survey
        .horizons
        .iter()
        .flatten()
        .filter(|h| h.refused.is_none())
        .max_by(|a, b| a.largest_share.total_cmp(&b.largest_share));
    if let Some(horizon) = growth {
        tiles.push(tile(
            "A rounding grows to",
            format::significant(horizon.largest_share, 2),
            "of the largest force",
            format!("at most, on {}", horizon.scene),
        ));
    }
    if let Some(projected) = survey.drift.as_ref().and_then(|d| d.last())
        && projected.failure.is_none()
        && let Some(joint) = projected.joint_m
    {
        tiles.push(tile(
            "Joint drift",
            format::metres(joint),
            "",
            format!(
                "over {} s with projection",
                survey.plan.drift_s.unwrap_or_default()
            ),
        ));
    }
    tiles
}

fn scenes(survey: &Survey) -> Section {
    let rows = survey.rows.iter().flatten().map(|row| {
        let auto = row
            .cells
            .iter()
            .find(|cell| {
                cell.method.integrator == row.auto
                    && cell.method.formulation == pinwheel_scene::Formulation::Reduced
            })
            .and_then(judged::error);
        let served = |error: f64| {
            if error <= judged::SERVED {
                Mark::Good
            } else {
                Mark::Warn
            }
        };
        vec![
            Cell::text(&row.scene),
            match auto {
                Some(error) => Cell::text(format!("{}: {}", row.auto, format::relative(error)))
                    .marked(served(error)),
                None => Cell::text(&row.auto),
            },
            match judged::best(row) {
                Some((cell, error)) => Cell::number(
                    format!(
                        "{}: {}",
                        judged::name(&cell.method),
                        format::relative(error)
                    ),
                    error,
                )
                .marked(served(error)),
                None => Cell::text("none").marked(Mark::Bad),
            },
        ]
    });
    let references = survey.rows.iter().flatten().map(|row| {
        vec![
            Cell::text(&row.scene),
            match (&row.reference, &row.refused) {
                (Some(reference), _) => Cell::text(format!(
                    "{} at {:.1e}",
                    reference.integrator, reference.setting
                )),
                (None, reason) => Cell::text(reason.clone().unwrap_or_default()).marked(Mark::Bad),
            },
            match &row.reference {
                Some(reference) => Cell::number(
                    format::relative(reference.own_error.forces),
                    reference.own_error.forces,
                ),
                None => Cell::text("-").marked(Mark::Muted),
            },
            Cell::text(&row.why),
        ]
    });
    Section {
        id: "scenes".to_owned(),
        title: "Scenes".to_owned(),
        blocks: vec![
            Block::Table(Table {
                caption: "What integrator = auto takes for a hard scene, and what does best, with the errors of the forces"
                    .to_owned(),
                columns: vec![
                    Column::text("Scene"),
                    Column::text("auto"),
                    Column::text("Best"),
                ],
                rows: rows.collect(),
            }),
            Block::Details {
                summary: "Why each is hard, and the converged run that errors are measured against".to_owned(),
                blocks: vec![Block::Table(Table {
                    caption: "Method with its step or tolerance, and how far a run at twice the step, or ten times the tolerance, \
                              lies from it"
                        .to_owned(),
                    columns: vec![
                        Column::text("Scene"),
                        Column::text("Converged run"),
                        Column::number("Distance of a coarser one, forces"),
                        Column::text("Why it is hard"),
                    ],
                    rows: references.collect(),
                })],
            },
        ],
    }
}

fn divergence(survey: &Survey) -> Section {
    let found: Vec<&Horizon> = survey.horizons.iter().flatten().collect();
    let chaotic: Vec<&str> = found
        .iter()
        .filter(|h| h.horizon_s.is_some())
        .map(|h| h.scene.as_str())
        .collect();
    let told = if chaotic.is_empty() {
        "Within these runs no scene is chaotic: a comparison point by point means something to their end.".to_owned()
    } else {
        format!(
            "Beyond the horizon of {} courses can be compared by their statistics only (mean, RMS, peak), whatever the solver.",
            chaotic.join(", ")
        )
    };
    let rows = found.iter().map(|h| {
        let (horizon, mark) = match (&h.refused, h.horizon_s) {
            (Some(reason), _) => (reason.clone(), Mark::Muted),
            (None, Some(t)) => (format!("{t:.4} s"), Mark::Warn),
            (None, None) => (format!("none in {} s", h.duration_s), Mark::Good),
        };
        let figure = |value: f64| Cell::number(format::significant(value, 2), value);
        vec![
            Cell::text(&h.scene),
            Cell::text(horizon).marked(mark),
            figure(h.largest_share),
            figure(h.last_share),
        ]
    });
    let mut grown: Vec<&&Horizon> = found.iter().filter(|h| h.refused.is_none()).collect();
    grown.sort_by(|a, b| b.largest_share.total_cmp(&a.largest_share));
    let series = grown.iter().take(6).map(|h| Series {
        label: h.scene.clone(),
        style: Style::Line,
        x: h.time_s.clone(),
        y: h.share.clone(),
        ..Series::default()
    });
    Section {
        id: "divergence".to_owned(),
        title: "Divergence".to_owned(),
        blocks: vec![
            Block::Text(format!(
                "Each scene runs twice with the same fixed steps, the second time with the wheels' moment of inertia moved to the next \
                 representable number. The horizon is where the forces first differ by {VISIBLE:.0e} of the largest. {told}"
            )),
            Block::Charts(vec![Chart {
                title: "Where it grows most".to_owned(),
                x: Axis::linear("Time (s)"),
                y: Axis::log("share of the largest force"),
                series: series.collect(),
                note: "A chaotic scene would rise as a straight line up to 1.".to_owned(),
            }]),
            Block::Details {
                summary: "Every scene".to_owned(),
                blocks: vec![Block::Table(Table {
                    caption:
                        "What a change in the last digit grows to, as a share of the largest force"
                            .to_owned(),
                    columns: vec![
                        Column::text("Scene"),
                        Column::text("Horizon"),
                        Column::number("Largest"),
                        Column::number("In the last tenth"),
                    ],
                    rows: rows.collect(),
                })],
            },
        ],
    }
}

fn drift(survey: &Survey) -> Option<Section> {
    let found = survey.drift.as_ref()?;
    let rows = found.iter().map(|drift| {
        let name = serde_json::to_value(drift.stabilisation)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default();
        let figure = |value: Option<f64>| match value {
            Some(value) => Cell::number(format::significant(value, 2), value),
            None => Cell::text("-").marked(Mark::Muted),
        };
        vec![
            Cell::text(name),
            figure(drift.joint_m),
            figure(drift.against_reduced.map(|d| d.forces)),
            figure(drift.against_reduced.map(|d| d.driver_torque)),
            figure(drift.phase_rad),
            Cell::text(drift.failure.clone().unwrap_or_default()),
        ]
    });
    Some(Section {
        id: "drift".to_owned(),
        title: "Long run".to_owned(),
        blocks: vec![Block::Details {
            summary: "what joints, forces and phase do over a long time".to_owned(),
            blocks: vec![
                Block::Text(format!(
                    "The preset `paper` over {} s with all bodies and multipliers, under each stabilisation, against the reduced form, which \
                 has no joints that could come apart.",
                    survey.plan.drift_s.unwrap_or_default()
                )),
                Block::Table(Table {
                    caption: "Joints, forces and phase after a long run".to_owned(),
                    columns: vec![
                        Column::text("Stabilisation"),
                        Column::number("Joint error (m)"),
                        Column::number("Forces (relative L2)"),
                        Column::number("Driver torque (relative L2)"),
                        Column::number("Output angle at the end (rad)"),
                        Column::text("Failure"),
                    ],
                    rows: rows.collect(),
                }),
            ],
        }],
    })
}
