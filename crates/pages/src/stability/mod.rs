//! The stability study: which method survives which hard scene, and how the others fail.

mod maps;
mod text;

pub use text::text;

use pinwheel_report::format;
use pinwheel_report::study::{
    self, Block, Cell, Column, Mark, Section, Study, Table, Tile, Tone, Verdict,
};
use pinwheel_studies::Provenance;
use pinwheel_studies::stability::{Atlas, SERVED};

use crate::PageError;

/// The whole page.
///
/// # Errors
/// The page cannot be made.
pub fn page(atlas: &Atlas, made: &Provenance) -> Result<String, PageError> {
    let mut sections = maps::sections(atlas);
    sections.insert(0, scenes(atlas));
    Ok(study::render(&Study {
        title: "Stability on hard cases".to_owned(),
        eyebrow: "Pinwheel stability study".to_owned(),
        lead: "Every hard scene with every formulation and integrator: the largest step that works, the error at the paper's step, \
               what fails first, and where the energy goes."
            .to_owned(),
        verdict: Some(verdict(atlas)),
        tiles: tiles(atlas),
        sections,
        command: made.command.clone(),
        versions: made.versions(),
        machine: made.machine.rows(),
    })?)
}

fn verdict(atlas: &Atlas) -> Verdict {
    let (rows, all) = (atlas.done().count(), atlas.rows.len());
    let unserved = atlas.unserved();
    let served = format!("{} %", 100.0 * SERVED);
    let stopped = if rows < all {
        format!(" The study was stopped: {rows} of {all} scenes are done.")
    } else {
        String::new()
    };
    let detail = format!(
        "Forces against a converged run, at a step of {} or the tolerance in the column's head.{stopped}",
        format::seconds(atlas.options.step_s)
    );
    if rows == 0 {
        Verdict {
            tone: Tone::Bad,
            headline: "No scene of the atlas is done yet".to_owned(),
            detail,
        }
    } else if unserved.is_empty() {
        Verdict {
            tone: Tone::of(rows == all),
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

fn tiles(atlas: &Atlas) -> Vec<Tile> {
    let cells = || atlas.done().flat_map(|row| &row.cells);
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
            format::seconds(atlas.options.step_s)
        ),
    )];
    let bests = atlas
        .done()
        .filter_map(|row| Some((row.best()?.1, &row.scene)));
    if let Some((error, scene)) = bests.max_by(|a, b| a.0.total_cmp(&b.0)) {
        tiles.push(tile(
            "Hardest scene",
            format::relative(error),
            "",
            format!("{scene}, error of the forces with the best method"),
        ));
    }
    tiles
}

fn scenes(atlas: &Atlas) -> Section {
    let rows = atlas.done().map(|row| {
        let auto = row
            .cells
            .iter()
            .find(|cell| {
                cell.method.integrator == row.auto
                    && cell.method.formulation == pinwheel_scene::Formulation::Reduced
            })
            .and_then(|cell| cell.right_to());
        let served = |error: f64| {
            if error <= SERVED {
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
            match row.best() {
                Some((cell, error)) => Cell::number(
                    format!("{}: {}", cell.method.name(), format::relative(error)),
                    error,
                )
                .marked(served(error)),
                None => Cell::text("none").marked(Mark::Bad),
            },
        ]
    });
    let references = atlas.done().map(|row| {
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
