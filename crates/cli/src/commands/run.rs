//! `pinwheel run`: one scene, one engine.

use pinwheel::courses::Ending;
use pinwheel::pages;
use pinwheel::studies::single;
use pinwheel::studies::{Provenance, StudyError, choice};

use crate::args::{self, RunArgs};
use crate::failure::{ENGINE, EXCEEDED, Failure};
use crate::folder::Folder;
use crate::progress::watched;
use crate::screen;

pub(crate) fn run(args: &RunArgs) -> Result<u8, Failure> {
    let gearbox = args.scene.load()?;
    let scene = &gearbox.scene;
    let joined = args.solvers.join()?;
    let name = match joined.as_slice() {
        [] => &args.engine,
        [one] => one,
        _ => {
            return Err(Failure::input(
                "run takes one --solver; compare takes several",
            ));
        }
    };
    let engine = choice::find(name, scene)?;
    engine.prepare(&gearbox).map_err(StudyError::Engine)?;
    let folder = Folder::prepare(&args.out.folder(&scene.name, "run"), args.out.force)?;
    let found = watched("run", |control| {
        single::run(&gearbox, engine.as_ref(), !args.unchecked, control)
    })?;
    found.write(folder.path(), &Provenance::here(args::typed()))?;
    let courses = folder.publish()?.join(single::file(&found.ending));
    let courses = courses.display();

    if let Ending::Diverged { time_s, quantity } = &found.ending {
        screen::complain(&format!(
            "{} diverged at t = {time_s:.6} s: {quantity}; what there is until then is in {courses}; {}",
            found.engine,
            single::remedy(&gearbox, found.track)
        ));
        return Ok(ENGINE);
    }
    screen::show(&pages::single::text(&found, &courses.to_string()))?;
    if let Some(resolution) = found.resolution.filter(|resolution| !resolution.holds()) {
        screen::complain(&format!(
            "the step does not resolve this scene: {}; {}",
            resolution.sentence(),
            single::remedy(&gearbox, found.track)
        ));
        return Ok(EXCEEDED);
    }
    let verified = found.run.uncertainty.as_ref();
    if let Some(uncertainty) = verified.filter(|uncertainty| !uncertainty.is_resolved()) {
        screen::complain(&uncertainty.sentence());
        return Ok(EXCEEDED);
    }
    Ok(0)
}
