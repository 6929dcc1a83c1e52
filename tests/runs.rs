//! Runs of engines, and the distance of their courses.

use pinwheel_courses::Courses;
use pinwheel_engines::{Control, EngineError, Run, by_name};
use pinwheel_scene::{Override, Scene};

/// The preset with keys overridden, as `--set` does it.
///
/// # Panics
/// When there is no such preset or key, or a value is refused.
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

/// One run to its end or its error.
///
/// # Errors
/// Those of the engine.
///
/// # Panics
/// When there is no engine of that name.
pub fn attempt(engine: &str, scene: &Scene) -> Result<Run, EngineError> {
    match by_name(engine, scene) {
        Some(engine) => engine.run(&scene.clone().check().unwrap(), &Control::quiet()),
        None => panic!("there is no engine {engine}"),
    }
}

/// The courses of a run that must not fail.
///
/// # Panics
/// When it does.
#[must_use]
pub fn run(engine: &str, scene: &Scene) -> Courses {
    match attempt(engine, scene) {
        Ok(run) => run.courses,
        Err(error) => panic!("{engine}: {error}"),
    }
}

/// A native run of the same scene with another method and step.
#[must_use]
pub fn native(scene: &Scene, integrator: &str, step_s: f64) -> Courses {
    let mut scene = scene.clone();
    scene.solver.integrator = integrator.to_owned();
    scene.solver.step_s = step_s;
    run("native", &scene)
}

/// The channels of a quantity: a single one, or one per sleeve.
#[must_use]
pub fn channels<'a>(courses: &'a Courses, quantity: &str) -> Vec<&'a [f64]> {
    let group = courses.group(quantity);
    if group.is_empty() {
        courses.channel(quantity).into_iter().collect()
    } else {
        group
    }
}

/// RMS of the difference over RMS of the reference, over all channels of the quantities together and the samples in
/// the window, s, both ends included.
///
/// # Panics
/// When the courses lack samples of the window or channels of the reference, or there is nothing to compare: silence must not
/// look like agreement.
#[must_use]
pub fn relative(
    courses: &Courses,
    reference: &Courses,
    quantities: &[&str],
    (from_s, to_s): (f64, f64),
) -> f64 {
    let window = reference.window(from_s, to_s);
    assert!(window.len() > 5, "window of {} samples", window.len());
    assert!(courses.len() >= window.end, "{} samples", courses.len());
    let (mut difference, mut size) = (0.0, 0.0);
    for quantity in quantities {
        let (ours, theirs) = (channels(courses, quantity), channels(reference, quantity));
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
