//! Runs behind the claims, and what is read off their courses.

use pinwheel_courses::{Courses, columns};

use super::Verdict;
use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::{Detection, Scene};

/// A figure in words, its numbers, and what follows.
pub(super) type Figure = (String, Vec<f64>, Verdict);

/// The steady window of all claims, s.
pub(super) const STEADY: (f64, f64) = (0.3, 0.6);

/// The paper's scene, solved accurately, with one change.
pub(super) fn scene(change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = Scene::paper();
    scene.solver.integrator = "rk4".into();
    change(&mut scene);
    scene
}

/// Asked now and then during a run: false ends it.
pub(super) type Go<'a> = &'a dyn Fn() -> bool;

/// The gearbox of a scene that a claim changed.
pub(super) fn compile(scene: &Scene) -> Result<Gearbox, NativeError> {
    let scene = scene.clone().check().map_err(GearboxError::from)?;
    Ok(Gearbox::new(&scene)?)
}

pub(super) fn run(scene: &Scene, go: Go<'_>) -> Result<NativeRun, NativeError> {
    Ok(native::run(&compile(scene)?, &mut |_| !go())?.whole()?)
}

/// The course of a single channel; empty if there is none.
pub(super) fn course<'a>(courses: &'a Courses, name: &str) -> &'a [f64] {
    courses.channel(name).unwrap_or(&[])
}

/// The sleeve forces of one kind within a window.
pub(super) fn forces<'a>(
    courses: &'a Courses,
    kind: &'a str,
    window: (f64, f64),
) -> impl Iterator<Item = &'a [f64]> {
    let range = courses.window(window.0, window.1);
    courses
        .group(kind)
        .into_iter()
        .map(move |values| values.get(range.clone()).unwrap_or(&[]))
}

pub(super) const EXTERNAL: &str = columns::EXTERNAL_FORCE;
pub(super) const INTERNAL: &str = columns::INTERNAL_FORCE;

pub(super) fn largest(courses: &Courses, kind: &str, window: (f64, f64)) -> f64 {
    forces(courses, kind, window)
        .flatten()
        .copied()
        .fold(0.0, f64::max)
}

pub(super) fn torque(courses: &Courses, window: (f64, f64)) -> &[f64] {
    let range = courses.window(window.0, window.1);
    course(courses, columns::INPUT_TORQUE)
        .get(range)
        .unwrap_or(&[])
}

pub(super) fn range(values: &[f64]) -> f64 {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| {
            (l.min(x), h.max(x))
        });
    high - low
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub(super) fn verdict(holds: bool) -> Verdict {
    if holds {
        Verdict::Holds
    } else {
        Verdict::DoesNotHold
    }
}

/// The paper's detection with so many points, at its own step and method; `None`: exact.
pub(super) fn points(count: Option<usize>) -> Scene {
    scene(|s| {
        if let Some(count) = count {
            s.contact.detection = Detection::Points;
            s.contact.wheel_points = count;
            // The paper's rough and refined analyses.
            s.contact.hole_points = if count < 4000 { 20 } else { 100 };
            s.solver.integrator = "rk2".into();
        }
    })
}
