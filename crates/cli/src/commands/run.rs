//! `pinwheel run`: one scene, one engine.

use pinwheel::pages;
use pinwheel::studies::folder::PAGE;
use pinwheel::studies::{choice, single};

use super::idle;
use crate::args::RunArgs;
use crate::args::manner::Manner;
use crate::failure::{Failure, INCONCLUSIVE};
use crate::folder::Folder;
use crate::progress::watched;
use crate::screen;

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let gearbox = args.scene.load()?;
    let scene = &gearbox.scene;
    let name = args.solvers.only(args.engine.as_slice())?;
    let engine = choice::find(&name, scene)?;
    single::prepare(engine.as_ref(), &gearbox)?;
    let folder = Folder::of_scenes(&args.out, &[&args.scene.scene], "run")?;
    let outcome = watched(|control| {
        let outcome = single::run(&gearbox, engine.as_ref(), !args.unchecked, control)?;
        match args.unchecked || outcome.diverged().is_some() {
            // A run that broke off has no figures with a band.
            true => Ok(outcome),
            false => outcome
                .with_bands(&gearbox, control)?
                .for_page(&gearbox, control),
        }
    })?;
    let results = outcome.results();
    let origin = folder.write(|dir, origin| outcome.write(dir, origin, &results))?;
    if !args.unchecked {
        folder.write_page(&pages::single::page(&outcome, &results, &origin))?;
    }
    let place = folder.publish()?;
    if !args.unchecked {
        let of = "the time series of this scene";
        idle::name(&args.scene, &gearbox, of, |settings, control| {
            settings.idle_in_run(engine.as_ref(), &outcome.run, control)
        })?;
    }
    let time_series = place.join(single::file(&outcome.run.ending));
    let time_series = time_series.display();

    if let Some(diverged) = outcome.diverged() {
        let remedy = single::remedy(&gearbox, outcome.track);
        return Err(Failure::engine(format!(
            "{diverged}; what there is until then is in {time_series}; {remedy}"
        )));
    }
    let text = pages::single::text(&outcome, &results, Some(&time_series.to_string()));
    screen::show_found(&text, &place, "run.json")?;
    let Manner { quiet, json, .. } = screen::manner();
    if quiet {
        screen::show(&format!("courses: {time_series}"))?;
    } else if !(json || args.unchecked) {
        screen::show(&format!("page: {}", place.join(PAGE).display()))?;
    }
    match outcome.unresolved(&gearbox) {
        Some(unresolved) => Err(Failure::new(INCONCLUSIVE, unresolved)),
        None => Ok(()),
    }
}
