//! `run.json`: what was run, how it ended, what it cost, on which machine.

use std::fs;
use std::path::Path;

use pinwheel_courses::Courses;
use pinwheel_engines::{Engine, RunStats};
use pinwheel_scene::Scene;
use pinwheel_studies::resolution::Resolution;
use serde::Serialize;

use crate::failure::Failure;
use crate::machine::Machine;

/// Everything about one run but its courses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct RunRecord {
    engine: String,
    version: String,
    track: &'static str,
    #[serde(flatten)]
    ending: Ending,
    /// File with the samples, beside this one.
    courses: &'static str,
    samples: usize,
    #[serde(flatten)]
    stats: RunStats,
    /// What the same run at twice the step shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    resolution: Option<Resolution>,
    scene: Scene,
    pinwheel_version: &'static str,
    machine: Machine,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "lowercase")]
pub(crate) enum Ending {
    /// Complete courses.
    Finished,
    /// The numbers ran away.
    Diverged {
        /// When, s.
        diverged_at_s: f64,
        /// Which quantity.
        diverged_quantity: String,
    },
}

/// Writes `run.json` and `courses.csv`, or `courses.partial.csv` if the run did not finish.
pub(crate) fn write(
    folder: &Path,
    engine: &dyn Engine,
    scene: &Scene,
    ending: Ending,
    courses: &Courses,
    stats: &RunStats,
) -> Result<(), Failure> {
    write_checked(folder, engine, scene, ending, courses, stats, None)
}

/// The same, with what a coarser run shows.
pub(crate) fn write_checked(
    folder: &Path,
    engine: &dyn Engine,
    scene: &Scene,
    ending: Ending,
    courses: &Courses,
    stats: &RunStats,
    resolution: Option<&Resolution>,
) -> Result<(), Failure> {
    let file = match ending {
        Ending::Finished => "courses.csv",
        Ending::Diverged { .. } => "courses.partial.csv",
    };
    courses
        .save_csv(&folder.join(file))
        .map_err(|error| Failure::input(format!("{error}; choose another --out")))?;
    let record = RunRecord {
        engine: engine.name().to_owned(),
        version: engine.version(),
        track: engine.track().as_str(),
        ending,
        courses: file,
        samples: courses.len(),
        stats: stats.clone(),
        resolution: resolution.cloned(),
        scene: scene.clone(),
        pinwheel_version: env!("CARGO_PKG_VERSION"),
        machine: Machine::here(),
    };
    write_json(&folder.join("run.json"), &record)
}

/// Writes pretty JSON with a final newline.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut text =
        serde_json::to_string_pretty(value).map_err(|error| Failure::unwritable(path, &error))?;
    text.push('\n');
    write_text(path, &text)
}

/// Writes a file of the output.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    fs::write(path, text).map_err(|error| Failure::unwritable(path, &error))
}
