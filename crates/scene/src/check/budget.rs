//! What a run would cost: refused before anything is allocated.

use super::super::error::Fault;
use super::super::model::Scene;
use super::output;
use crate::number::{above, short};

/// Samples kept in memory at most.
const MOST_SAMPLES: f64 = 5e6;
/// Values kept in memory at most: 2e8 doubles are 1.6 GB.
const MOST_VALUES: f64 = 2e8;
/// Steps at most: at a microsecond each about three hours.
const MOST_STEPS: f64 = 1e10;
/// Wheel-sleeve pairs at most: each keeps its closest point, and each is visited in every step.
const MOST_PAIRS: usize = 20_000;

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let (gear, solver) = (&scene.gear, &scene.solver);

    let sleeves = gear.external_sleeves + gear.internal_sleeves;
    // The ranges are checked before: at most 64 wheels and 2000 sleeves, no overflow.
    let pairs = gear.wheels * sleeves;
    if pairs > MOST_PAIRS {
        return Err(Fault::new(
            &[
                "gear.wheels",
                "gear.external_sleeves",
                "gear.internal_sleeves",
            ],
            format!(
                "makes {} x {sleeves} = {pairs} pairs of wheel and sleeve, more than memory and time are planned for",
                gear.wheels
            ),
            format!("keep wheels x (external + internal sleeves) at or below {MOST_PAIRS}"),
        ));
    }

    if solver.step_s > solver.duration_s {
        return Err(Fault::new(
            &["solver.step_s", "solver.duration_s"],
            format!(
                "is {} s, longer than the whole run of {} s",
                short(solver.step_s),
                short(solver.duration_s)
            ),
            "make the step smaller or solver.duration_s longer",
        ));
    }
    if solver.sample_s > solver.duration_s {
        return Err(Fault::new(
            &["solver.sample_s", "solver.duration_s"],
            format!(
                "is {} s, longer than the whole run of {} s",
                short(solver.sample_s),
                short(solver.duration_s)
            ),
            "sample more often or make solver.duration_s longer",
        ));
    }

    let steps = solver.duration_s / solver.step_s;
    if steps > MOST_STEPS {
        return Err(Fault::new(
            &["solver.step_s", "solver.duration_s"],
            format!(
                "makes {} steps of the run, more than {}",
                short(steps),
                short(MOST_STEPS)
            ),
            format!(
                "give at least {} s, or a shorter run",
                above(solver.duration_s / MOST_STEPS)
            ),
        ));
    }

    // Time, torques and angle beside the sleeves, and what is asked for.
    let columns = (sleeves + 4 + output::columns(scene)?) as f64;
    let most = MOST_SAMPLES.min(MOST_VALUES / columns);
    let samples = solver.duration_s / solver.sample_s + 1.0;
    if samples > most {
        return Err(Fault::new(
            &["solver.sample_s", "solver.duration_s"],
            format!(
                "makes {} samples of {columns} columns, more than memory is planned for",
                short(samples.floor())
            ),
            format!(
                "give at least {} s, or a shorter run{}",
                above(solver.duration_s / (most - 1.0)),
                if scene.output.channels.is_empty() {
                    ""
                } else {
                    ", or ask for fewer output.channels"
                }
            ),
        ));
    }
    Ok(())
}
