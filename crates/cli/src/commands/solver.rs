//! `pinwheel solver`: writes, checks and serves a user's solver.

use std::path::Path;

use pinwheel::engines::external::{self, Manifest, Solver, scaffold::Language};
use pinwheel::pages;
use pinwheel::studies::output::file_name;
use pinwheel::studies::{conformance, junit};

use crate::args::{OutArgs, SceneArgs, SolverAction, SolverArgs};
use crate::failure::{DIFFER, Failure};
use crate::folder::{Folder, check_junit, relative};
use crate::progress::watched;
use crate::screen;

pub(crate) fn solver(args: &SolverArgs) -> Result<u8, Failure> {
    match &args.action {
        SolverAction::New { language, name } => new(*language, name),
        SolverAction::Check { file, junit, out } => check(file, junit.as_deref(), out),
        SolverAction::Job { scene, folder } => job(scene, folder),
        SolverAction::Library => {
            let library = external::law_library().map_err(Failure::engine)?;
            let folder = library.parent().unwrap_or(&library).display();
            screen::show(&folder.to_string()).map(|()| 0)
        }
    }
}

fn new(language: Language, name: &str) -> Result<u8, Failure> {
    Manifest::is_name(name).map_err(Failure::input)?;
    let folder = Folder::fresh(Path::new(name))?;
    let unwritten =
        |error: std::io::Error| Failure::input(format!("{name} cannot be written: {error}"));
    let files = language.write(folder.path(), name).map_err(unwritten)?;
    let place = folder.publish()?;
    let solver = Solver::open(&place.join("solver.toml"));
    let solver = solver.map_err(Failure::engine)?;
    let build = solver.manifest().build.as_ref();
    let build = build.map(|build| format!("  cd {name} && {build} && cd ..\n"));
    let build = build.unwrap_or_default();
    screen::show(&format!(
        "{name}/: {}\nnow:\n{build}  pinwheel solver check {name}/solver.toml\n  pinwheel compare paper --solver {name}/solver.toml",
        files.join(", ")
    ))?;
    Ok(0)
}

fn check(file: &Path, junit: Option<&Path>, out: &OutArgs) -> Result<u8, Failure> {
    let solver = Solver::open(file).map_err(Failure::input)?;
    let name = solver.manifest().name.clone();
    let label = format!("{}-check", file_name(&name));
    let folder = Folder::of(out, label, &relative(file))?;
    check_junit(junit, folder.place())?;
    let outcome = watched(|control| conformance::check(&solver, control))?;
    let origin = folder.write(|dir, origin| outcome.write(dir, origin))?;
    let page = pages::conformance::page(&outcome, &origin);
    folder.show(&page, &pages::conformance::text(&outcome))?;
    if let Some(path) = junit {
        junit::write(path, "pinwheel solver check", vec![outcome.suite()])?;
    }
    Ok(if outcome.passed() { 0 } else { DIFFER })
}

fn job(scene: &SceneArgs, folder: &Path) -> Result<u8, Failure> {
    let gearbox = scene.load()?;
    let library = external::law_library();
    let draft = Folder::fresh(folder)?;
    external::write_job(&gearbox, draft.path(), library.as_deref().ok())
        .map_err(Failure::engine)?;
    draft.publish()?;
    let law = library.map_or_else(|remedy| remedy, |path| path.display().to_string());
    screen::show(&format!(
        "{}\nlaw library: {law}",
        folder.join("scene.json").display()
    ))?;
    Ok(0)
}
