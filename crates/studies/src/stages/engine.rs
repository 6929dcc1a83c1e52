//! An engine's run with its states, and one with a smaller step.

use pinwheel_engines::{AccuracySetting, Cancelled, Control, Engine};
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_timeseries::TimeSeries;

use super::judged::{ORDER_MARGIN, Stage};
use super::kept::of_record;
use super::locate::{Located, Runs, locate};
use super::{model, states};

/// Samples that a run to be judged has at least.
const LEAST: f64 = 100.0;
/// Factor by which step or tolerance is made smaller, and how far the error of a run by tolerance falls at least.
const STEP: f64 = 4.0;
const TOLERANCE: [f64; 2] = [100.0, 4.0];
/// Times that it is made smaller while the motion is off and nothing explains it.
const LEVELS: i32 = 2;

/// Runs a scene on an engine, until `until_s` at least and with samples that its vibration shows, and judges its stages. `None`:
/// it does not run, or the scene has no reduced form.
///
/// # Errors
/// A stop.
pub fn of_engine(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    until_s: f64,
    control: &Control<'_>,
) -> Result<Option<Located>, Cancelled> {
    let Some(native) = model::Model::new(gearbox, Vec::new()) else {
        return Ok(None);
    };
    let states = states::Columns::of(gearbox, native.free());
    let rad_s = Frequencies::of(&gearbox.scene).contact_rad_s;
    let Ok(short) = gearbox.with_channels(states.channels()) else {
        return Ok(None);
    };
    let short = short.with_solver(|solver| {
        let steps = (rad_s * solver.step_s).recip().floor().max(1.0);
        solver.sample_s = solver.sample_s.min(steps * solver.step_s);
        let long = (LEAST * solver.sample_s).max(until_s + 0.2 * LEAST * solver.sample_s);
        solver.duration_s = solver.duration_s.min(long);
    });
    let Ok(short) = short else { return Ok(None) };
    let run = |gearbox: &Gearbox| -> Result<Option<TimeSeries>, Cancelled> {
        let run = engine.run_compiled(gearbox, control)?;
        Ok(run.ending.is_finished().then_some(run.time_series))
    };
    let Some(mut own) = run(&short)? else {
        return Ok(None);
    };
    let judge = |run: &TimeSeries, finer: Option<(&TimeSeries, f64)>| {
        let name = engine.name();
        // Without states the columns alone may show a cause.
        let by_columns = || of_record(gearbox, name, run);
        let is_blind = !states.missing(run).is_empty();
        let found = is_blind.then(by_columns).flatten();
        found.or_else(|| locate(gearbox, Runs { name, run, finer }))
    };
    let Some(refinement) = engine.info().refinement else {
        return Ok(judge(&own, None));
    };
    let (by, falls) = match refinement.knob {
        AccuracySetting::Step => {
            let lost = ORDER_MARGIN[usize::from(gearbox.has_friction())];
            (STEP, STEP.powf(refinement.order.min(2.0) - lost))
        }
        AccuracySetting::Tolerance => (TOLERANCE[0], TOLERANCE[1]),
    };
    let mut located = None;
    for level in 1..=LEVELS {
        let fine = short.with_solver(|solver| match refinement.knob {
            AccuracySetting::Step => solver.step_s /= by.powi(level),
            AccuracySetting::Tolerance => solver.tolerance /= by.powi(level),
        });
        let Some(finer) = fine.ok().map(|fine| run(&fine)).transpose()?.flatten() else {
            return Ok(located.or_else(|| judge(&own, None)));
        };
        located = judge(&own, Some((&finer, falls)));
        // Steps that are far too long show no order.
        let is_open =
            |found: &Located| found.cause.is_none() && found.first() >= Some(Stage::Equations);
        if !located.as_ref().is_some_and(is_open) {
            break;
        }
        own = finer;
    }
    Ok(located)
}
