//! `pinwheel sweep`: a study described by a file.

use pinwheel::pages;
use pinwheel::studies::StudyError;
use pinwheel::studies::folder::PAGE;
use pinwheel::studies::sweep::{self, Begin, Guests, Journal, Plan, Sweep, execute};

use crate::args::{self, SweepArgs};
use crate::failure::Failure;
use crate::folder::Folder;
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let plan = plan(args)?;
    if args.list {
        return screen::show(&pages::sweep::list(&plan)?);
    }
    let file = args.file.display().to_string();
    let prepare = || Folder::of_scenes(&args.out, &[&file], "sweep");
    // Checked before any long run; writing comes at the end.
    let out = prepare()?.place().to_owned();
    let begin = Begin::of(args.resume, args.out.force);
    let journal = Journal::begin(&out, begin, &args::typed())?;
    let jobs = args.jobs.map_or_else(args::cores, usize::from);
    let rows = watched(|control| execute(&plan, &journal, jobs, control));
    let rows = match rows {
        Err(fault) if journal.in_its_folder() == 0 => {
            journal.remove()?;
            return Err(match fault {
                StudyError::Stopped { .. } => Failure::stopped(),
                fault => fault.into(),
            });
        }
        rows => rows?,
    };
    let rows = rows.all().unwrap_or_default();
    let folder = prepare()?;
    let table = sweep::results(&plan, &rows);
    let origin = folder.write(|dir, of| sweep::write(dir, &plan, &rows, &table, &journal, of))?;
    let page = pages::sweep::page(&plan, &rows, &table, &origin);
    let csv = out.join("results.csv").display().to_string();
    let text = pages::sweep::text(&plan, &rows, &table, &[("results", csv.clone())]);
    folder.write_page(&page)?;
    let place = folder.publish()?;
    // Only now: after an earlier failure --resume still needs every run.
    journal.remove()?;
    screen::show_with_page(&text, &place.join(PAGE))?;
    let mut broken = sweep::broken(&rows);
    let all = broken.clone().count();
    let Some(first) = broken.next() else {
        return Ok(());
    };
    Err(Failure::engine(format!(
        "{all} of {} runs did not finish, the first on {}: {}; see {csv}",
        rows.len(),
        first.engine()[0],
        first.reason(),
    )))
}

fn plan(args: &SweepArgs) -> Result<Plan, Failure> {
    let mut sweep = Sweep::read(&args.file)?;
    if !args.engines.is_empty() {
        let names = args.engines.iter().map(|name| name.trim().to_owned());
        sweep.engines = names.collect();
    }
    sweep.engines = args.solvers.join_named(&sweep.engines)?;
    let (sets, guests) = (args::overrides(&args.set)?, Guests::default());
    Ok(Plan::within(sweep, &sets, guests, interrupt::flag())?)
}
