//! Judgement of the engines of a comparison that differ from the native solver.

use pinwheel_compare::comparison::Pair;
use pinwheel_compare::{Comparison, Participant, SharedModel, Verdict};
use pinwheel_engines::{Cancelled, Control, Engine};
use pinwheel_gearbox::Gearbox;
use pinwheel_timeseries::TimeSeries;

use super::engine::of_engine;
use super::kept::{RECORDED, of_record};
use super::locate::Located;
use crate::divergence::shares;

/// Share of the largest difference from which a run counts as departed.
const DEPARTED: f64 = 0.2;

/// Judges the stages of every engine with the scene's law that differs from a native run or diverged. Inconclusive external
/// solvers and records are judged too; engines with contacts of their own are not.
///
/// # Errors
/// A stop.
pub fn of_comparison(
    gearbox: &Gearbox,
    engines: &[Box<dyn Engine>],
    comparison: &Comparison,
    participants: &[Participant],
    control: &Control<'_>,
) -> Result<Vec<Located>, Cancelled> {
    let natives = participants.iter();
    let mut natives =
        natives.filter(|one| one.track == SharedModel::Native && one.status.is_finished());
    let Some(native) = natives.next_back() else {
        return Ok(Vec::new());
    };
    let mut all = Vec::new();
    for one in participants
        .iter()
        .filter(|one| !one.time_series.is_empty())
    {
        let is_of = |pair: &&Pair| {
            [&pair.a, &pair.b].contains(&&native.name) && [&pair.a, &pair.b].contains(&&one.name)
        };
        let mut engines = engines.iter();
        let engine = engines.find(|engine| engine.name() == one.name);
        let brought = engine.is_none_or(|engine| engine.info().brought);
        let asked =
            |verdict| verdict == Verdict::Differ || verdict == Verdict::Inconclusive && brought;
        let mut pairs = comparison.pairs.iter().filter(is_of);
        // Records without limits have no verdict.
        let differs = one.status.is_broken()
            || one.track == SharedModel::Measured
            || pairs.any(|pair| pair.entries.iter().any(|entry| asked(entry.result.verdict)));
        let located = match (one.track, engine) {
            _ if !differs => None,
            (SharedModel::SharedLaw, Some(engine)) => {
                let until_s = match one.status.is_finished() {
                    true => departure_s(&one.time_series, &native.time_series),
                    false => 0.0,
                };
                let cost = one.cost.rhs_calls;
                let cost = Some(cost).filter(|cost| *cost > 0 && one.status.is_finished());
                let located = of_engine(engine.as_ref(), gearbox, until_s, cost, control)?;
                located.filter(|located| brought || located.first().is_some())
            }
            (SharedModel::Measured, _) => of_record(gearbox, &one.name, &one.time_series, RECORDED),
            _ => None,
        };
        all.extend(located);
    }
    Ok(all)
}

/// Returns the first time at which two runs with the same samples are [`DEPARTED`] of their largest distance apart, s.
fn departure_s(a: &TimeSeries, b: &TimeSeries) -> f64 {
    let apart = shares(a, b, 1.0);
    let most = apart.iter().copied().fold(0.0, f64::max);
    let first = apart.iter().position(|apart| *apart > DEPARTED * most);
    first.map_or(0.0, |k| a.time_s()[k])
}
