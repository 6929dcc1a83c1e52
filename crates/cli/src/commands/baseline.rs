//! `pinwheel baseline`: what the solver gave when it was last accepted, and what moved since.

use pinwheel::pages;
use pinwheel::studies::baseline::{self, Baseline, Made, Options, Place, Verdict, made};
use pinwheel::studies::{Provenance, junit};

use crate::args::{self, Action, BaselineArgs, CheckArgs, ListArgs, RecordBaselineArgs, Which};
use crate::failure::{EXCEEDED, Failure};
use crate::folder::Folder;
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn baseline(args: &BaselineArgs) -> Result<u8, Failure> {
    match &args.action {
        Action::Record(args) => record_baseline(args),
        Action::Check(args) => check(args),
        Action::List(args) => list(args),
    }
}

fn record_baseline(args: &RecordBaselineArgs) -> Result<u8, Failure> {
    let Which { dir, name } = &args.which;
    let place = Place::of(dir, name)?;
    let reason = args.accept.as_deref().map(str::trim);
    if place.earlier.is_some() && reason.is_none_or(str::is_empty) {
        return Err(Failure::input(format!(
            "{} exists; say why its results may change: --accept \"reason\", or choose another name",
            place.folder.display()
        )));
    }
    interrupt::check()?;
    let folder = Folder::prepare_known(&place.folder, place.files())?;
    let here = made(dir);
    let accepted = place.accepted(&here, reason);
    let options = Options {
        threads: args.running.threads.into(),
        repeats: REPEATS,
        only: args.running.only.clone(),
        solvers: args.running.solvers.join()?,
        ..Options::default()
    };
    let recorded = watched("baseline", |control| {
        baseline::record(here, accepted, &options, control)
    })?;
    recorded.write(folder.path())?;
    let out = folder.publish()?;
    let cases: usize = recorded.scenes.iter().map(|scene| scene.cases.len()).sum();
    screen::show(&format!(
        "{} scenes, {cases} cases in {}\nlook at the diff before you commit it",
        recorded.scenes.len(),
        out.display()
    ))?;
    Ok(0)
}

/// Runs of each case of a record, of which the shortest is its time.
const REPEATS: usize = 3;

fn check(args: &CheckArgs) -> Result<u8, Failure> {
    let Which { dir, name } = &args.which;
    let accepted = Baseline::open(dir, name)?;
    let out = args.out.or(format!("baseline-{name}"));
    let folder = Folder::prepare_beside(&out, args.out.force, dir)?;
    let options = Options {
        kernel: args.kernel,
        threads: args.running.threads.into(),
        repeats: args.repeats.into(),
        only: args.running.only.clone(),
        judge_time: args.judge_time,
        solvers: args.running.solvers.join()?,
    };
    let here = Made {
        vectors: options.kernel.vectors().to_owned(),
        ..made(dir)
    };
    let found = watched("baseline", |control| {
        baseline::check(&accepted, here, &options, control)
    })?;

    let made = Provenance::here(args::typed());
    baseline::write(&found, &accepted.head, folder.path(), &made)?;
    let page = pages::baseline::page(name, &accepted.head, &found, &made)?;
    folder.show(&page, &pages::baseline::text(&found))?;
    if let Some(path) = &args.junit {
        junit::write(path, "pinwheel baseline", &junit::of_baseline(name, &found))?;
    }
    Ok(if found.verdict == Verdict::Worse {
        EXCEEDED
    } else {
        0
    })
}

fn list(args: &ListArgs) -> Result<u8, Failure> {
    let listed = Baseline::list(&args.dir)?;
    screen::show_or_json(args.out.json, &listed, || {
        if listed.is_empty() {
            let dir = args.dir.display();
            return format!("no baselines in {dir}; `pinwheel baseline record` makes one");
        }
        pages::baseline::list(&listed)
    })?;
    Ok(0)
}
