//! The page of `pinwheel bench`: headline, then scene, mechanisms, scaling and batch.

use pinwheel_report::format::{limit, relative, seconds, significant};
use pinwheel_report::study::{Block, Section, Study, Tile, Tone, Verdict, render};
use pinwheel_studies::precision::{Advantage, Ranking, WorkPrecision};

use pinwheel_studies::Provenance;
use pinwheel_studies::bench::Outcome as Measured;

use crate::PageError;

mod batch;
mod figures;
mod mechanisms;
mod scaling;
mod scene;
mod text;

pub use figures::failure;
pub use text::text;

/// Everything on the page.
///
/// # Errors
/// The page cannot be made.
pub fn page(measured: &Measured, made: &Provenance) -> Result<String, PageError> {
    let rankings = &measured.rankings();
    let mut study = Study {
        title: measured.scene.name.clone(),
        eyebrow: "Speed against error".to_owned(),
        lead: lead(measured),
        verdict: None,
        tiles: Vec::new(),
        sections: Vec::new(),
        command: made.command.clone(),
        versions: versions(measured, made),
        machine: made.machine.rows(),
    };
    if let (Some(found), Some(ranking)) = (&measured.study, rankings.first()) {
        study.verdict = ranking
            .advantage
            .as_ref()
            .map(|lead| verdict(found, ranking, lead));
        study.tiles = tiles(found, ranking);
        study
            .sections
            .extend(scene::sections(found, rankings, &measured.unequal));
    }
    // Beside a scene the rest is depth; alone it is what was asked for.
    let alone = measured.study.is_none();
    let mut add = |section: Section, beside: &str| {
        study.sections.push(if alone {
            section
        } else {
            section.folded(beside)
        });
    };
    if let Some(found) = &measured.mechanisms {
        add(
            mechanisms::section(found),
            "The same methods on mechanisms with published solutions",
        );
    }
    if let Some(found) = &measured.scaling {
        add(
            scaling::section(found),
            "Cost of a right-hand side over the size of the gear",
        );
    }
    if let Some(found) = &measured.batch {
        add(
            batch::section(found),
            "Gears a second on one core, as in a sweep",
        );
    }
    if !measured.complete {
        study.sections.insert(
            0,
            Section {
                id: "incomplete".to_owned(),
                title: "Incomplete".to_owned(),
                blocks: vec![Block::Text(
                    "The measurement was stopped by the user. What had been measured until then stands here; \
                     what is missing is not a result."
                        .to_owned(),
                )],
            },
        );
    }
    Ok(render(&study)?)
}

fn lead(measured: &Measured) -> String {
    let scene = &measured.scene;
    if measured.study.is_none() {
        return "What integrators cost on published mechanisms, how the cost grows with the gear, and how many gears a second a core \
             gets through.".to_owned();
    }
    format!(
        "What accuracy costs: every engine, integrator and step on the scene {} over {} s, against a converged run. \
         All runs were made in one session on one machine.",
        scene.name, scene.solver.duration_s
    )
}

fn versions(measured: &Measured, made: &Provenance) -> Vec<(String, String)> {
    let mut versions = made.versions();
    for series in measured.study.iter().flat_map(|study| &study.series) {
        if !versions.iter().any(|(name, _)| *name == series.engine) {
            versions.push((series.engine.clone(), series.version.clone()));
        }
    }
    versions
}

fn verdict(study: &WorkPrecision, ranking: &Ranking, lead: &Advantage) -> Verdict {
    let factor = significant(lead.ratio, 2);
    Verdict {
        tone: Tone::Neutral,
        headline: format!(
            "At a force error of {} the native solver is {}{factor} times faster than the fastest peer",
            limit(ranking.error),
            if lead.at_least { "at least " } else { "" },
        ),
        detail: format!(
            "{} takes {} of CPU time, {} takes {}; relative L2 error of all sleeve forces over the whole {} s, \
             start-up included; interpolated between runs in the log-log plane.{}",
            lead.native,
            figures::cpu(lead.native_cpu_s),
            lead.peer,
            figures::cpu(lead.peer_cpu_s),
            study.duration_s,
            if lead.at_least {
                " A bound stands where a series ends before this error."
            } else {
                ""
            }
        ),
    }
}

fn tiles(study: &WorkPrecision, ranking: &Ranking) -> Vec<Tile> {
    let mut tiles = Vec::new();
    if let Some(lead) = &ranking.advantage {
        tiles.push(Tile {
            label: "Native".to_owned(),
            value: figures::cpu(lead.native_cpu_s),
            unit: String::new(),
            detail: format!("CPU time at {}: {}", limit(ranking.error), lead.native),
        });
        tiles.push(Tile {
            label: "Fastest peer".to_owned(),
            value: figures::cpu(lead.peer_cpu_s),
            unit: String::new(),
            detail: format!("CPU time at {}: {}", limit(ranking.error), lead.peer),
        });
        tiles.push(Tile {
            label: "Ratio".to_owned(),
            value: format!(
                "{}{}",
                if lead.at_least {
                    "\u{2265}\u{202f}"
                } else {
                    ""
                },
                significant(lead.ratio, 3)
            ),
            unit: String::new(),
            detail: "peer over native, same error, same session".to_owned(),
        });
    }
    let error = study.reference.error(0);
    tiles.push(Tile {
        label: "Reference".to_owned(),
        value: relative(error.force_l2),
        unit: String::new(),
        detail: format!(
            "distance of {} and {} over the whole run",
            study.reference.solution.method, study.reference.second.method
        ),
    });
    let runs: usize = study
        .series
        .iter()
        .flat_map(|series| &series.points)
        .filter_map(|point| point.cost)
        .map(|cost| cost.runs)
        .sum();
    let spent: f64 = study
        .series
        .iter()
        .flat_map(|series| &series.points)
        .filter_map(|point| point.cost)
        .map(|cost| cost.cpu_median_s * cost.runs as f64)
        .sum();
    tiles.push(Tile {
        label: "Runs".to_owned(),
        value: runs.to_string(),
        unit: String::new(),
        detail: format!("about {} of CPU time in all", seconds(spent)),
    });
    tiles
}
