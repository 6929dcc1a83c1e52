//! Fig. 9: 600 against 4000 points on a disc.

use super::figure::{Measured, numbers};
use super::read::{DRAWN, EXTERNAL, INTERNAL, STEADY, all, off, part, roughness};
use super::runs::{Cases, Model, Runs};
use crate::StudyError;

/// Samples (0.1 ms each) to both sides of the running mean: slower than contact, faster than a pin's load cycle.
const HALF: usize = 10;

pub(super) fn figure(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let exact = runs.get(Model::Ours, |_| {})?;
    let models = [Model::ROUGH, Model::FINE, Model::Ours];
    let run = |model: Model| Ok((model.words(), runs.get(model, |_| {})?));
    let cases = models.into_iter().map(run);
    let cases = Cases(cases.collect::<Result<_, StudyError>>()?);
    let errors = |what: &str, group: &str| {
        let exact = all(&exact.time_series, group, STEADY);
        let off = cases.each(|time_series| off(&all(time_series, group, STEADY), &exact));
        numbers(what, &["600_points", "4000_points"], &off, "")
    };
    let sleeves = [INTERNAL, EXTERNAL].map(|group| format!("{group}_0"));
    let rough = cases.each(|time_series| roughness(part(time_series, &sleeves[0], STEADY), HALF));
    let names = ["600_points", "4000_points", "exact"];
    let internal = ["fig-09a", "Force on output pin 0", "Force (N)"];
    let external = ["fig-09b", "Force on ring pin 0", "Force (N)"];
    let mut found = errors("internal_error", INTERNAL);
    found.extend(errors("external_error", EXTERNAL));
    found.extend(numbers("internal_oscillation", &names, &rough, "N"));
    let plots = vec![
        cases.plot(internal, &sleeves[0], DRAWN),
        cases.plot(external, &sleeves[1], DRAWN),
    ];
    Ok(vec![Measured::new("fig-09", found, plots)])
}
