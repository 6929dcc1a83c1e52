//! Stage that changed since the acceptance of a case.
//!
//! ```text
//! native solver     accepted converged figures against the present model with suspected changes: the model;
//!                   if they are equal: the equations if joint errors changed most, otherwise the integration
//! external solver   its present run at its own states
//! ```

use pinwheel_engines::by_name;
use pinwheel_timeseries::TimeSeries;

use super::file::SceneSnapshot;
use super::runner::Job;
use super::snapshot::{Quantity, Statistics, WINDOWS, statistics};
use crate::StudyError;
use crate::control::{Control, compile};
use crate::stages::{Kept, of_engine, of_kept};

/// Least change of converged figures attributed to the model, without friction and with it; the error of the flow is
/// smaller.
const MOVED: [f64; 2] = [1e-6, 1e-3];

/// Number of compared windows without friction, and with it, which makes runs expensive.
const FOLLOWED: [usize; 2] = [2, 1];

/// Returns the changed stage as text, and true if it belongs to the model, which all solvers of the scene share. `drifts`:
/// joints changed most.
///
/// # Errors
/// A stop, or a scene that cannot be modelled.
pub(super) fn stage(
    accepted: &SceneSnapshot,
    job: &Job,
    drifts: bool,
    control: &Control<'_>,
) -> Result<(String, bool), StudyError> {
    let gearbox = compile(&job.scene)?;
    let control = Control::silent(control.cancel);
    if job.solver.is_none() {
        let is_kept = |of: &Quantity| !matches!(of, Quantity::Energy | Quantity::JointDrift);
        let kept = accepted.converged.iter().filter(|(of, _)| is_kept(of));
        let kept: Vec<_> = kept.collect();
        let rubs = usize::from(gearbox.has_friction());
        let windows = FOLLOWED[rubs];
        let share = |statistics: &Statistics, scale: f64| -> Vec<f64> {
            let lists = [&statistics.mean, &statistics.rms, &statistics.peak];
            let lists = lists.into_iter().flat_map(|list| list.iter().take(windows));
            lists.map(|figure| figure / scale).collect()
        };
        let written = kept.iter().map(|(_, of)| share(&of.statistics, of.scale));
        let own = kept.iter().map(|(_, of)| of.own_error);
        let times = gearbox.scene.solver.sample_times_s();
        let kept_of = Kept {
            name: &accepted.name,
            times_s: &times[..times.len() * windows / WINDOWS],
            written: &written.collect::<Vec<_>>().concat(),
            bound: own.fold(MOVED[rubs], f64::max),
            evaluations: u64::MAX,
        };
        let moved = of_kept(&gearbox, &kept_of, &|run| {
            let mut series = TimeSeries::new(times.clone()).unwrap_or_default();
            for channel in run.channels() {
                let mut values = channel.values.clone();
                values.resize(times.len(), 0.0);
                let _ = series.push(channel.name.clone(), values);
            }
            let now = statistics(&gearbox, &series, None, None);
            let of = kept.iter().map(|(of, then)| share(&now[of], then.scale));
            of.collect::<Vec<_>>().concat()
        });
        if let Some(moved) = moved {
            let as_it_was = " (the accepted results are the present model's with this)";
            let stage = match moved.cause {
                Some(_) => moved.words() + as_it_was,
                None => {
                    "not told: no known change of the model explains how converged results moved"
                        .to_owned()
                }
            };
            return Ok((stage, true));
        }
    }
    let Some(name) = &job.solver else {
        let stage = match drifts {
            true => "equations: joints drift; converged forces are the accepted ones",
            false => {
                "integration: converged results are the accepted ones, the error of the method is not"
            }
        };
        return Ok((stage.to_owned(), false));
    };
    let engine = by_name(name, &gearbox.scene);
    let located = engine.map(|engine| of_engine(engine.as_ref(), &gearbox, 0.0, None, &control));
    let located = located.transpose()?.flatten();
    let stage = match located {
        None => "not told: it does not run".to_owned(),
        Some(located) if located.first().is_none() => format!("not told: {}", located.words()),
        Some(located) => located.words(),
    };
    Ok((stage, false))
}
