//! A comparison of engines on one scene.

mod text;

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Statement;
use pinwheel_report::ReportInput;
use pinwheel_studies::Provenance;
use pinwheel_studies::comparison::Outcome;
use pinwheel_timeseries::table::Table;

pub use text::text;

use crate::{PageError, animation};

/// The page; `cancel` stops it while the motion is computed.
///
/// # Errors
/// Stopped, or the page cannot be made.
pub fn page(found: &Outcome, made: &Provenance, cancel: &AtomicBool) -> Result<String, PageError> {
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
    let mut versions = made.versions();
    versions.extend(
        found
            .participants
            .iter()
            .map(|p| (p.name.clone(), p.version.clone())),
    );
    Ok(pinwheel_report::render(&ReportInput {
        comparison: &found.comparison,
        participants: &found.participants,
        animation: animation::of(&found.gearbox, cancel)?,
        model: vec![
            statements("What was modelled", &found.model.modelled),
            statements("What was left out, and why", &found.model.left_out),
            assumptions,
        ],
        versions,
        machine: made.machine.rows(),
        command: made.command.clone(),
        scene_toml: found.gearbox.scene.to_toml(),
        made: Some(made.date.clone()),
    })?)
}
