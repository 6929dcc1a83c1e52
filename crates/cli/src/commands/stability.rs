//! `pinwheel stability`: stable steps of each method on hard scenes.

use pinwheel::pages;
use pinwheel::scene::Scene;
use pinwheel::studies::StudyError;
use pinwheel::studies::stability::{Atlas, Method, Options, SERVED};

use crate::args::{self, StabilityArgs, quoted};
use crate::failure::{DIFFER, Failure, INCONCLUSIVE, STOPPED};
use crate::folder::{Folder, all_or};
use crate::interrupt;
use crate::progress::watched;

pub(crate) fn stability(args: &StabilityArgs) -> Result<u8, Failure> {
    let options = match args.quick {
        true => Options::quick(),
        false => Options::default(),
    };
    let mut options = options.of(&args.scenes)?;
    for solver in args.solvers.join()? {
        let method = Method::of_solver(&solver, &Scene::paper());
        options.methods.push(method);
    }
    let out = args.out.or("stability");
    let mut atlas = if args.resume {
        Atlas::resume(&out, &options)?
    } else {
        Atlas::new(options)
    };
    let folder = Folder::of(&args.out, "stability", &all_or(&args.scenes))?;
    interrupt::check()?;
    let jobs = args.jobs.map_or_else(args::cores, usize::from);
    let stopped = match watched(|control| atlas.go_on(jobs, control)) {
        Ok(()) => false,
        Err(StudyError::Cancelled) if atlas.done().count() > 0 => true,
        Err(error) => return Err(error.into()),
    };

    let origin = folder.write(|dir, origin| atlas.write(dir, origin))?;
    let page = pages::stability::page(&atlas, &origin);
    if stopped {
        let place = folder.publish_partial(&page)?;
        let (done, all) = (atlas.done().count(), atlas.rows.len());
        let out = if args.out.out.is_none() && place == out {
            String::new()
        } else {
            format!(" --out {}", quoted(&place.display().to_string()))
        };
        let message = format!(
            "stopped; {done} of {all} scenes are in {}; `{}{out} --resume` does the rest",
            place.display(),
            origin.command
        );
        return Err(Failure::new(STOPPED, message));
    }
    folder.show(&page, &pages::stability::text(&atlas))?;
    let unserved = atlas.unserved();
    if unserved.is_empty() {
        let nothing = atlas.findings().any(|(_, shown)| !shown);
        return Ok(if nothing { INCONCLUSIVE } else { 0 });
    }
    let (names, percent) = (unserved.join(", "), 100.0 * SERVED);
    let message = format!("no method gives {names} within {percent} %; see the page");
    Err(Failure::new(DIFFER, message))
}
