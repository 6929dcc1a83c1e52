//! Results of studies for readers: `page` gives a self-contained HTML page, `text` the text for a terminal.
//!
//! ```text
//!  comparison::Outcome ─> comparison::page   a sweep's, a bench's, a baseline's, ... likewise
//!                      └> comparison::text
//! ```
//!
//! One file or folder for each study, as functions of its result. They read, write and print nothing, and compute nothing
//! except for the answers of [`explore`]. Text contains escape sequences for styles ([`crate::terminal`]).
//!
//! ```
//! use pinwheel_report::terminal::plain;
//!
//! let text = plain(&pinwheel_report::pages::laws::text());
//! assert!(text.contains("hunt-crossley"), "what a scene's contact.law may be");
//! ```

mod animation;
mod band;
pub mod baseline;
pub mod bench;
mod colours;
pub mod comparison;
pub mod conformance;
pub mod design;
pub mod design_diff;
pub mod engines;
pub mod explain;
pub mod explore;
pub mod laws;
mod packed;
pub mod paper;
pub mod single;
pub mod stability;
pub mod sweep;
mod time_series;

use crate::study::{self, Study};
use pinwheel_scene::{Assumption, CheckedScene, Scene};
use pinwheel_studies::Provenance;

/// Renders a page with its origin: the command, versions beside those of the study, the machine.
fn render(mut study: Study, made: &Provenance) -> String {
    study.command.clone_from(&made.command);
    for own in std::mem::replace(&mut study.versions, made.versions()) {
        if !study.versions.contains(&own) {
            study.versions.push(own);
        }
    }
    study.machine = made.machine.rows();
    study::render(&study)
}

/// Returns name and description of a scene.
#[must_use]
pub fn title(scene: &Scene) -> String {
    if scene.description.is_empty() {
        scene.name.clone()
    } else {
        format!("{}: {}", scene.name, scene.description)
    }
}

/// Label of values that are doubtful, or have no effect.
const DOUBT: &str = "doubt";

/// Returns rows on doubtful values of a scene.
fn doubts(scene: &CheckedScene) -> Vec<(&'static str, String)> {
    let doubts = pinwheel_scene::doubts(scene).into_iter();
    let said = |a: Assumption| (DOUBT, format!("{} = {} is {}", a.key, a.value, a.reason));
    doubts.map(said).collect()
}
