//! `pinwheel compare`: one scene, several engines, one report; or two scenes, one engine.

use std::path::Path;
use std::time::Duration;

use pinwheel::compare::Status;
use pinwheel::gearbox::Gearbox;
use pinwheel::pages;
use pinwheel::scene::{CheckedScene, PRESETS};
use pinwheel::studies::comparison::{self, Effort, Input, foreign};
use pinwheel::studies::{Provenance, choice, designs, junit};

use crate::args::{self, CompareArgs, ForeignArgs};
use crate::failure::{ENGINE, Failure};
use crate::folder::{self, Folder};
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let gearbox = args.scene.load()?;
    if let Some(other) = &args.other {
        return designs(args, &gearbox, other);
    }
    let data = open(&args.foreign)?;
    let gearbox = foreign::with_channels(&data, gearbox)?;
    let scene = &gearbox.scene;
    let asked_by_name = !args.engines.is_empty();
    let engines = choice::engines(&args.solvers.join_named(&args.engines)?, scene)?;
    let folder = Folder::prepare(&args.out.folder(&scene.name, "compare"), args.out.force)?;

    let input = Input {
        gearbox: &gearbox,
        engines: &engines,
        data: &data,
    };
    let effort = effort(args, &args.scene.scene, scene)?;
    let found = watched("compare", |control| {
        comparison::run_with(&input, effort, control)
    })?;
    let made = Provenance::here(args::typed());
    found.write(folder.path(), &made)?;
    let page = pages::comparison::page(&found, &made, interrupt::flag())?;
    folder.write_page(&page)?;
    let out = folder.publish()?;
    if let Some(path) = &args.junit {
        junit::write(
            path,
            "pinwheel compare",
            &junit::of_comparison(&found.comparison),
        )?;
    }
    let text = pages::comparison::text(scene, &found.comparison);
    screen::show_with_page(&text, &folder::page(&out))?;

    let broken = found
        .participants
        .iter()
        .find(|participant| match participant.status {
            Status::Finished => false,
            // Left out with its reason, which is what one wants unless it was asked for.
            Status::Unsupported { .. } => asked_by_name,
            Status::Diverged { .. } | Status::Failed { .. } => true,
        });
    if let Some(participant) = broken {
        let remedy = match participant.status {
            Status::Diverged { .. } => "try a smaller solver.step_s or another solver.integrator",
            _ => "leave it out with --engines, or change the scene",
        };
        screen::complain(&format!(
            "{} {}; {remedy}",
            participant.name,
            participant.status.reason().unwrap_or_default()
        ));
        return Ok(ENGINE);
    }
    Ok(found.comparison.outcome.exit_status())
}

/// Two designs by one engine.
fn designs(args: &CompareArgs, first: &Gearbox, other: &str) -> Result<u8, Failure> {
    let second = args.scene.load_as(other)?;
    let gearboxes = [first, &second];
    let specs = [args.scene.scene.as_str(), other];
    let named = match args.engines.as_slice() {
        [] => args.solvers.join()?,
        names => args.solvers.join_named(names)?,
    };
    let name = match named.as_slice() {
        [] => "native",
        [one] => one,
        _ => {
            return Err(Failure::input(
                "two designs are compared by one engine; name one in --engines, or compare one scene",
            ));
        }
    };
    let engine = choice::find(name, &first.scene)?;
    let [a, b] = [0, 1].map(|k| effort(args, specs[k], &gearboxes[k].scene));
    let names = gearboxes
        .map(|gearbox| gearbox.scene.name.as_str())
        .join("-and-");
    let folder = Folder::prepare(&args.out.folder(&names, "compare"), args.out.force)?;
    let input = designs::Input {
        gearboxes,
        specs,
        engine: engine.as_ref(),
        efforts: [a?, b?],
    };
    let found = watched("compare", |control| designs::run(&input, control))?;
    let made = Provenance::here(args::typed());
    found.write(folder.path(), &made)?;
    folder.write_page(&pages::designs::page(&found, &made, interrupt::flag())?)?;
    let out = folder.publish()?;
    screen::show_with_page(&pages::designs::text(&found), &folder::page(&out))?;
    if let Some((name, reason)) = found.broken() {
        screen::complain(&format!(
            "{name} {reason}; try a smaller solver.step_s or another solver.integrator"
        ));
        return Ok(ENGINE);
    }
    Ok(0)
}

/// Settings that the user states are obeyed; those of a preset, a base or a formula are a beginning.
fn effort(args: &CompareArgs, spec: &str, scene: &CheckedScene) -> Result<Effort, Failure> {
    let longest = Duration::try_from_secs_f64(args.longest)
        .map_err(|_| Failure::input("--longest: give seconds, 0 or more"))?;
    let asked = |set: &String| {
        ["solver.step_s", "solver.tolerance", "solver.integrator"]
            .iter()
            .any(|key| set.trim_start().starts_with(key))
    };
    if !(args.resolution > 0.0 && args.resolution <= 1.0) {
        return Err(Failure::input(
            "--resolution: give a share above 0 and at most 1, e.g. 0.001",
        ));
    }
    let preset = PRESETS.iter().any(|p| p.name == spec);
    let obey = args.scene.set.iter().any(asked) || !preset && Effort::of(scene).obey;
    Ok(Effort {
        longest,
        obey,
        resolution: args.resolution,
    })
}

/// Reads the maps and files, before anything long is run.
fn open(args: &ForeignArgs) -> Result<Vec<foreign::Data>, Failure> {
    let (files, maps) = (args.against.len(), args.map.len());
    if files != maps && maps > 1 {
        return Err(Failure::input(format!(
            "--against is given {files} times and --map {maps} times; give one map for each file, or one for all"
        )));
    }
    // One map serves all files.
    let maps = args.map.iter().cycle().map(|path| path.as_path());
    let files = args.against.iter().map(|path| -> &Path { path });
    Ok(foreign::open(files.zip(maps))?)
}
