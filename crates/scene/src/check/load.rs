//! Check of changes of load and speed: values in range, times increasing, each ramp over before the next change.

use std::borrow::Cow;

use super::super::error::Fault;
use super::super::model::Scene;
use crate::load_profile::APART_S;
use crate::number::{below, short};

/// Largest number of changes: integration restarts at each.
const MOST: usize = 1000;

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let drive = &scene.drive;
    let loads = drive.load_changes.iter().map(|c| (c.time_s, c.ramp_s));
    let speeds = drive.speed_changes.iter().map(|c| (c.time_s, c.ramp_s));
    let first_ramp_s = drive.load_ramp_s;
    in_order(
        "drive.load_changes",
        first_ramp_s,
        &loads.collect::<Vec<_>>(),
    )?;
    in_order("drive.speed_changes", 0.0, &speeds.collect::<Vec<_>>())
}

/// Checks a list of changes by their times and ramps, s.
fn in_order(list: &'static str, first_ramp_s: f64, changes: &[(f64, f64)]) -> Result<(), Fault> {
    if changes.len() > MOST {
        return Err(Fault::new(
            &[list],
            format!("lists {} changes, more than {MOST}", changes.len()),
            "integration starts anew at each; let one ramp lead from one to the next over a longer time",
        ));
    }
    let fault = |number: usize, names: &[&str], what: String, remedy: String| {
        let keys = names
            .iter()
            .map(|name| Cow::Owned(format!("{list}[{number}].{name}")));
        let keys = keys.chain([Cow::Borrowed(list)]).collect();
        Err(Fault { keys, what, remedy })
    };
    for (number, &(_, ramp_s)) in changes.iter().enumerate() {
        if ramp_s > 0.0 && ramp_s < APART_S {
            let what = format!("is {} s, shorter than any step", short(ramp_s));
            let remedy = format!("give 0 for a change at once, or {APART_S:e} s and more");
            return fault(number, &["ramp_s"], what, remedy);
        }
    }
    if let Some(&(first_s, _)) = changes.first()
        && first_ramp_s > first_s
    {
        let [time, ramp] = [first_s, first_ramp_s].map(short);
        let what = format!(
            "is {time} s, within the ramp of drive.load_ramp_s = {ramp} s with which the load begins"
        );
        let remedy =
            format!("let the change come at {ramp} s or later, or the ramp be at most {time} s");
        return fault(0, &["time_s"], what, remedy);
    }
    for (number, pair) in changes.windows(2).enumerate() {
        let ((time_s, ramp_s), (next_s, _)) = (pair[0], pair[1]);
        let [from, ramp, until] = [time_s, ramp_s, next_s].map(short);
        if !(next_s - time_s >= APART_S) {
            let what = format!("is {until} s, not after the change before it at {from} s");
            let remedy = "list the changes in the order in which they come".to_owned();
            return fault(number + 1, &["time_s"], what, remedy);
        }
        // Sums of decimal numbers round: 0.2 + 0.1 is more than 0.3.
        if time_s + ramp_s > next_s + 0.5 * APART_S {
            let what = format!(
                "is {ramp} s, so that the change from {from} s on is not over when the next begins at {until} s"
            );
            let remedy = format!("give at most {} s", below(next_s - time_s));
            return fault(number, &["ramp_s", "time_s"], what, remedy);
        }
    }
    Ok(())
}
