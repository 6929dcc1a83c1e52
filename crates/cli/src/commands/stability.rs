//! `pinwheel stability`: which method survives which hard scene, and at which step.

use std::path::PathBuf;

use pinwheel::gearbox::Gearbox;
use pinwheel::pages;
use pinwheel::scene::Scene;
use pinwheel::studies::output::write_text;
use pinwheel::studies::survey::{Plan, Survey, judged};
use pinwheel::studies::{Provenance, StudyError};

use crate::args::{self, StabilityArgs, quoted};
use crate::failure::{EXCEEDED, Failure, STOPPED};
use crate::folder::Folder;
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn stability(args: &StabilityArgs) -> Result<u8, Failure> {
    let plan = plan(args)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/stability"));
    let mut survey = if args.resume {
        Survey::resume(&out, &plan)?
    } else {
        Survey::new(plan)
    };
    let folder = Folder::prepare(&out, args.force)?;
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
    write_text(&folder.path().join("index.html"), &page)?;
    if stopped {
        let place = folder.publish_partial()?;
        let (done, all) = survey.done();
        let out = if args.out.is_none() && place == out {
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
    let out = folder.publish()?;
    screen::show(&format!(
        "{}\nreport  {}",
        pages::stability::text(&survey),
        out.join("index.html").display()
    ))?;
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

/// The plan, whose scenes can all be modelled.
fn plan(args: &StabilityArgs) -> Result<Plan, Failure> {
    let plan = if args.quick {
        Plan::quick()
    } else {
        Plan::full()
    };
    if args.scenes.is_empty() {
        return Ok(plan);
    }
    for (k, name) in args.scenes.iter().enumerate() {
        if args.scenes[..k].contains(name) {
            return Err(Failure::input(format!(
                "{name} is named twice; name each scene once"
            )));
        }
        let scene = Scene::load(name, &[])?;
        Gearbox::new(&scene).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    }
    Ok(plan.only(&args.scenes))
}
