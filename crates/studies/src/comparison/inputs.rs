//! u_input of ASME V&V 20: the effect of a scene's uncertain values on its time series.
//!
//! A few keys are moved one at a time to both ends of their intervals. The contribution of a key is half of the distance over
//! the root of three, and contributions add as squares. Many keys are moved together by a Latin hypercube (McKay, Beckman,
//! Conover 1979), and the standard deviation of the series at every sample is the result.

use pinwheel_compare::quantities::derive;
use pinwheel_scene::CheckedScene;
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::View;

use crate::StudyError;
use crate::band::intervals;
use crate::control::{Control, Progress, complete};
use crate::rng::Rng;
use crate::sampling::hypercube;

/// Largest number of keys that are moved one at a time.
const FEW: usize = 8;
/// Number of runs of a hypercube, whose standard deviation is then accurate to 1/8.
const SAMPLES: usize = 32;

/// Returns the standard uncertainty of every quantity over the run, as a share of its RMS; empty for a scene without uncertain
/// values.
pub(super) fn uncertainty(
    scene: &CheckedScene,
    control: &Control<'_>,
) -> Result<Vec<(String, f64)>, StudyError> {
    if scene.uncertain.is_empty() {
        return Ok(Vec::new());
    }
    let few = scene.uncertain.len() <= FEW;
    let variants = if few { ends(scene) } else { all_at_once(scene) };
    let total = variants.len() + 1;
    let mut done = 0;
    let mut run = |moves: &[(&str, f64)]| {
        let at = Progress::new(done, total, "uncertain inputs");
        (control.progress)(at);
        done += 1;
        control.check()?;
        let mut moved = scene.clone();
        for (key, value) in moves {
            moved = moved.with_number(key, *value).map_err(|fault| {
                StudyError::Input(format!(
                    "uncertain.{key}: at {value} the scene cannot be: {fault}"
                ))
            })?;
        }
        complete(&moved, control).map(|run| run.time_series)
    };
    let middle = run(&[])?;
    let runs = variants
        .iter()
        .map(|moves| run(moves))
        .collect::<Result<Vec<TimeSeries>, _>>()?;
    let shares = derive([&middle]).into_iter().filter_map(|quantity| {
        let rows = 0..middle.len();
        let view = |time_series| {
            let view = View::of(time_series, &quantity.channels, rows.clone())?;
            Some(view.values().collect::<Vec<f64>>())
        };
        let size = square(&view(&middle)?);
        let series: Vec<Vec<f64>> = runs.iter().map(view).collect::<Option<_>>()?;
        let variance = if few {
            series.chunks(2).map(|pair| between(pair) / 12.0).sum()
        } else {
            scatter(&series)
        };
        let share: f64 = (variance / size).sqrt();
        share.is_finite().then_some((quantity.name.clone(), share))
    });
    Ok(shares.collect())
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

/// Returns the squared distance between both ends of an interval, summed over samples: 12 times the variance of a uniform
/// value.
fn between(pair: &[Vec<f64>]) -> f64 {
    let [low, high] = pair else { return f64::NAN };
    low.iter().zip(high).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Returns the sum over samples of the variances.
fn scatter(series: &[Vec<f64>]) -> f64 {
    let count = series.len() as f64;
    let samples = series.first().map_or(0, Vec::len);
    let variance = |k: usize| {
        let mean = series.iter().map(|s| s[k]).sum::<f64>() / count;
        series.iter().map(|s| (s[k] - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    (0..samples).map(variance).sum()
}

/// Keys of a run with their values.
type Moves<'a> = Vec<(&'a str, f64)>;

/// Returns runs with one key at the lower or upper end of its interval and the others in the middle.
fn ends(scene: &CheckedScene) -> Vec<Moves<'_>> {
    let mut runs = Vec::new();
    for (key, middle, half) in intervals(scene) {
        runs.extend([-1.0, 1.0].map(|sign| vec![(key.as_str(), middle + sign * half)]));
    }
    runs
}

/// Returns the runs of a Latin hypercube, equal on every machine: each key has one value in each of [`SAMPLES`] equal parts of
/// its interval.
fn all_at_once(scene: &CheckedScene) -> Vec<Moves<'_>> {
    let mut rng = Rng::new(1);
    let mut runs: Vec<Moves<'_>> = vec![Vec::new(); SAMPLES];
    for (key, middle, half) in intervals(scene) {
        for (run, at) in runs.iter_mut().zip(hypercube(&mut rng, SAMPLES)) {
            run.push((key.as_str(), middle + (2.0 * at - 1.0) * half));
        }
    }
    runs
}
