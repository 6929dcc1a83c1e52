//! Progress and cancellation of a study.

use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::{CheckedScene, Scene};

use crate::StudyError;

/// Where a study is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress<'a> {
    /// Pieces done.
    pub done: usize,
    /// Pieces in all.
    pub total: usize,
    /// The piece that begins, e.g. a scene's name.
    pub piece: &'a str,
}

/// Cancellation and progress.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set from outside to stop; looked at in every sample of every run.
    pub cancel: &'a AtomicBool,
    /// Called at the beginning of every piece.
    pub progress: &'a (dyn Fn(Progress<'_>) + Sync),
}

impl Control<'_> {
    /// Never cancels, reports nothing.
    #[must_use]
    pub fn quiet() -> Control<'static> {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Control {
            cancel: &NEVER,
            progress: &|_| {},
        }
    }

    /// Runs a scene; a divergence is a result, not an error.
    pub(crate) fn run(&self, scene: &Scene) -> Result<Ended, StudyError> {
        run(scene, &mut |_| self.cancel.load(Ordering::Relaxed))
    }

    /// Runs a published model whose damping no sound scene has.
    pub(crate) fn run_published(&self, scene: &Scene) -> Result<Ended, StudyError> {
        let scene = CheckedScene::unchecked_for_published_study(scene.clone());
        let gearbox = Gearbox::new(&scene).map_err(|source| of_scene(&scene, source))?;
        run_compiled(&gearbox, &mut |_| self.cancel.load(Ordering::Relaxed))
    }

    /// Runs a scene that must reach its end.
    pub(crate) fn complete(&self, scene: &Scene) -> Result<NativeRun, StudyError> {
        match self.run(scene)? {
            Ended::Whole(run) => Ok(*run),
            Ended::Diverged { time_s, quantity } => Err(StudyError::Reference {
                scene: scene.name.clone(),
                reason: format!("diverged at t = {time_s:.6} s: {quantity}"),
            }),
        }
    }
}

/// Runs a scene; `watch` as in [`native::run`].
pub(crate) fn run(scene: &Scene, watch: &mut dyn FnMut(f64) -> bool) -> Result<Ended, StudyError> {
    run_compiled(&compile(scene)?, watch)
}

/// The gearbox of a scene that a study has changed, checked again.
pub(crate) fn compile(scene: &Scene) -> Result<Gearbox, StudyError> {
    let checked = scene.clone().check().map_err(GearboxError::from);
    checked
        .and_then(|scene| Gearbox::new(&scene))
        .map_err(|source| of_scene(scene, source))
}

/// Runs what is compiled; `watch` as in [`native::run`].
pub(crate) fn run_compiled(
    gearbox: &Gearbox,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Ended, StudyError> {
    match native::run(gearbox, watch) {
        Ok(run) => Ok(Ended::Whole(Box::new(run))),
        Err(NativeError::Diverged {
            time_s, quantity, ..
        }) => Ok(Ended::Diverged { time_s, quantity }),
        Err(NativeError::Stopped) => Err(StudyError::Cancelled),
        Err(NativeError::Model(source)) => Err(of_scene(&gearbox.scene, source)),
        Err(NativeError::Courses(source)) => Err(StudyError::Courses(source)),
    }
}

fn of_scene(scene: &Scene, source: GearboxError) -> StudyError {
    StudyError::Scene {
        scene: scene.name.clone(),
        source,
    }
}

/// How a run ended.
pub(crate) enum Ended {
    Whole(Box<NativeRun>),
    Diverged { time_s: f64, quantity: String },
}
