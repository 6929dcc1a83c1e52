//! `pinwheel compare`: one scene, several engines, one report; or two scenes, one engine.

use pinwheel::gearbox::Gearbox;
use pinwheel::pages;
use pinwheel::scene::CheckedScene;
use pinwheel::studies::comparison::{self, Effort, Input, foreign};
use pinwheel::studies::{choice, design_diff, junit};

use super::idle;
use crate::args::{self, CompareArgs, SceneArgs};
use crate::failure::Failure;
use crate::folder::{Folder, check_junit};
use crate::progress::watched;
use crate::screen;

pub(crate) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let gearbox = args.scene.load()?;
    if let Some(other) = &args.other {
        return designs(args, &gearbox, other);
    }
    let data = foreign::open_all(&args.foreign.against, &args.foreign.map)?;
    let gearbox = foreign::with_channels(&data, gearbox)?;
    let scene = &gearbox.scene;
    let asked_by_name = !args.engines.is_empty();
    let engines = choice::engines(&args.solvers.join_named(&args.engines)?, scene)?;
    let folder = Folder::of_scenes(&args.out, &[&args.scene.scene], "compare")?;
    check_junit(args.junit.as_deref(), folder.place())?;

    let input = Input {
        gearbox: &gearbox,
        engines: &engines,
        data: &data,
    };
    let effort = effort(args, &args.scene.scene, scene)?;
    let mut found = watched(|control| comparison::run_with(&input, effort, control))?;
    // An engine that was asked for by name and is left out ends in an error.
    found.comparison.passed &= found.broken(asked_by_name).is_none();
    let made = folder.write(|dir, made| found.write(dir, made))?;
    let page = pages::comparison::page(&found, &made);
    let mut text = pages::comparison::text(scene, &found);
    if screen::manner().verbose {
        text.push('\n');
        text.push_str(&pages::comparison::details(&found));
    }
    folder.show(&page, &text)?;
    if let Some(path) = &args.junit {
        let suites = junit::of_comparison(&found.comparison);
        junit::write(path, "pinwheel compare", suites)?;
    }
    name_idle(&args.scene, &gearbox)?;

    match found.broken(asked_by_name) {
        Some(broken) => Err(Failure::engine(broken)),
        None => Ok(found.exit_status()),
    }
}

/// Names the settings of the model without which a native run is equal to the bit; those of solvers other engines may read.
fn name_idle(args: &SceneArgs, gearbox: &Gearbox) -> Result<(), Failure> {
    let is_model = |set: &String| !set.starts_with("solver.");
    if !args.set.iter().any(is_model) {
        return Ok(());
    }
    let engine = choice::find("native-reduced", &gearbox.scene)?;
    let of = "the native time series of this scene";
    idle::name(args, gearbox, of, |settings, control| {
        let mut idle = settings.idle(engine.as_ref(), control)?;
        idle.retain(|place| is_model(&args.set[*place]));
        Ok(idle)
    })
}

/// Two designs by one engine.
fn designs(args: &CompareArgs, first: &Gearbox, other: &str) -> Result<u8, Failure> {
    let second = args.scene.load_as(other)?;
    let gearboxes = [first, &second];
    let specs = [args.scene.scene.as_str(), other];
    let name = args.solvers.only(&args.engines)?;
    let engine = choice::find(&name, &first.scene)?;
    let [a, b] = [0, 1].map(|k| effort(args, specs[k], &gearboxes[k].scene));
    let folder = Folder::of_scenes(&args.out, &specs, "compare")?;
    let input = design_diff::Input {
        gearboxes,
        specs,
        engine: engine.as_ref(),
        efforts: [a?, b?],
    };
    let found = watched(|control| design_diff::run(&input, control))?;
    let made = folder.write(|dir, made| found.write(dir, made))?;
    let page = pages::design_diff::page(&found, &made);
    folder.show(&page, &pages::design_diff::text(&found))?;
    if let Some((name, reason)) = found.broken() {
        return Err(Failure::engine(format!(
            "{name} {reason}; try a smaller solver.step_s or another solver.integrator"
        )));
    }
    Ok(0)
}

fn effort(args: &CompareArgs, spec: &str, scene: &CheckedScene) -> Result<Effort, Failure> {
    let sets = args::overrides(&args.scene.set)?;
    Ok(Effort::asked(
        scene,
        spec,
        &sets,
        args.longest,
        args.resolution,
    )?)
}
