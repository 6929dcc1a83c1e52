//! `pinwheel sweep`: a study as data.

use std::path::Path;

use pinwheel::pages;
use pinwheel::studies::Provenance;
use pinwheel::studies::folder::PAGE;
use pinwheel::studies::sweep::{
    self, Begin, Guests, Journal, Plan, RunRecord, Shard, Sweep, SweepError, execute, execute_some,
    gather,
};

use crate::args::{self, SweepArgs};
use crate::failure::{ENGINE, Failure};
use crate::folder::Folder;
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let plan = plan(args)?;
    if args.list {
        screen::show(&pages::sweep::list(&plan))?;
        return Ok(0);
    }
    let file = args.file.display().to_string();
    let prepare = || Folder::of_scenes(&args.out, &[&file], "sweep");
    // Checked before anything long is run; what is written comes at the end.
    let out = prepare()?.place().to_owned();
    if let Some(part) = args.shard {
        return shard(args, &plan, &Journal::beside(&out), part);
    }
    let begin = match (args.gather, args.resume, args.out.force) {
        (true, ..) => Begin::Gather,
        (_, true, _) => Begin::Resume,
        (_, _, true) => Begin::Over,
        _ => Begin::Fresh,
    };
    let journal = Journal::begin(&out, begin, &args::typed())?;
    let records = if args.gather {
        gather(&plan, &journal)
    } else {
        watched("sweep", |control| {
            execute(&plan, &journal, jobs(args), control)
        })
    };
    let records = match records {
        Err(fault) if journal.in_its_folder() == 0 => {
            journal.remove()?;
            return Err(match fault {
                SweepError::Stopped { .. } => Failure::stopped(),
                fault => fault.into(),
            });
        }
        records => records?,
    };
    let folder = prepare()?;
    let (table, made) = (
        sweep::results(&plan, &records),
        Provenance::here(args::typed()),
    );
    sweep::write(folder.path(), &plan, &records, &table, &journal, &made)?;
    let page = pages::sweep::page(&plan, &records, &table, &made);
    let csv = out.join("results.csv").display().to_string();
    let text = pages::sweep::text(&plan, &records, &[("results", csv.clone())]);
    folder.write_page(&page)?;
    let place = folder.publish()?;
    // Only now: had it failed, --resume would still find every run.
    journal.remove()?;
    screen::show_with_page(&text, &place.join(PAGE))?;
    Ok(ended(&records, &format!("see {csv}")))
}

fn jobs(args: &SweepArgs) -> usize {
    args.jobs.map_or_else(args::cores, usize::from)
}

/// Runs one shard; its records stay in the journal until they are gathered.
fn shard(args: &SweepArgs, plan: &Plan, place: &Path, shard: Shard) -> Result<u8, Failure> {
    let picks = shard.picks(plan.runs.len());
    let journal = Journal::shard(place, shard, &args::typed())?;
    let records = watched("sweep", |control| {
        execute_some(plan, &picks, &journal, jobs(args), control)
    })?;
    screen::show(&format!(
        "shard {shard}: {} of {} runs are in {}; when all shards are done, the same command with --gather writes the results",
        records.len(),
        plan.runs.len(),
        place.display()
    ))?;
    Ok(ended(
        &records,
        "the results say which; one that failed runs again when its shard does",
    ))
}

/// 3 if a run did not finish.
fn ended(records: &[RunRecord], see: &str) -> u8 {
    let broken = |record: &&RunRecord| !record.ending.is_finished();
    let Some(first) = records.iter().find(broken) else {
        return 0;
    };
    screen::complain(&format!(
        "{} of {} runs did not finish, the first on {}: {}; {see}",
        records.iter().filter(broken).count(),
        records.len(),
        first.engine,
        first.reason(),
    ));
    ENGINE
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
    sweep.engines = args.solvers.join_named(&sweep.engines)?;
    Ok(Plan::within(
        sweep,
        &args::overrides(&args.set)?,
        Guests::default(),
        interrupt::flag(),
    )?)
}
