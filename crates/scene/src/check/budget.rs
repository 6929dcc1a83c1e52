//! Check of a run's cost before anything is allocated.

use super::super::error::Fault;
use super::super::model::Scene;
use crate::channels::select;
use crate::layout::Layout;
use crate::number::{above, short};

/// Largest number of samples in memory.
const MOST_SAMPLES: f64 = 5e6;
/// Largest number of values in memory: 2e8 doubles are 1.6 GB.
const MOST_VALUES: f64 = 2e8;
/// Largest number of steps: at a microsecond each about three hours.
const MOST_STEPS: f64 = 1e10;
/// Largest number of disc-pin pairs: each stores its closest point and is visited in every step.
const MOST_PAIRS: usize = 20_000;

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let (gear, solver) = (&scene.gear, &scene.solver);

    let sleeves = gear.external_sleeves + gear.internal_sleeves;
    // The ranges are checked before: at most 64 discs and 2000 pins, no overflow.
    let (wheels, pairs) = (gear.wheels, gear.wheels * sleeves);
    if pairs > MOST_PAIRS {
        return Err(Fault::new(
            &[
                "gear.wheels",
                "gear.external_sleeves",
                "gear.internal_sleeves",
            ],
            format!(
                "makes {wheels} x {sleeves} = {pairs} pairs of disc and pin, more than memory and time are planned for"
            ),
            format!("keep discs x (ring + output pins) at or below {MOST_PAIRS}"),
        ));
    }

    let duration = solver.duration_s;
    for (key, length) in [
        ("solver.step_s", solver.step_s),
        ("solver.sample_s", solver.sample_s),
    ] {
        if length > duration {
            let [length, total] = [length, duration].map(short);
            return Err(Fault::new(
                &[key, "solver.duration_s"],
                format!("is {length} s, longer than the whole run of {total} s"),
                format!("give at most {total} s, or a longer solver.duration_s"),
            ));
        }
    }

    let steps = duration / solver.step_s;
    if steps > MOST_STEPS {
        let least = above(duration / MOST_STEPS);
        let [steps, most] = [steps, MOST_STEPS].map(short);
        return Err(Fault::new(
            &["solver.step_s", "solver.duration_s"],
            format!("makes {steps} steps of the run, more than {most}"),
            format!("give at least {least} s, or a shorter run"),
        ));
    }

    // Time, torques and angle beside the pins, and the selected channels.
    let channels = select(&scene.output.channels, Layout::of(gear))?;
    let columns = (sleeves + 4 + channels.len()) as f64;
    let most = MOST_SAMPLES.min(MOST_VALUES / columns);
    let samples = duration / solver.sample_s + 1.0;
    if samples > most {
        let fewer = match scene.output.channels.as_slice() {
            [] => "",
            _ => ", or ask for fewer output.channels",
        };
        let (samples, least) = (short(samples.floor()), above(duration / (most - 1.0)));
        return Err(Fault::new(
            &["solver.sample_s", "solver.duration_s"],
            format!(
                "makes {samples} samples of {columns} columns, more than memory is planned for"
            ),
            format!("give at least {least} s, or a shorter run{fewer}"),
        ));
    }
    Ok(())
}
