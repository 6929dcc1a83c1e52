//! Stages of the engines of a comparison that differ from the native solver.

use pinwheel_compare::comparison::Pair;
use pinwheel_compare::{Comparison, Participant, SharedModel, Verdict};
use pinwheel_engines::{Cancelled, Control, Engine};
use pinwheel_gearbox::Gearbox;
use pinwheel_timeseries::TimeSeries;

use super::engine::of_engine;
use super::locate::Located;

/// Share of the largest difference from which a run has departed.
const DEPARTED: f64 = 0.2;

/// Judges the stages of every engine with the scene's law that differs from a native run or diverged, and of solvers from outside
/// that are inconclusive too.
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
    for engine in engines {
        let info = engine.info();
        let asked = |verdict| match verdict {
            Verdict::Differ => true,
            Verdict::Inconclusive => info.brought,
            _ => false,
        };
        let is_of = |pair: &&Pair| {
            let both = [&pair.a, &pair.b];
            both.contains(&&native.name) && both.iter().any(|name| *name == info.name)
        };
        let mut pairs = comparison.pairs.iter().filter(is_of);
        let mut ran = participants.iter();
        let ran = ran.find(|one| one.name == info.name && !one.time_series.is_empty());
        let differs = |one: &&Participant| {
            one.status.is_broken()
                || pairs.any(|pair| pair.entries.iter().any(|entry| asked(entry.result.verdict)))
        };
        if info.track == SharedModel::SharedLaw
            && let Some(ran) = ran.filter(differs)
        {
            let until_s = match ran.status.is_finished() {
                true => departure_s(&ran.time_series, &native.time_series),
                false => 0.0,
            };
            let found = of_engine(engine.as_ref(), gearbox, until_s, control)?;
            all.extend(found.filter(|found| info.brought || found.first().is_some()));
        }
    }
    Ok(all)
}

/// First time at which two runs on the same samples are apart by a good part of their largest distance, s.
fn departure_s(a: &TimeSeries, b: &TimeSeries) -> f64 {
    let forces = a
        .channels()
        .iter()
        .filter(|channel| channel.name.contains("_force_n_"));
    let both: Vec<(&[f64], &[f64])> = forces
        .filter_map(|channel| Some((&channel.values[..], b.channel(&channel.name)?)))
        .collect();
    let apart: Vec<f64> = (0..a.len().min(b.len()))
        .map(|k| {
            both.iter()
                .map(|(a, b)| (a[k] - b[k]).abs())
                .fold(0.0, f64::max)
        })
        .collect();
    let most = apart.iter().copied().fold(0.0, f64::max);
    let first = apart.iter().position(|apart| *apart > DEPARTED * most);
    first.map_or(0.0, |k| a.time_s()[k])
}
