//! Which engines a command means, and one run of one of them.

use pinwheel_engines::{Control, Engine, EngineError, Run, by_name, recorded, registry};
use pinwheel_scene::{CheckedScene, Scene, did_you_mean};

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;

/// The engine of that name.
///
/// An unknown name is bad input; one of an engine that exists but was not built in is a missing engine.
pub(crate) fn find(name: &str, scene: &Scene) -> Result<Box<dyn Engine>, Failure> {
    by_name(name, scene).ok_or_else(|| {
        let optional =
            [("rapier", "rapier"), ("exudyn", "crossval"), ("mujoco", "crossval")];
        let left_out = optional.iter().find(|(prefix, _)| {
            name.starts_with(prefix) && !registry().iter().any(|e| e.name().starts_with(prefix))
        });
        if let Some((_, feature)) = left_out {
            return Failure::engine(format!(
                "engine `{name}` is missing: this build has none of its kind; build with --features {feature}, or see `pinwheel engines`"
            ));
        }
        let known = names();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        Failure::input(format!(
            "there is no engine `{name}`; {}",
            did_you_mean(name, &known)
        ))
    })
}

/// The engine of that name, or its recording of this very scene where this build lacks the engine.
pub(crate) fn find_or_recorded(name: &str, scene: &Scene) -> Result<Box<dyn Engine>, Failure> {
    find(name, scene)
        .or_else(|missing| recorded::instead(name, scene, recorded::NOT_BUILT).ok_or(missing))
}

/// Every name `--engine` takes.
fn names() -> Vec<String> {
    let listed = registry()
        .into_iter()
        .map(|engine| engine.name().to_owned());
    std::iter::once("native".to_owned()).chain(listed).collect()
}

/// Runs one engine with progress; the outer failure is the user's stop.
pub(crate) fn run(
    engine: &dyn Engine,
    scene: &CheckedScene,
    label: &str,
) -> Result<Result<Run, EngineError>, Failure> {
    interrupt::check()?;
    let progress = Progress::new(label, scene.solver.duration_s);
    let report = |time_s: f64| progress.reached(time_s);
    let control = Control {
        cancel: interrupt::flag(),
        progress: &report,
    };
    let result = engine.run(scene, &control);
    progress.finish();
    let mut result = match result {
        Err(EngineError::Cancelled) => return Err(Failure::stopped()),
        other => interrupt::check().map(|()| other)?,
    };
    match &mut result {
        Ok(run) => run.note_missing_channels(scene),
        Err(EngineError::Diverged { partial, .. }) => partial.note_missing_channels(scene),
        Err(_) => {}
    }
    Ok(result)
}
