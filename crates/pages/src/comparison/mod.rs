//! A comparison of engines on one scene.

mod text;
mod twins;

use std::sync::atomic::AtomicBool;

use pinwheel_engines::Cancelled;
use pinwheel_gearbox::Statement;
use pinwheel_report::comparison::study;
use pinwheel_report::study::Study;
use pinwheel_studies::Provenance;
use pinwheel_studies::comparison::Outcome;
use pinwheel_timeseries::table::Table;

pub use text::text;

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
    if let Some(bands) = &found.bands {
        study.below.splice(0..0, band::blocks(bands));
    }
    if let Some(verdict) = twins::verdict(found) {
        study.verdict = Some(verdict);
    }
    study.below.splice(0..0, twins::blocks(found));
    Ok(crate::render(study, made))
}
