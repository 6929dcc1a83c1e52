//! The engine that stands in Adams' place: one that finds and resolves contacts itself.

use pinwheel_engines::{Engine, Track, by_name, known, recorded};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;

use super::Peer;
use crate::StudyError;
use crate::choice::find_or_recorded;
use crate::control::{Control, Progress, compile};

/// The engine named, live or else recorded; or of the preferred ones the first that is recorded or in this build.
/// `None` if there is none at all.
///
/// Recordings go first where none is named: the Python engines take minutes for what this page shows of them.
///
/// # Errors
/// Cancelled; an engine that there is not, that has no contacts of its own, or that does not finish.
pub fn peer(named: Option<&str>, control: &Control<'_>) -> Result<Option<Peer>, StudyError> {
    let scene = Scene::load("paper", &[])?;
    let gearbox = compile(&scene)?;
    if let Some(name) = named {
        let engine = find_or_recorded(name, &scene)?;
        if engine.track() != Track::OwnContact {
            return Err(StudyError::Input(format!(
                "--against {name}: takes its contact forces from our law; name an own-contact engine of `pinwheel engines`"
            )));
        }
        return run(engine.as_ref(), &gearbox, String::new(), control).map(Some);
    }
    let mut missing = Vec::new();
    let mut fit: Vec<_> = known().filter(|info| info.stands_in.is_some()).collect();
    fit.sort_by_key(|info| info.stands_in);
    for name in fit.into_iter().map(|info| info.name) {
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
                return run(engine.as_ref(), &gearbox, note, control).map(Some);
            }
            None => missing.push(name),
        }
    }
    Ok(None)
}

fn run(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    note: String,
    control: &Control<'_>,
) -> Result<Peer, StudyError> {
    let at = control.piece(Progress::new(0, 1, engine.name()));
    let run = engine.run_compiled(gearbox, &at)?.whole();
    let run = run.map_err(|ending| StudyError::Ended {
        engine: engine.name().to_owned(),
        ending,
    })?;
    let version = engine.version();
    Ok(Peer {
        name: format!("{} {version}", engine.name()),
        live: !version.contains("recorded"),
        differences: engine.info().differences.to_owned(),
        note,
        courses: run.courses,
        wall_s: Some(run.stats.wall_s),
    })
}
