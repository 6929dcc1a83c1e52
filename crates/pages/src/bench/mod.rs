//! The page of `pinwheel bench`: headline, what errors cost, the reference, what is unequal, all runs.

use pinwheel_report::format::{limit, relative, seconds, significant};
use pinwheel_report::study::{Block, Section, Study, Tile, Tone, Verdict};
use pinwheel_studies::Provenance;
use pinwheel_studies::bench::{Advantage, Ranking, WorkPrecision};

mod figures;
mod scene;
mod text;

pub use figures::failure;
pub use text::text;

/// Everything on the page.
#[must_use]
pub fn page(measured: &WorkPrecision, made: &Provenance) -> String {
    let rankings = &measured.rankings();
    let ranking = rankings.first();
    let lead_over = ranking.and_then(|ranking| Some((ranking, ranking.advantage.as_ref()?)));
    let mut study = Study {
        title: measured.scene.name.clone(),
        eyebrow: "Speed against error".to_owned(),
        lead: lead(measured),
        verdict: lead_over.map(|(ranking, lead)| verdict(measured, ranking, lead)),
        tiles: tiles(measured, lead_over),
        sections: scene::sections(measured, rankings),
        versions: versions(measured),
        ..Study::default()
    };
    if !measured.complete {
        study.sections.insert(
            0,
            Section::new("incomplete", "Incomplete", [Block::text("The measurement was stopped by the user. What had been measured until then stands here; \
                     what is missing is not a result.")]),
        );
    }
    crate::render(study, made)
}

fn lead(measured: &WorkPrecision) -> String {
    let scene = &measured.scene;
    format!(
        "What accuracy costs: every engine, integrator and step on the scene {} over {} s, against a converged run. \
         All runs were made in one session on one machine.",
        scene.name, scene.solver.duration_s
    )
}

fn versions(measured: &WorkPrecision) -> Vec<(String, String)> {
    let engines = measured.series.iter();
    let engines = engines.map(|series| (series.engine.clone(), series.version.clone()));
    engines.collect()
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
            study.scene.solver.duration_s,
            if lead.at_least {
                " A bound stands where a series ends before this error."
            } else {
                ""
            }
        ),
    }
}

fn tiles(study: &WorkPrecision, lead_over: Option<(&Ranking, &Advantage)>) -> Vec<Tile> {
    let mut tiles = Vec::new();
    if let Some((ranking, lead)) = lead_over {
        for (label, cost, name) in [
            ("Native", lead.native_cpu_s, &lead.native),
            ("Fastest peer", lead.peer_cpu_s, &lead.peer),
        ] {
            let detail = format!("CPU time at {}: {name}", limit(ranking.error));
            tiles.push(Tile::new(label, figures::cpu(cost), detail));
        }
        let sign = figures::at_least(lead);
        tiles.push(Tile::new(
            "Ratio",
            format!("{sign}{}", significant(lead.ratio, 3)),
            "peer over native, same error, same session",
        ));
    }
    tiles.push(Tile::new(
        "Reference",
        relative(study.reference_errors[0].force_l2),
        format!(
            "distance of {} and {} over the whole run",
            study.reference.solution.method, study.reference.second.method
        ),
    ));
    let points = study.series.iter().flat_map(|series| &series.points);
    let costs = || points.clone().filter_map(|point| point.cost);
    let runs: usize = costs().map(|cost| cost.runs).sum();
    let spent: f64 = costs()
        .map(|cost| cost.cpu_median_s * cost.runs as f64)
        .sum();
    let spent = format!("about {} of CPU time in all", seconds(spent));
    tiles.push(Tile::new("Runs", runs.to_string(), spent));
    tiles
}
