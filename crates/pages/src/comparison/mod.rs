//! A comparison of engines on one scene.

mod answer;
mod text;
mod twins;

use std::sync::atomic::AtomicBool;

use pinwheel_engines::Cancelled;
use pinwheel_gearbox::Statement;
use pinwheel_report::comparison::study;
use pinwheel_report::format;
use pinwheel_report::study::{Block, Fact, Section, Study};
use pinwheel_studies::Provenance;
use pinwheel_studies::comparison::Outcome;
use pinwheel_timeseries::table::Table;

use answer::Answer;
pub use text::{details, text};

use crate::{animation, band};

/// The page; `cancel` stops it while the motion is computed.
///
/// # Errors
/// `cancel` was set.
pub fn page(found: &Outcome, made: &Provenance, cancel: &AtomicBool) -> Result<String, Cancelled> {
    let statements = |caption: &str, list: &[Statement]| {
        Table::of(caption, list)
            .text("", "What", |statement| &statement.what)
            .text("", "Why", |statement| &statement.why)
            .done()
    };
    let assumptions = Table::of("Assumptions", &found.assumptions)
        .text("", "What", |a| format!("{} = {}", a.key, a.value))
        .text("", "Why", |a| &a.reason)
        .done();
    let model = vec![
        statements("What was modelled", &found.model.modelled),
        statements("What was left out, and why", &found.model.left_out),
        assumptions,
    ];
    let participants = &found.participants;
    let motion = animation::of(&found.gearbox, cancel)?;
    let scene = found.gearbox.scene.to_toml();
    let versions = participants.iter();
    let versions = versions.map(|p| (p.name.clone(), p.version.clone()));
    let mut study = Study {
        versions: versions.collect(),
        made: Some(made.date.clone()),
        ..study(&found.comparison, participants, motion, model, scene)
    };
    let answer = Answer::new(found, format::relative);
    study.verdict = Some(answer.verdict());
    study.tiles = answer.tiles();
    study.top = vec![Block::Facts(answer.shown())];
    let under = |title: &str, facts: Vec<Fact>| {
        let heading = Block::Heading(title.to_owned());
        let facts = (!facts.is_empty()).then_some([heading, Block::Facts(facts)]);
        facts.into_iter().flatten()
    };
    let mut unchecked = answer.unchecked(answer::MOST);
    // Bookkeeping last: it may be cut off.
    unchecked.sort_by_key(|fact| fact.label == answer::UNRESOLVED);
    unchecked.splice(0..0, answer.next());
    let facts = under("Can I trust it?", answer.trust())
        .chain(under("What next, and what was not checked", unchecked));
    study.below.splice(0..0, facts);
    // Details stand below the first screen.
    let mut details = twins::blocks(found);
    details.extend(found.bands.iter().flat_map(band::blocks));
    if !details.is_empty() {
        let section = Section::new("models", "Models", details);
        let place = study.sections.len().min(1);
        study.sections.insert(place, section);
    }
    Ok(crate::render(study, made))
}
