//! Stages in which an engine differs: a sentence for each, with details.

use crate::study::{Axis, Block, Chart, Fact, Section, Series, Style};
use pinwheel_studies::comparison::Outcome;
use pinwheel_studies::stages::{Judged, Located};
use pinwheel_timeseries::table::{Mark, Table};

use super::words;

/// Returns a line for every judged engine.
pub(super) fn facts(found: &Outcome) -> impl Iterator<Item = Fact> {
    found.stages.iter().map(|located| {
        let mark = match located.first() {
            Some(_) => Mark::Bad,
            None => Mark::Warn,
        };
        let who = words::short(&located.run);
        Fact::new("stage", mark, format!("{} ({who})", located.words()))
    })
}

/// True if a stage of that engine is named.
pub(super) fn names(found: &Outcome, engine: &str) -> bool {
    let mut stages = found.stages.iter();
    stages.any(|located| located.run == engine && located.first().is_some())
}

/// Returns the stages of every judged engine, with its residuals.
pub(super) fn section(found: &Outcome) -> Option<Section> {
    let blocks: Vec<Block> = found.stages.iter().flat_map(blocks).collect();
    (!blocks.is_empty()).then(|| Section::new("stages", "Stages").with(blocks))
}

/// Returns a table of the stages, and residuals over time, pins and the profile.
pub(in crate::pages) fn blocks(located: &Located) -> Vec<Block> {
    let share = |judged: &Judged, value: f64| match judged.residual {
        Some(_) => format!("{value:.1e}"),
        None => String::new(),
    };
    let word = |judged: &Judged| match judged.residual {
        None => "not told",
        Some(_) if judged.is_off() => "off",
        Some(_) => "passes",
    };
    let said = match (&located.cause, located.first()) {
        (None, Some(_)) => located.off(),
        _ => located.in_full(),
    };
    let title = format!("{}: {said}", words::short(&located.run));
    let table = Table::of(&title, &located.stages)
        .text("", "Stage", |judged| judged.stage.name())
        .text("", "Verdict", |judged| word(judged))
        .text("", "Residual", |judged| {
            share(judged, judged.residual.unwrap_or(0.0))
        })
        .text("", "Bound", |judged| share(judged, judged.bound))
        .text("", "Where", |judged| &judged.note)
        .done();
    let depth = &located.depth;
    if depth.time_s.is_empty() {
        return vec![Block::Table(table)];
    }
    let residual = || Axis::linear("Residual, share of the largest force");
    let numbers = |count: usize| -> Vec<f64> { (0..count).map(|k| k as f64).collect() };
    let mut over_time = vec![Series::line(
        "forces",
        depth.time_s.clone(),
        depth.force.clone(),
    )];
    if depth.motion.len() == depth.time_s.len() {
        let motion = Series::line("motion", depth.time_s.clone(), depth.motion.clone());
        over_time.push(motion);
    }
    let places: Vec<f64> = numbers(depth.profile.len())
        .iter()
        .map(|place| (place + 0.5) / depth.profile.len() as f64)
        .collect();
    let pins = Series::line("pins", numbers(depth.pins.len()), depth.pins.clone());
    let profile = Series::line("ring pins", places, depth.profile.clone());
    let charts = vec![
        Chart::new(
            "At the run's own states",
            Axis::linear("Time (s)"),
            Axis::log("Residual"),
            over_time,
        ),
        Chart::new(
            "By pin",
            Axis::linear("Pin: ring pins, then output pins"),
            residual(),
            vec![pins.styled(Style::Points)],
        ),
        Chart {
            note: "0 and 1 are the tips of lobes, 0.5 is the pit between them.".to_owned(),
            ..Chart::new(
                "By place on a lobe",
                Axis::linear("Place, share of a lobe"),
                residual(),
                vec![profile],
            )
        },
    ];
    vec![Block::Table(table), Block::Charts(charts)]
}
