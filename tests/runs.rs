//! Runs of engines, and the distance of their time series.

use pinwheel_engines::{Control, Run, by_name};
use pinwheel_scene::{Override, Scene};
use pinwheel_timeseries::TimeSeries;

/// Returns the preset with keys overridden, as by `--set`.
///
/// # Panics
/// For an unknown preset or key, or a refused value.
#[must_use]
pub fn scene(preset: &str, settings: &[(&str, &str)]) -> Scene {
    let overrides: Vec<Override> = settings
        .iter()
        .map(|&(key, value)| Override::new(key, value))
        .collect();
    match Scene::load(preset, &overrides) {
        Ok(scene) => scene.into_scene(),
        Err(error) => panic!("{preset}, {settings:?}: {error}"),
    }
}

/// Makes one run with any ending.
///
/// # Panics
/// For an unknown engine.
#[must_use]
pub fn attempt(engine: &str, scene: &Scene) -> Run {
    let scene = scene.clone().check().unwrap();
    match by_name(engine, &scene) {
        Some(engine) => engine.run(&scene, &Control::quiet()).unwrap(),
        None => panic!("there is no engine {engine}"),
    }
}

/// Makes a run that must finish.
///
/// # Panics
/// If it does not.
#[must_use]
pub fn finished(engine: &str, scene: &Scene) -> Run {
    match attempt(engine, scene).finished() {
        Ok(run) => run,
        Err(ending) => panic!("{engine} {ending}"),
    }
}

/// Returns the time series of a run that must not fail.
///
/// # Panics
/// If it does.
#[must_use]
pub fn run(engine: &str, scene: &Scene) -> TimeSeries {
    finished(engine, scene).time_series
}

/// Makes a native run of a scene with another method and step.
#[must_use]
pub fn native(scene: &Scene, integrator: &str, step_s: f64) -> TimeSeries {
    let mut scene = scene.clone();
    scene.solver.integrator = integrator.to_owned();
    scene.solver.step_s = step_s;
    run("native", &scene)
}

/// Returns the channels of a quantity: a single one, or one per pin.
#[must_use]
pub fn channels<'a>(time_series: &'a TimeSeries, quantity: &str) -> Vec<&'a [f64]> {
    let group = time_series.group(quantity);
    if group.is_empty() {
        time_series.channel(quantity).into_iter().collect()
    } else {
        group
    }
}

/// Returns the RMS of the difference over RMS of the reference, over all channels of the quantities together and the
/// samples in the window, s, both ends included.
///
/// # Panics
/// If the time series lack samples of the window or channels of the reference, or there is nothing to compare, which must
/// not look like agreement.
#[must_use]
pub fn relative(
    time_series: &TimeSeries,
    reference: &TimeSeries,
    quantities: &[&str],
    (from_s, to_s): (f64, f64),
) -> f64 {
    let window = reference.window(from_s, to_s);
    assert!(window.len() > 5, "window of {} samples", window.len());
    assert!(
        time_series.len() >= window.end,
        "{} samples",
        time_series.len()
    );
    let (mut difference, mut size) = (0.0, 0.0);
    for quantity in quantities {
        let (ours, theirs) = (
            channels(time_series, quantity),
            channels(reference, quantity),
        );
        assert!(!theirs.is_empty(), "no {quantity}");
        assert_eq!(ours.len(), theirs.len(), "{quantity}");
        for (a, b) in ours.iter().zip(&theirs) {
            for i in window.clone() {
                difference += (a[i] - b[i]).powi(2);
                size += b[i].powi(2);
            }
        }
    }
    (difference / size).sqrt()
}
