//! Judgement of an engine's run with states, and of a second run with a smaller step.

use std::cell::Cell;

use pinwheel_engines::{AccuracySetting, Cancelled, Control, Engine};
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_timeseries::TimeSeries;

use super::judged::{ORDER_MARGIN, Stage};
use super::kept::of_record;
use super::locate::{Located, Runs, locate};
use super::states;

/// Number of samples of a judged run, of those after the departure, and of the run that measures an unknown cost.
const SAMPLES: f64 = 100.0;
const AFTER: f64 = 20.0;
const SHORTEST: f64 = 1500.0;
/// Evaluations of the shortest measuring run: without a search for the cause, with it, and with it under friction. They take
/// some hundredths to tenths of a second.
const LEAST: [u64; 3] = [10_000, 50_000, 150_000];
/// Factor on the step, or on the tolerance with the least factor on the error.
const STEP: f64 = 4.0;
const TOLERANCE: [f64; 2] = [100.0, 4.0];
/// Largest number of refinements while the motion is off and unexplained.
const LEVELS: i32 = 2;
/// Cost of a run and of one with a smaller step, and the same again for judging both.
const COST: f64 = 2.0 * (1.0 + STEP);
/// Share of the remaining evaluations that a run with a smaller step may use, and the least number of its samples.
const REST: f64 = 0.6;
const FEWEST: usize = 10;

/// Runs a scene on an engine until `until_s` and judges its stages. Samples resolve the vibration. The judgement may cost as
/// much as the complete run: `evaluations` of forces, if known. Returns `None` if the engine does not run or the scene has no
/// reduced form.
///
/// # Errors
/// A stop.
pub fn of_engine(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    until_s: f64,
    evaluations: Option<u64>,
    control: &Control<'_>,
) -> Result<Option<Located>, Cancelled> {
    let Some(states) = states::Columns::native(gearbox) else {
        return Ok(None);
    };
    let rad_s = Frequencies::of(&gearbox.scene).contact_rad_s;
    let solver = &gearbox.scene.solver;
    let steps = (rad_s * solver.step_s).recip().floor().max(1.0);
    let sample_s = solver.sample_s.min(steps * solver.step_s);
    let whole_s = match evaluations {
        Some(all) => solver.duration_s * (LEAST[0] as f64 / all as f64).max(1.0),
        None => solver.duration_s.max(SHORTEST * sample_s),
    };
    let asked_s = until_s + AFTER * sample_s;
    let long_s = asked_s.max(SAMPLES * sample_s).min(whole_s / COST);
    let short = gearbox.with_channels(states.channels()).map(|gearbox| {
        gearbox.with_solver(|solver| {
            solver.sample_s = sample_s;
            solver.duration_s = solver.duration_s.min(long_s);
        })
    });
    let Ok(Ok(short)) = short else {
        return Ok(None);
    };
    // Evaluations used so far.
    let taken = Cell::new(0);
    let run = |gearbox: &Gearbox| -> Result<Option<(TimeSeries, u64)>, Cancelled> {
        let run = engine.run_compiled(gearbox, control)?;
        let solver = &gearbox.scene.solver;
        let stated = (solver.duration_s / solver.step_s) as u64;
        let counts = [run.stats.rhs_calls, run.stats.steps, stated];
        let count = counts.into_iter().find(|count| *count > 0).unwrap_or(1);
        taken.set(taken.get() + count);
        // The part of a run before it diverges may show the cause.
        let is_enough = run.ending.is_finished() || run.time_series.len() > FEWEST;
        Ok(is_enough.then_some((run.time_series, count)))
    };
    let Some((mut own, mut count)) = run(&short)? else {
        return Ok(None);
    };
    let limit = match evaluations {
        Some(all) => all.max(LEAST[0]),
        None => (count as f64 * whole_s / short.scene.solver.duration_s) as u64,
    };
    let search = limit.max(LEAST[1 + usize::from(gearbox.has_friction())]);
    // `kept`: evaluations that the search for a cause must leave.
    let judge = |run: &TimeSeries, finer: Option<(&TimeSeries, f64)>, kept: u64| {
        let name = engine.name();
        // Without states, only the columns can show a cause.
        let left = [limit, search - kept].map(|most| most.saturating_sub(taken.get()));
        let by_columns = || of_record(gearbox, name, run, left[1] + kept);
        let is_blind = !states.missing(run).is_empty();
        let located = is_blind.then(by_columns).flatten();
        let runs = Runs {
            name,
            run,
            finer,
            evaluations: left,
        };
        let mut located = located.or_else(|| locate(gearbox, runs))?;
        taken.set(taken.get() + located.evaluations[0]);
        located.evaluations = [taken.get(), limit];
        if located.first().is_none() && long_s < asked_s {
            located.left_out = Some(format!(
                "it departs at t = {until_s:.3e} s, and the cost of a run reaches to {long_s:.3e} s"
            ));
        }
        Some(located)
    };
    let ends = own.time_s().last() >= Some(&(short.scene.solver.duration_s - 0.5 * sample_s));
    let Some(refinement) = engine.info().refinement.filter(|_| ends) else {
        return Ok(judge(&own, None, 0));
    };
    let (by, falls) = match refinement.knob {
        AccuracySetting::Step => {
            let lost = ORDER_MARGIN[usize::from(gearbox.has_friction())];
            (STEP, STEP.powf(refinement.order.min(2.0) - lost))
        }
        AccuracySetting::Tolerance => (TOLERANCE[0], TOLERANCE[1]),
    };
    let mut located: Option<Located> = None;
    let mut cost = STEP * count as f64;
    for level in 1..=LEVELS {
        // A run with a smaller step may have to end earlier.
        let most = if level > 1 { search } else { limit };
        let share = (REST * most.saturating_sub(taken.get()) as f64 / cost).min(1.0);
        let last = (share * (own.len() - 1) as f64) as usize;
        if let Some(open) = located.take_if(|_| last < FEWEST) {
            return Ok(Some(open.unconfirmed()));
        }
        let last = last.clamp(FEWEST.min(own.len() - 1), own.len() - 1);
        own = own.select(&(0..=last).collect::<Vec<_>>());
        let until = own.time_s()[last];
        let fine = short.with_solver(|solver| {
            solver.duration_s = until;
            match refinement.knob {
                AccuracySetting::Step => solver.step_s /= by.powi(level),
                AccuracySetting::Tolerance => solver.tolerance /= by.powi(level),
            }
        });
        let finer = fine.ok().map(|fine| run(&fine)).transpose()?.flatten();
        let finer = finer.filter(|(finer, _)| finer.len() == own.len());
        let Some((finer, more)) = finer else {
            return Ok(located.or_else(|| judge(&own, None, 0)));
        };
        cost = (more as f64).powi(2) / (count as f64 * share);
        // The search leaves evaluations to confirm that the motion is off.
        let kept = if level < LEVELS { search / 8 } else { 0 };
        located = judge(&own, Some((&finer, falls)), kept);
        // Steps that are far too long show no order.
        let is_open =
            |place: &Located| place.cause.is_none() && place.first() >= Some(Stage::Equations);
        if !located.as_ref().is_some_and(is_open) {
            break;
        }
        (own, count) = (finer, more);
    }
    Ok(located)
}
