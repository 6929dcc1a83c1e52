//! `pinwheel compare`: one scene, several engines, one report.

use std::path::Path;

use pinwheel::pages;
use pinwheel::scene::PRESETS;
use pinwheel::studies::comparison::{self, Effort, Input, foreign};
use pinwheel::studies::{Provenance, choice, junit};

use crate::args::{self, CompareArgs, ForeignArgs};
use crate::failure::{ENGINE, Failure};
use crate::folder::Folder;
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let overrides = args::overrides(&args.scene.set)?;
    let gearbox = args.scene.load()?;
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
    let mut effort = Effort::asked(scene, args.longest, args.resolution)?;
    let stated = overrides
        .iter()
        .any(|set| Effort::KEYS.contains(&set.key()));
    let preset = PRESETS.iter().any(|preset| preset.name == args.scene.scene);
    effort.obey = stated || !preset && effort.obey;
    let found = watched("compare", |control| {
        comparison::run_with(&input, effort, control)
    })?;
    let made = Provenance::here(args::typed());
    found.write(folder.path(), &made)?;
    let page = pages::comparison::page(&found, &made, interrupt::flag())?;
    let text = pages::comparison::text(scene, &found.comparison);
    folder.show(&page, &text)?;
    if let Some(path) = &args.junit {
        junit::write(
            path,
            "pinwheel compare",
            &junit::of_comparison(&found.comparison),
        )?;
    }

    if let Some(broken) = found.broken(asked_by_name) {
        screen::complain(&broken);
        return Ok(ENGINE);
    }
    Ok(found.comparison.outcome.exit_status())
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
