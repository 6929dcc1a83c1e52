//! Comparisons by numerical uncertainty, on studies with known errors.

mod agreement;
use super::common;
mod evidence;
mod inconclusive;
mod models;
mod series;

use common::{context, participant, time_series};
use pinwheel_compare::comparison::{Comparison, PairEntry};
use pinwheel_compare::uncertainty::Method;
use pinwheel_compare::{
    Context, Evidence, Ladder, Level, Participant, Rules, SharedModel, WindowKind, compare,
};
use pinwheel_timeseries::TimeSeries;

const FORCE: &str = "external_sleeve_force_n";

const TORQUE: &str = "input_torque_n_m";

/// A gear without calibration.
fn anywhere() -> Context {
    context()
}

/// Returns `base` with a relative error `error` in every channel: one waveform, the same for every level.
fn off(base: &TimeSeries, error: f64) -> TimeSeries {
    let mut time_series = TimeSeries::new(base.time_s().to_vec()).unwrap();
    for (k, channel) in base.channels().iter().enumerate() {
        let shape = |t: f64| 1.0 + error * (1.0 + (35.0 * t + k as f64).sin());
        let values = channel
            .values
            .iter()
            .zip(base.time_s())
            .map(|(v, &t)| v * shape(t));
        time_series
            .push(channel.name.clone(), values.collect())
            .unwrap();
    }
    time_series
}

/// Returns an engine whose error at H times its step is `error * H^order`, and its study at the refinements.
fn engine(
    name: &str,
    on: SharedModel,
    base: &TimeSeries,
    error: f64,
    order: f64,
    refinements: &[f64],
) -> (Participant, Evidence) {
    let at = |h: f64| off(base, error * h.powf(order));
    let level = |&refinement: &f64| Level {
        setting: 1e-5 * refinement,
        run: Ok(at(refinement)),
        wall_s: 1.0,
    };
    let ladder = Ladder {
        method: Method::Step { order, rough: None },
        finest: 1e-5,
        floor: 0.0,
        coarser: refinements.iter().map(level).collect(),
    };
    let mut participant = participant(name, on, at(1.0));
    participant.cost.steps = 60_000;
    (participant, Evidence::refinement(name, ladder))
}

fn compared(context: &Context, list: Vec<(Participant, Evidence)>) -> Comparison {
    let (participants, evidence): (Vec<_>, Vec<_>) = list.into_iter().unzip();
    let rules = Rules {
        evidence: &evidence,
        tolerances: &common::TOLERANCES,
        ..Rules::default()
    };
    compare(context, &participants, &rules).unwrap()
}

fn entry<'a>(comparison: &'a Comparison, quantity: &str) -> &'a PairEntry {
    let entries = comparison.pairs[0].entries.iter();
    let mut steady = entries.filter(|e| e.window == WindowKind::Steady);
    steady.find(|e| e.quantity == quantity).unwrap()
}

fn native(error: f64) -> (Participant, Evidence) {
    engine(
        "native",
        SharedModel::Native,
        &time_series(1.0),
        error,
        2.0,
        &[2.0, 4.0],
    )
}
