//! `pinwheel stability`: which method survives which hard scene, and at which step.

use pinwheel::pages;
use pinwheel::scene::Scene;
use pinwheel::studies::stability::Method;
use pinwheel::studies::survey::{Plan, Survey, judged};
use pinwheel::studies::{Provenance, StudyError};

use crate::args::{self, StabilityArgs, quoted};
use crate::failure::{EXCEEDED, Failure, STOPPED};
use crate::folder::Folder;
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn stability(args: &StabilityArgs) -> Result<u8, Failure> {
    let plan = if args.quick {
        Plan::quick()
    } else {
        Plan::full()
    };
    let mut plan = plan.of(&args.scenes)?;
    for solver in args.solvers.join()? {
        plan.atlas
            .methods
            .push(Method::of_solver(&solver, &Scene::paper()));
    }
    let out = args.out.or("stability");
    let mut survey = if args.resume {
        Survey::resume(&out, &plan)?
    } else {
        Survey::new(plan)
    };
    let folder = Folder::prepare(&out, args.out.force)?;
    interrupt::check()?;
    let jobs = args.jobs.map_or_else(args::cores, usize::from);
    let stopped = match watched("stability", |control| survey.go_on(jobs, control)) {
        Ok(()) => false,
        Err(StudyError::Cancelled) if survey.done().0 > 0 => true,
        Err(error) => return Err(error.into()),
    };

    let made = Provenance::here(args::typed());
    survey.write(folder.path(), &made)?;
    let page = pages::stability::page(&survey, &made)?;
    if stopped {
        let place = folder.publish_partial(&page)?;
        let (done, all) = survey.done();
        let out = if args.out.out.is_none() && place == out {
            String::new()
        } else {
            format!(" --out {}", quoted(&place.display().to_string()))
        };
        screen::complain(&format!(
            "stopped; {done} of {all} pieces are in {}; `{}{out} --resume` does the rest",
            place.display(),
            made.command
        ));
        return Ok(STOPPED);
    }
    folder.show(&page, &pages::stability::text(&survey))?;
    let unserved = judged::unserved(&survey);
    if unserved.is_empty() {
        return Ok(0);
    }
    screen::complain(&format!(
        "no method gives {} within {} %; see the page",
        unserved.join(", "),
        100.0 * judged::SERVED
    ));
    Ok(EXCEEDED)
}
