//! Page of a comparison of engines on one scene.

mod answer;
mod common;
mod figures;
mod pairs;
mod sections;
pub(super) mod stages;
mod text;
mod twins;
mod words;

use crate::figure::tile;
use crate::format;
use crate::study::{Block, Fact, Section, Study};
use pinwheel_gearbox::Statement;
use pinwheel_studies::Provenance;
use pinwheel_studies::comparison::Outcome;
use pinwheel_timeseries::table::Table;

use answer::Answer;
use common::Page;
pub use text::{details, text, verdict};

use crate::pages::{animation, band, time_series};

/// Returns the page.
pub fn page(outcome: &Outcome, origin: &Provenance) -> String {
    let (comparison, participants) = (&outcome.comparison, &outcome.participants);
    let page = Page::new(comparison);
    let answer = Answer::new(outcome, format::relative);
    let mut sections = Vec::new();
    if let Some(time_series) = time_series::block(comparison, participants, false) {
        sections.push(Section::new("courses", "Over time").with(time_series));
    }
    sections.extend(stages::section(outcome));
    // Details are below the first screen.
    let mut details = twins::blocks(outcome);
    details.extend(outcome.bands.iter().flat_map(band::blocks));
    if !details.is_empty() {
        sections.push(Section::new("models", "Models").with(details));
    }
    sections.extend(page.tracks());
    sections.extend(page.energy());
    sections.push(page.costs());
    let model = Section::new("model", "Model").with(model(outcome));
    sections.push(model.folded(""));
    sections.push(page.engines());
    let versions = participants.iter();
    let versions = versions.map(|p| (p.name.clone(), p.version.clone()));
    let scene = Block::Code(outcome.gearbox.scene.to_toml());
    let study = Study {
        title: comparison.context.scene.clone(),
        eyebrow: match comparison.engines.len() {
            1 => "Comparison of 1 engine on the scene".to_owned(),
            engines => format!("Comparison of {engines} engines on the scene"),
        },
        lead: comparison.context.description.clone(),
        verdict: Some(answer.verdict()),
        decision: answer.decision(origin),
        top: vec![answer.shown().into()],
        tiles_title: figures::best(comparison).map_or_else(String::new, |(engine, window)| {
            format!("{}, by {}", page.window(window), engine.name)
        }),
        tiles: figures::figures(outcome).iter().map(tile).collect(),
        below: below(&answer),
        aside: animation::aside(outcome.motion.as_ref()),
        sections,
        appendix: vec![Block::folded("The scene, every key", scene)],
        versions: versions.collect(),
        date: Some(origin.date.clone()),
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

/// Returns facts below the figures, and remarks.
fn below(answer: &Answer<'_>) -> Vec<Block> {
    let under = |title: &str, facts: Vec<Fact>| {
        let facts = (!facts.is_empty()).then(|| [Block::heading(title), facts.into()]);
        facts.into_iter().flatten()
    };
    let mut unchecked = answer.unchecked(answer::MOST);
    // Unresolved verdicts last, because the end may be cut.
    unchecked.sort_by_key(|fact| fact.label == answer::UNRESOLVED);
    // A next step that is a command is a tile.
    if !answer.open().is_empty() {
        unchecked.splice(0..0, answer.next());
    }
    let comparison = answer.comparison();
    let divergence = comparison.context.divergence.iter();
    let remarks = words::of_windows(comparison).chain(divergence.map(|d| d.told.clone()));
    let mut trust = answer.trust();
    trust.retain(|fact| fact.label != answer::EQUATIONS);
    under("Can I trust it?", trust)
        .chain(under("What next, and what was not checked", unchecked))
        .chain(remarks.map(Block::Text))
        .collect()
}

/// Returns tables of the model: modelled parts, omitted parts and assumptions.
fn model(outcome: &Outcome) -> Vec<Block> {
    let statements = |caption: &str, list: &[Statement]| {
        Table::of(caption, list)
            .text("", "What", |statement| &statement.what)
            .text("", "Why", |statement| &statement.why)
            .done()
    };
    let assumptions = Table::of("Assumptions", &outcome.assumptions)
        .text("", "What", |a| format!("{} = {}", a.key, a.value))
        .text("", "Why", |a| &a.reason)
        .done();
    let tables = [
        statements("What was modelled", &outcome.model.modelled),
        statements("What was left out, and why", &outcome.model.left_out),
        assumptions,
    ];
    let tables = tables.into_iter().filter(|table| !table.is_empty());
    tables.map(Block::Table).collect()
}
