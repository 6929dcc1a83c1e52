//! `pinwheel record`: courses of the Python engines, kept for builds and machines without them.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use pinwheel_engines::recorded::{RECORDED_SCENES, Recording, worth_keeping};
use pinwheel_engines::{Engine, EngineError, registry};
use pinwheel_scene::{CheckedScene, Scene};

use crate::commands::compare::today;
use crate::engines;
use crate::failure::{ENGINE, Failure};
use crate::machine::Machine;
use crate::screen;

/// `pinwheel record`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel record
  pinwheel record paper steel --engines mujoco-shared-law

Writes DIR/SCENE/ENGINE.toml (what, how and when) and DIR/SCENE/ENGINE.csv (courses, thinned and rounded).
A build embeds the recordings it finds in reference/recorded and compares with them where it has no live engine.
Engines that cannot run a scene, or diverge on it, are left out with the reason.")]
pub(crate) struct RecordArgs {
    /// Presets or scene files [default: the scenes that recordings are kept of].
    pub(crate) scenes: Vec<String>,
    /// Engines to record, separated by commas [default: all Python engines of this build].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Folder of recordings.
    #[arg(long, value_name = "DIR", default_value = "reference/recorded")]
    pub(crate) out: PathBuf,
}

pub(crate) fn record(args: &RecordArgs) -> Result<u8, Failure> {
    let scenes: Vec<CheckedScene> = if args.scenes.is_empty() {
        RECORDED_SCENES
            .map(|name| Scene::load(name, &[]))
            .into_iter()
            .collect::<Result<_, _>>()?
    } else {
        args.scenes
            .iter()
            .map(|name| Scene::load(name, &[]))
            .collect::<Result<_, _>>()?
    };
    let mut failed = false;
    for scene in &scenes {
        let chosen: Vec<Box<dyn Engine>> = if args.engines.is_empty() {
            registry()
                .into_iter()
                .filter(|engine| {
                    ["exudyn", "mujoco"]
                        .iter()
                        .any(|peer| engine.name().starts_with(peer))
                })
                .collect()
        } else {
            args.engines
                .iter()
                .map(|name| engines::find(name.trim(), scene))
                .collect::<Result<_, _>>()?
        };
        if chosen.is_empty() {
            return Err(Failure::engine(
                "this build has no Python engines to record; build with --features crossval",
            ));
        }
        for engine in chosen {
            failed |= !one(engine.as_ref(), scene, &args.out)?;
        }
    }
    Ok(if failed { ENGINE } else { 0 })
}

/// Records one run and says so; false if the engine broke.
fn one(engine: &dyn Engine, scene: &CheckedScene, out: &Path) -> Result<bool, Failure> {
    let label = format!("{} {}", scene.name, engine.name());
    if let Err(reason) = worth_keeping(engine.name(), scene) {
        screen::show(&format!("{label}: not recorded: {reason}"))?;
        return Ok(true);
    }
    let ran = match engine.supports(scene) {
        Ok(()) => engines::run(engine, scene, &label)?,
        Err(error) => Err(error),
    };
    let run = match ran {
        Ok(run) => run,
        Err(EngineError::Cancelled) => return Err(Failure::stopped()),
        Err(error) => {
            screen::show(&format!("{label}: not recorded: {error}"))?;
            return Ok(!matches!(error, EngineError::Failed { .. }));
        }
    };
    let mut recording = Recording::new(engine, scene, run);
    let machine = Machine::here();
    recording.machine = format!("{}, {}", machine.processor, machine.operating_system);
    recording.date = today().unwrap_or_default();
    recording.command = format!("pinwheel record {} --engines {}", scene.name, engine.name());
    let (description, csv) = recording
        .write()
        .map_err(|error| Failure::engine(error.to_string()))?;
    let folder = out.join(&scene.name);
    let path = folder.join(engine.name());
    let write = || -> std::io::Result<()> {
        fs::create_dir_all(&folder)?;
        // The courses first: without a description they are not a recording.
        for (ending, text) in [("csv", &csv), ("toml", &description)] {
            let draft = path.with_extension(format!("{ending}.part"));
            fs::write(&draft, text)?;
            fs::rename(&draft, path.with_extension(ending))?;
        }
        Ok(())
    };
    write().map_err(|error| Failure::unwritable(&path, &error))?;
    screen::show(&format!(
        "{label}: {} samples, {} kB",
        recording.courses.len(),
        (csv.len() + description.len()) / 1000
    ))?;
    Ok(true)
}
