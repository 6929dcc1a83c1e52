//! The engine that stands in Adams' place: one that finds and resolves contacts itself.

use pinwheel_engines::{Engine, EngineError, Track, by_name, recorded};
use pinwheel_scene::{CheckedScene, Scene};
use pinwheel_studies::paper::Peer;

use crate::engines;
use crate::failure::Failure;

/// In this order: multibody programs with contacts of their own first, as Adams is one.
const PREFERRED: [&str; 3] = [
    "exudyn-own-contact",
    "mujoco-own-contact",
    "rapier-own-contact-colliders",
];

/// The engine named, live or else recorded; or of the preferred ones the first that is recorded or in this build.
/// `None` if there is none at all.
///
/// Recordings go first where none is named: the Python engines take minutes for what this page shows of them.
pub(super) fn peer(named: Option<&str>) -> Result<Option<Peer>, Failure> {
    let scene = Scene::load("paper", &[])?;
    if let Some(name) = named {
        let engine = engines::find_or_recorded(name, &scene)?;
        if engine.track() != Track::OwnContact {
            return Err(Failure::input(format!(
                "--against {name}: takes its contact forces from our law; name an own-contact engine of `pinwheel engines`"
            )));
        }
        return run(engine.as_ref(), &scene, String::new()).map(Some);
    }
    let mut missing = Vec::new();
    for name in PREFERRED {
        let recording = recorded::instead(
            name,
            &scene,
            "it takes minutes; name it with --against to run it",
        );
        let engine = recording.or_else(|| by_name(name, &scene));
        match engine.filter(|engine| engine.supports(&scene).is_ok()) {
            Some(engine) => {
                let note = if missing.is_empty() {
                    String::new()
                } else {
                    format!("Neither built in nor recorded: {}.", missing.join(", "))
                };
                return run(engine.as_ref(), &scene, note).map(Some);
            }
            None => missing.push(name),
        }
    }
    Ok(None)
}

fn run(engine: &dyn Engine, scene: &CheckedScene, note: String) -> Result<Peer, Failure> {
    let run = engines::run(engine, scene, engine.name())?.map_err(|error| match error {
        EngineError::Cancelled => Failure::stopped(),
        error => Failure::engine(format!("{error}; choose another with --against")),
    })?;
    let version = engine.version();
    Ok(Peer {
        name: format!("{} {version}", engine.name()),
        live: !version.contains("recorded"),
        differences: engine.differences().to_owned(),
        note,
        courses: run.courses,
        wall_s: Some(run.stats.wall_s),
    })
}
