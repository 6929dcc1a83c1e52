//! `pinwheel sweep`: a study as data.

use pinwheel::pages;
use pinwheel::studies::Provenance;
use pinwheel::studies::folder::beside;
use pinwheel::studies::sweep::{self, Journal, Plan, Sweep, SweepError, execute};

use crate::args::{self, SweepArgs};
use crate::failure::{ENGINE, Failure};
use crate::folder::{self, Folder};
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let plan = plan(args)?;
    if args.list {
        screen::show(&pages::sweep::list(&plan))?;
        return Ok(0);
    }
    let out = args.out.folder(&plan.sweep.name, "sweep");
    // Checked before anything long is run; what is written comes at the end.
    drop(Folder::prepare(&out, args.out.force)?);
    // `out/backlash.unfinished` for `out/backlash`.
    let place = beside(&out, ".unfinished");
    let there = place.exists();
    let earlier = out.join("runs");
    let earlier = args.resume.then_some(earlier.as_path());
    let journal = Journal::open(&place, earlier, &args::typed())?;
    if there && !args.resume {
        if !args.out.force {
            return Err(Failure::input(format!(
                "{} holds runs of an earlier attempt; go on with --resume, or start over with --force",
                place.display()
            )));
        }
        journal.clear()?;
    }
    let jobs = args.jobs.map_or_else(args::cores, usize::from);
    let records = watched("sweep", |control| execute(&plan, &journal, jobs, control));
    let records = match records {
        Err(SweepError::Stopped { .. }) if journal.in_its_folder() == 0 => {
            journal.remove()?;
            return Err(Failure::stopped());
        }
        records => records?,
    };
    let folder = Folder::prepare(&out, args.out.force)?;
    let (table, made) = (
        sweep::results(&plan, &records),
        Provenance::here(args::typed()),
    );
    sweep::write(folder.path(), &plan, &records, &table, &journal, &made)?;
    let page = pages::sweep::page(&plan, &records, &table, &made)?;
    folder.write_page(&page)?;
    let out = folder.publish()?;
    // Only now: had it failed, --resume would still find every run.
    journal.remove()?;
    let results = out.join("results.csv").display().to_string();
    let text = pages::sweep::text(&plan, &records, &results);
    screen::show_with_page(&text, &folder::page(&out))?;
    let broken: Vec<_> = records.iter().filter(|r| !r.ending.is_finished()).collect();
    if let Some(record) = broken.first() {
        screen::complain(&format!(
            "{} of {} runs did not finish, the first on {}: {}; see {}",
            broken.len(),
            records.len(),
            record.engine,
            record.reason(),
            out.join("results.csv").display()
        ));
        return Ok(ENGINE);
    }
    Ok(0)
}

fn plan(args: &SweepArgs) -> Result<Plan, Failure> {
    let mut sweep = Sweep::read(&args.file)?;
    if !args.engines.is_empty() {
        sweep.engines = args
            .engines
            .iter()
            .map(|name| name.trim().to_owned())
            .collect();
    }
    sweep.engines.extend(args.solvers.join()?);
    Ok(Plan::within(
        sweep,
        &args::overrides(&args.set)?,
        interrupt::flag(),
    )?)
}
