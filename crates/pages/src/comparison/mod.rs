//! A comparison of engines on one scene.

mod text;

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Statement;
use pinwheel_report::{Fact, ReportInput};
use pinwheel_studies::Provenance;
use pinwheel_studies::comparison::Outcome;

pub use text::text;

use crate::{PageError, animation};

/// The page; `cancel` stops it while the motion is computed.
///
/// # Errors
/// Stopped, or the page cannot be made.
pub fn page(found: &Outcome, made: &Provenance, cancel: &AtomicBool) -> Result<String, PageError> {
    let facts = |list: &[Statement]| list.iter().map(|s| Fact::new(&s.what, &s.why)).collect();
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
        modelled: facts(&found.model.modelled),
        left_out: facts(&found.model.left_out),
        assumptions: found
            .assumptions
            .iter()
            .map(|a| Fact::new(format!("{} = {}", a.key, a.value), &a.reason))
            .collect(),
        versions,
        machine: made.machine.rows(),
        command: made.command.clone(),
        scene_toml: found.gearbox.scene.to_toml(),
        made: Some(made.date.clone()),
    })?)
}
