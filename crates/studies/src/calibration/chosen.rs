//! The gears and engines of a calibration, as they are asked for.

use std::ops::Range;

use pinwheel_scene::{CheckedScene, Override, Scene};

use super::gears;
use crate::StudyError;
use crate::choice;

/// Presets, each with its duration, s.
///
/// # Errors
/// There is no such preset.
pub fn presets(named: &[(&str, f64)]) -> Result<Vec<CheckedScene>, StudyError> {
    let load = |&(name, duration_s): &(&str, f64)| {
        let duration = Override::new("solver.duration_s", duration_s.to_string());
        Ok(Scene::load(name, &[duration])?)
    };
    named.iter().map(load).collect()
}

/// The random gears of some seeds.
///
/// # Errors
/// A seed gives no gear.
pub fn random(seeds: Range<u64>) -> Result<Vec<CheckedScene>, StudyError> {
    let gear = |seed| {
        let none = || StudyError::Input(format!("seed {seed} gives no gear; take others"));
        let gear = gears::gear(seed).ok_or_else(none)?.check();
        gear.map_err(|fault| StudyError::Input(fault.to_string()))
    };
    seeds.map(gear).collect()
}

/// The engines asked for; if none are, those of this build.
///
/// # Errors
/// An engine that is not there, or has no refinement of its own to be held against.
pub fn engines(asked: &[String]) -> Result<Vec<String>, StudyError> {
    if asked.is_empty() {
        let mut listed = choice::listed();
        listed.retain(|engine| super::engines().any(|own| own == engine.name));
        return Ok(listed.into_iter().map(|engine| engine.name).collect());
    }
    for name in asked {
        if !super::engines().any(|own| own == name) {
            return Err(StudyError::Input(format!(
                "`{name}` has no refinement of its own to be held against; take some of {}",
                super::engines().collect::<Vec<_>>().join(", ")
            )));
        }
        choice::find(name, &Scene::paper())?;
    }
    Ok(asked.to_vec())
}
