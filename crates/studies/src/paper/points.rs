//! Fig. 9: 600 against 4000 points on a disc.

use super::figure::Measured;
use super::read::{DRAWN, EXTERNAL, INTERNAL, STEADY, all, off, part, roughness};
use super::runs::{Model, Runs};
use crate::StudyError;

/// Samples (0.1 ms each) on both sides of the running mean: slower than contact, faster than a pin's load cycle.
const HALF: usize = 10;

pub(super) fn figure(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let (rough, fine, ours) = (Model::ROUGH, Model::FINE, Model::Ours);
    let models = [
        ("600_points", rough),
        ("4000_points", fine),
        ("exact", ours),
    ];
    let mut cases = runs.models(models, |_| {})?;
    let rough = |run: &_| roughness(part(run, INTERNAL, STEADY), HALF);
    let oscillation = cases.numbers("internal_oscillation", "N", rough);
    let plots = vec![
        cases.plot("fig-09a", INTERNAL, DRAWN),
        cases.plot("fig-09b", EXTERNAL, DRAWN),
    ];
    // Reference for the other two.
    let exact = cases.0.split_off(2);
    let errors = |what: &str, group: &str| {
        let exact = all(&exact[0].2.time_series, group, STEADY);
        cases.numbers(what, "", |run| off(&all(run, group, STEADY), &exact))
    };
    let mut numbers = errors("internal_error", INTERNAL);
    numbers.extend(errors("external_error", EXTERNAL));
    numbers.extend(oscillation);
    Ok(vec![Measured::new("fig-09", numbers, plots)])
}
