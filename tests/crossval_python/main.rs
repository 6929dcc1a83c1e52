//! exudyn and MuJoCo against the native solver, live and as recorded.
//!
//! Limits are measured figures times a margin; each stands beside its measurement.

#![allow(clippy::print_stdout)] // measured figures, for whoever resets a limit

mod accuracy;
mod cycloidgen;
mod guards;
mod law;
mod package;
mod program;
mod recordings;

use pinwheel_courses::Courses;
use pinwheel_engines::{Control, EngineError, Run, by_name};
use pinwheel_gearbox::scene::{Override, Scene};

const MUJOCO: &str = "mujoco-shared-law";
const EXPLICIT: &str = "exudyn-shared-law-explicit";
const CONSTRAINED: &str = "exudyn-shared-law-constrained";
const MUJOCO_OWN: &str = "mujoco-own-contact";
const EXUDYN_OWN: &str = "exudyn-own-contact";
const SHARED: [&str; 3] = [MUJOCO, EXPLICIT, CONSTRAINED];
const ALL: [&str; 5] = [MUJOCO, EXPLICIT, CONSTRAINED, MUJOCO_OWN, EXUDYN_OWN];

const QUANTITIES: [&str; 4] = [
    "input_torque_n_m",
    "output_torque_n_m",
    "external_sleeve_force_n",
    "internal_sleeve_force_n",
];

fn scene(preset: &str, settings: &[(&str, &str)]) -> Scene {
    let overrides: Vec<Override> = settings
        .iter()
        .map(|&(key, value)| Override::new(key, value))
        .collect();
    Scene::load(preset, &overrides).unwrap()
}

fn attempt(engine: &str, scene: &Scene) -> Result<Run, EngineError> {
    by_name(engine, scene)
        .unwrap()
        .run(scene, &Control::quiet())
}

fn run(engine: &str, scene: &Scene) -> Courses {
    attempt(engine, scene).unwrap().courses
}

/// A native run of the same scene with a method and step.
fn native(scene: &Scene, integrator: &str, step_s: f64) -> Courses {
    let mut scene = scene.clone();
    scene.solver.integrator = integrator.to_owned();
    scene.solver.step_s = step_s;
    run("native", &scene)
}

fn channels<'a>(courses: &'a Courses, quantity: &str) -> Vec<&'a [f64]> {
    let group = courses.group(quantity);
    if group.is_empty() {
        courses.channel(quantity).into_iter().collect()
    } else {
        group
    }
}

/// RMS of the difference over RMS of the reference, all channels of a quantity jointly.
fn relative(courses: &Courses, reference: &Courses, quantity: &str, from_s: f64) -> f64 {
    let window = reference.window(from_s, f64::INFINITY);
    assert!(window.len() > 5 && courses.len() == reference.len());
    let (ours, theirs) = (channels(courses, quantity), channels(reference, quantity));
    assert_eq!(ours.len(), theirs.len());
    let (mut difference, mut size) = (0.0, 0.0);
    for (a, b) in ours.iter().zip(&theirs) {
        for i in window.clone() {
            difference += (a[i] - b[i]).powi(2);
            size += b[i].powi(2);
        }
    }
    (difference / size).sqrt()
}

/// The largest of the four quantities' errors.
fn worst(courses: &Courses, reference: &Courses, from_s: f64) -> f64 {
    QUANTITIES
        .iter()
        .map(|quantity| relative(courses, reference, quantity, from_s))
        .fold(0.0, f64::max)
}

fn assert_within(what: &str, error: f64, limit: f64) {
    println!("{what}: {error:.2e} (limit {limit:.1e})");
    assert!(error < limit, "{what}: {error:e}, limit {limit:e}");
}

fn assert_same_bits(a: &Courses, b: &Courses, what: &str) {
    assert_eq!(a.len(), b.len());
    for (x, y) in a.channels().iter().zip(b.channels()) {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&x.values), bits(&y.values), "{what}: {}", x.name);
    }
}
