//! Stages in which an engine differs: a sentence for each, with details.

use crate::format::joined;
use crate::study::{Axis, Block, Chart, Fact, Section, Series, Style};
use pinwheel_studies::comparison::Outcome;
use pinwheel_studies::stages::{Cause, Judged, Located, Over, Picture, Stage};
use pinwheel_timeseries::table::{Mark, Table};

use super::words;

/// Returns a line for every judged engine.
pub(super) fn facts(outcome: &Outcome) -> impl Iterator<Item = Fact> {
    outcome.stages.iter().map(|located| {
        let mark = match located.first() {
            Some(_) => Mark::Bad,
            None => Mark::Warn,
        };
        let who = words::short(&located.run);
        Fact::new("stage", mark, format!("{} ({who})", located.words()))
    })
}

/// True if the first deviating stage of the engine was located.
pub(super) fn names(outcome: &Outcome, engine: &str) -> bool {
    let mut stages = outcome.stages.iter();
    stages.any(|located| located.run == engine && located.first().is_some())
}

/// Returns the stages of every judged engine, with its residuals.
pub(super) fn section(outcome: &Outcome) -> Option<Section> {
    let blocks: Vec<Block> = outcome.stages.iter().flat_map(blocks).collect();
    (!blocks.is_empty()).then(|| Section::new("stages", "Stages").with(blocks))
}

/// Returns a table of the stages, and pictures of those that are off.
pub(in crate::pages) fn blocks(located: &Located) -> Vec<Block> {
    let share = |judged: &Judged, value: f64| match judged.residual {
        Some(_) if value == 0.0 => "0".to_owned(),
        Some(_) => format!("{value:.1e}"),
        None => String::new(),
    };
    // Geometry shows in later stages alone.
    let of_cause = located.cause.as_ref().map_or(Vec::new(), Cause::stages);
    let word = |judged: &Judged| match judged.residual {
        _ if of_cause.contains(&judged.stage) => "likely cause",
        None => "not judged",
        Some(_) if judged.is_off() => "off",
        Some(_) => "passes",
    };
    let cause = match (&located.cause, located.first()) {
        (None, Some(_)) => located.off(),
        _ => located.in_full(),
    };
    let title = format!("{}: {cause}", words::short(&located.run));
    let table = Table::of(&title, &located.stages)
        .text("", "Stage", |judged| judged.stage.name())
        .text("", "Verdict", |judged| word(judged))
        .text("", "Residual", |judged| {
            share(judged, judged.residual.unwrap_or(0.0))
        })
        .text("", "Bound", |judged| share(judged, judged.bound))
        .text("", "Where", |judged| &judged.note)
        .done();
    let charts = located.pictures.iter().map(|of| chart(located, of));
    let charts = Some(charts.collect::<Vec<_>>()).filter(|charts| !charts.is_empty());
    let blocks = [Block::Table(table)].into_iter();
    blocks.chain(charts.map(Block::Charts)).collect()
}

/// Residuals below are roundings.
const ROUNDING: f64 = 1e-12;

/// Returns the chart of a stage's residual over time, pins or lobe, with the bound above which the stage deviates.
fn chart(located: &Located, picture: &Picture) -> Chart {
    let (stage, names) = (picture.stage, picture.names.iter().enumerate());
    let (x, over, style) = match picture.over {
        Over::Time => ("Time (s)", "Over time", Style::Both),
        Over::Pins => ("Pin: ring pins, then output pins", "By pin", Style::Points),
        Over::Lobe => (
            "Place: 0 and 1 tips of lobes, 0.5 the pit",
            "By place on a lobe",
            Style::Both,
        ),
        Over::Coordinates => ("Coordinate", "By coordinate", Style::Points),
    };
    let share = match stage {
        Stage::Start => "state",
        Stage::ContactSearch => "largest contact",
        Stage::Law => "largest force",
        Stage::Assembly | Stage::Driver => "largest torque",
        Stage::Equations | Stage::Integration => "load's effect",
    };
    // Roundings would stretch a logarithmic axis.
    let drawn = |value: &f64| match picture.over {
        Over::Time if *value < ROUNDING => f64::NAN,
        _ => *value,
    };
    let curve = |(name, values): &(String, Vec<f64>)| {
        let values: Vec<f64> = values.iter().map(drawn).collect();
        Series {
            tags: picture.names.clone(),
            ..Series::line(name, picture.x.clone(), values).styled(style)
        }
    };
    let mut series: Vec<Series> = picture.curves.iter().map(curve).collect();
    let mut y = Axis::linear(format!("Residual, share of the {share}"));
    if let (Over::Time, [first, .., last]) = (picture.over, &picture.x[..]) {
        y.log = true;
        let is_of = |judged: &&Judged| judged.stage == stage && judged.bound > 0.0;
        let bounds = located.stages.iter().filter(is_of);
        let bound = |judged: &Judged| Series::line("off above", [*first, *last], [judged.bound; 2]);
        series.extend(bounds.map(|judged| bound(judged).styled(Style::Dashed)));
    }
    let title = format!("{over}: {}", stage.name());
    Chart {
        note: joined(", ", names.map(|(k, name)| format!("{k} {name}"))),
        ..Chart::new(title, Axis::linear(x), y, series)
    }
}
