//! The engine that stands in Adams' place: one that finds and resolves contacts itself.

use pinwheel_engines::{Engine, EngineError, Track, by_name};
use pinwheel_gearbox::scene::Scene;
use pinwheel_studies::paper::Peer;

use crate::engines;
use crate::failure::Failure;

/// In this order: multibody programs with contacts of their own first, as Adams is one.
const PREFERRED: [&str; 3] = [
    "exudyn-own-contact",
    "mujoco-own-contact",
    "rapier-own-contact-colliders",
];

/// The first engine there is, or the one named; `None` if this build has none at all.
pub(super) fn peer(named: Option<&str>) -> Result<Option<Peer>, Failure> {
    let scene = Scene::default();
    if let Some(name) = named {
        let engine = engines::find(name, &scene)?;
        if engine.track() != Track::OwnContact {
            return Err(Failure::input(format!(
                "--against {name}: takes its contact forces from our law; name an own-contact engine of `pinwheel engines`"
            )));
        }
        return run(engine.as_ref(), &scene, String::new()).map(Some);
    }
    let mut missing = Vec::new();
    for name in PREFERRED {
        let Some(engine) = by_name(name, &scene) else {
            missing.push(name);
            continue;
        };
        if engine.supports(&scene).is_err() {
            missing.push(name);
            continue;
        }
        let note = if missing.is_empty() {
            String::new()
        } else {
            format!("This build has no {}.", missing.join(", no "))
        };
        return run(engine.as_ref(), &scene, note).map(Some);
    }
    Ok(None)
}

fn run(engine: &dyn Engine, scene: &Scene, note: String) -> Result<Peer, Failure> {
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
