//! `pinwheel sweep`: a study as data.

mod args;
mod page;
mod written;

use std::fs;
use std::path::{Path, PathBuf};

use pinwheel_scene::Override;
use pinwheel_sweep::{
    Control, Journal, MOST_BYTES, Outcome, Plan, RunRecord, Sweep, SweepError, execute,
};

pub(crate) use args::SweepArgs;

use crate::args::quoted;
use crate::failure::{ENGINE, Failure, STOPPED};
use crate::folder::Folder;
use crate::interrupt;
use crate::progress::Progress;
use crate::screen::{self, BAD, TITLE, styled};
use crate::table::{Cell, lines};

pub(crate) fn sweep(args: &SweepArgs) -> Result<u8, Failure> {
    let plan = plan(args)?;
    if args.list {
        screen::show(&list(&plan))?;
        return Ok(0);
    }
    let out = args.out.folder(&plan.sweep.name, "sweep");
    // Checked before anything long is run; what is written comes at the end.
    drop(Folder::prepare(&out, args.out.force)?);
    let place = unfinished(&out);
    if place.exists() && !args.resume {
        if !args.out.force {
            return Err(Failure::input(format!(
                "{} holds runs of an earlier attempt; go on with --resume, or start over with --force",
                place.display()
            )));
        }
        fs::remove_dir_all(&place).map_err(|error| Failure::unwritable(&place, &error))?;
    }
    let earlier = out.join("runs");
    let journal =
        Journal::open(&place, args.resume.then_some(earlier.as_path())).map_err(failure)?;
    let records = match run(&plan, &journal, args) {
        Ok(records) => records,
        Err(SweepError::Stopped { finished, runs }) => {
            if journal.in_its_folder() == 0 {
                let _ = fs::remove_dir_all(&place);
            }
            return Err(Failure {
                code: STOPPED,
                message: format!(
                    "stopped; {finished} of {runs} runs are kept: go on with --resume"
                ),
            });
        }
        Err(error) => return Err(failure(error)),
    };
    let folder = Folder::prepare(&out, args.out.force)?;
    written::write(&folder, &plan, &records, &journal, &typed(args))?;
    let out = folder.publish()?;
    // Only now: had it failed, --resume would still find every run.
    fs::remove_dir_all(&place).map_err(|error| Failure::unwritable(&place, &error))?;
    screen::show(&summary(&plan, &records, &out))?;
    let broken = records
        .iter()
        .find(|record| record.outcome != Outcome::Finished);
    if let Some(record) = broken {
        let count = records
            .iter()
            .filter(|record| record.outcome != Outcome::Finished)
            .count();
        screen::complain(&format!(
            "{count} of {} runs did not finish, the first on {}: {}; see {}",
            records.len(),
            record.engine,
            record.outcome.reason(),
            out.join("results.csv").display()
        ));
        return Ok(ENGINE);
    }
    Ok(0)
}

/// `out/backlash.unfinished` for `out/backlash`.
fn unfinished(out: &Path) -> PathBuf {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".unfinished");
    out.with_file_name(name)
}

fn plan(args: &SweepArgs) -> Result<Plan, Failure> {
    let path = &args.file;
    let unreadable = |what: &str| {
        Failure::input(format!(
            "{}: {what}; give a sweep file (TOML), see docs/sweeps.md",
            path.display()
        ))
    };
    let size =
        fs::metadata(path).map_err(|error| unreadable(&format!("cannot be read: {error}")))?;
    if !size.is_file() || size.len() > MOST_BYTES as u64 {
        return Err(unreadable("is no sweep file"));
    }
    let text = fs::read_to_string(path)
        .map_err(|error| unreadable(&format!("cannot be read: {error}")))?;
    let mut sweep = Sweep::from_toml(&text, path).map_err(failure)?;
    if !args.engines.is_empty() {
        sweep.engines = args
            .engines
            .iter()
            .map(|name| name.trim().to_owned())
            .collect();
    }
    let overrides: Vec<Override> = args
        .set
        .iter()
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    Plan::new(sweep, &overrides).map_err(failure)
}

fn run(plan: &Plan, journal: &Journal, args: &SweepArgs) -> Result<Vec<RunRecord>, SweepError> {
    let jobs = args.jobs.map_or_else(
        || std::thread::available_parallelism().map_or(1, usize::from),
        usize::from,
    );
    let progress = Progress::new(plan.sweep.name.clone(), plan.duration_s());
    let report = |finished: usize, simulated_s: f64| {
        progress.reached_with(simulated_s, &|| {
            format!("{finished} of {} runs", plan.runs.len())
        });
    };
    let records = execute(
        plan,
        journal,
        jobs,
        &Control {
            cancel: interrupt::flag(),
            progress: &report,
        },
    );
    progress.finish();
    records
}

fn list(plan: &Plan) -> String {
    let mut header = vec![Cell::figure("run"), Cell::text("engine")];
    header.extend(plan.keys().map(Cell::figure));
    let mut rows = vec![header];
    for run in &plan.runs {
        let mut row = vec![
            Cell::figure(run.number.to_string()),
            Cell::text(&run.engine),
        ];
        row.extend(
            run.values
                .iter()
                .map(|(_, value)| Cell::figure(value.to_string())),
        );
        rows.push(row);
    }
    format!("{}\n{}", styled(TITLE, &plan.sweep.name), lines(&rows))
}

fn summary(plan: &Plan, records: &[RunRecord], out: &Path) -> String {
    let count = |wanted: &str| {
        records
            .iter()
            .filter(|record| record.outcome.word() == wanted)
            .count()
    };
    let mut runs = vec![format!("{} finished", count("finished"))];
    for word in ["diverged", "unsupported", "failed"] {
        if count(word) > 0 {
            runs.push(styled(BAD, &format!("{} {word}", count(word))));
        }
    }
    let cpu: f64 = records.iter().map(|record| record.cpu_s).sum();
    let row = |label: &str, value: String| vec![Cell::text(label), Cell::text(value)];
    let mut rows = vec![
        row("runs", runs.join(", ")),
        row("varied", plan.keys().collect::<Vec<_>>().join(", ")),
        row(
            "time",
            format!("{cpu:.1} s CPU for {:.3} s simulated", plan.duration_s()),
        ),
        row("results", out.join("results.csv").display().to_string()),
        row("report", out.join("index.html").display().to_string()),
    ];
    rows.retain(|row| row.len() == 2);
    format!("{}\n{}", styled(TITLE, &plan.sweep.name), lines(&rows))
}

/// The command that repeats this sweep.
fn typed(args: &SweepArgs) -> String {
    let mut command = format!(
        "pinwheel sweep {}",
        quoted(&args.file.display().to_string())
    );
    for set in &args.set {
        command.push_str(&format!(" --set {}", quoted(set)));
    }
    if !args.engines.is_empty() {
        command.push_str(&format!(" --engines {}", quoted(&args.engines.join(","))));
    }
    command
}

fn failure(error: SweepError) -> Failure {
    Failure::input(error.to_string())
}
