//! The changes of the load: each value in its range, in order of time, each ramp over before the next change.

use std::borrow::Cow;

use super::super::error::Fault;
use super::super::model::Scene;
use crate::load_profile::APART_S;
use crate::number::{below, short};

const KEY: &str = "drive.load_changes";

/// The key of a value of change `number`, counted from 0.
fn key(number: usize, name: &str) -> String {
    format!("{KEY}[{number}].{name}")
}

/// Changes at most: integration starts anew at each.
const MOST: usize = 1000;

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let drive = &scene.drive;
    let changes = &drive.load_changes;
    if changes.len() > MOST {
        return Err(Fault::new(
            &[KEY],
            format!("lists {} changes, more than {MOST}", changes.len()),
            "integration starts anew at each; let the load ramp from one to the next over a longer time",
        ));
    }
    let fault = |number: usize, names: &[&str], what: String, remedy: String| {
        let keys = names.iter().map(|name| Cow::Owned(key(number, name)));
        let keys = keys.chain([Cow::Borrowed(KEY)]).collect();
        Err(Fault { keys, what, remedy })
    };
    for (number, change) in changes.iter().enumerate() {
        if change.ramp_s > 0.0 && change.ramp_s < APART_S {
            let what = format!("is {} s, shorter than any step", short(change.ramp_s));
            let remedy = format!("give 0 for a change at once, or {APART_S:e} s and more");
            return fault(number, &["ramp_s"], what, remedy);
        }
    }
    if let Some(first) = changes.first()
        && drive.load_ramp_s > first.time_s
    {
        let [time, ramp] = [first.time_s, drive.load_ramp_s].map(short);
        let what = format!(
            "is {time} s, within the ramp of drive.load_ramp_s = {ramp} s with which the load begins"
        );
        let remedy = "let the change come later or the ramp be shorter".to_owned();
        return fault(0, &["time_s"], what, remedy);
    }
    for (number, pair) in changes.windows(2).enumerate() {
        let (change, next) = (pair[0], pair[1]);
        let [from, ramp, until] = [change.time_s, change.ramp_s, next.time_s].map(short);
        if !(next.time_s - change.time_s >= APART_S) {
            let what = format!("is {until} s, not after the change before it at {from} s");
            let remedy = "list the changes in the order in which they come".to_owned();
            return fault(number + 1, &["time_s"], what, remedy);
        }
        // Sums of decimal numbers round: 0.2 + 0.1 is more than 0.3.
        if change.time_s + change.ramp_s > next.time_s + 0.5 * APART_S {
            let what = format!(
                "is {ramp} s, so that the change from {from} s on is not over when the next begins at {until} s"
            );
            let remedy = format!("give at most {} s", below(next.time_s - change.time_s));
            return fault(number, &["ramp_s", "time_s"], what, remedy);
        }
    }
    Ok(())
}
