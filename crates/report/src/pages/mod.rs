//! Results of studies for readers: `page` returns a self-contained HTML page, `text` the text for a terminal.
//!
//! ```text
//!  comparison::Outcome ─> comparison::page   a sweep's, a bench's, a baseline's, ... likewise
//!                      └> comparison::text
//! ```
//!
//! Pages and texts of each study are functions of its result, without input or output. Only the answers of [`explore`]
//! compute anything. Text contains escape sequences for styles ([`crate::terminal`]).
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

use crate::figure::shown;
use crate::format;
use crate::study::{self, Mark, Question, Study, Tile};
use pinwheel_scene::{Assumption, CheckedScene, Scene};
use pinwheel_studies::Provenance;
use pinwheel_timeseries::figure::Figure;

/// Renders a page with its origin: the command, versions beside those of the study, the machine.
fn render(mut study: Study, origin: &Provenance) -> String {
    study.command.clone_from(&origin.command);
    for own in std::mem::replace(&mut study.versions, origin.versions()) {
        if !study.versions.contains(&own) {
            study.versions.push(own);
        }
    }
    study.machine = origin.machine.rows();
    study::render(&study)
}

/// Returns the tile of the next step: the command `verb` for the last scene of the page's command, with its overrides.
fn next(origin: &Provenance, verb: &str, why: &str) -> Tile {
    let words = words(origin);
    let scenes = words
        .iter()
        .skip(2)
        .take_while(|word| !word.starts_with('-'));
    let scene = scenes.last().unwrap_or(&"SCENE");
    let sets = options(&words, &["--set"]);
    Tile::next(&format!("pinwheel {verb} {scene}{sets}"), why)
}

/// Splits the command of a page into words.
fn words(origin: &Provenance) -> Vec<&str> {
    let mut is_quoted = false;
    let words = origin.command.split(|c| {
        is_quoted ^= c == '\'';
        c == ' ' && !is_quoted
    });
    words.collect()
}

/// Returns the options of a command that have these names, with their values; solver settings are left out.
fn options(words: &[&str], names: &[&str]) -> String {
    let asked = |pair: &&[&str]| names.contains(&pair[0]) && !pair[1].starts_with("solver.");
    let pairs = words.windows(2).filter(asked);
    pairs
        .map(|pair| format!(" {} {}", pair[0], pair[1]))
        .collect()
}

/// Tile of the widest bounds of some figures: by contact law, fit and numerics.
fn sure<'a>(figures: impl IntoIterator<Item = &'a Figure>) -> Option<Tile> {
    let width = |one: &&Figure| {
        let value = one.value.filter(|value| *value != 0.0)?;
        let bands = one.bands().into_iter().flat_map(|(_, band)| band);
        let ends = bands.chain(one.uncertainty.map(|off| value + off));
        let widest = ends.map(|end| (end / value - 1.0).abs());
        widest.reduce(f64::max)
    };
    let known = figures
        .into_iter()
        .filter_map(|one| Some((width(&one)?, one)));
    let (width, widest) = known.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let mark = Mark::warn(widest.bands().is_empty());
    let why = format!("{}: {}", widest.def.label, shown(widest).1);
    let alone = if mark == Mark::Warn {
        "numerically "
    } else {
        ""
    };
    let answer = format!("{alone}to {}", format::relative(width));
    Some(Question::Sure.answered(mark, answer, why))
}

/// Name and description of a scene.
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
    let row = |a: Assumption| (DOUBT, format!("{} = {} is {}", a.key, a.value, a.reason));
    doubts.map(row).collect()
}
