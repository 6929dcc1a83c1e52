//! `pinwheel stability`: which method survives which hard scene, and at which step.

mod args;
mod csv;
mod damping;
mod judged;
mod maps;
mod page;
mod screen;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pinwheel_studies::survey::{Plan, Survey};
use pinwheel_studies::{Control, Progress, StudyError};
use serde::{Deserialize, Serialize};

pub(crate) use args::StabilityArgs;

use crate::args::quoted;
use crate::failure::{EXCEEDED, Failure, STOPPED};
use crate::folder::Folder;
use crate::interrupt;
use crate::machine::Machine;
use crate::record;
use crate::screen as terminal;

/// `summary.json`.
#[derive(Serialize)]
struct Summary<'a> {
    pinwheel_version: &'static str,
    command: &'a str,
    /// False after Ctrl-C: pieces that are not done are null.
    finished: bool,
    survey: &'a Survey,
    machine: &'a Machine,
}

/// What `--resume` needs of it.
#[derive(Deserialize)]
struct Earlier {
    survey: Survey,
}

pub(crate) fn stability(args: &StabilityArgs) -> Result<u8, Failure> {
    let plan = plan(args)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/stability"));
    let mut survey = if args.resume {
        earlier(&out, plan)?
    } else {
        Survey::new(plan)
    };
    let folder = Folder::prepare(&out, args.force)?;
    let stopped = work(&mut survey, args)?;
    if stopped && survey.done().0 == 0 {
        return Err(Failure::stopped());
    }

    let (command, machine) = (typed(args), Machine::here());
    let place = |name: &str| folder.path().join(name);
    record::write_text(
        &place("index.html"),
        &page::page(&survey, &command, &machine)?,
    )?;
    record::write_text(&place("stability.csv"), &csv::lines(&survey)?)?;
    record::write_json(
        &place("summary.json"),
        &Summary {
            pinwheel_version: env!("CARGO_PKG_VERSION"),
            command: &command,
            finished: !stopped,
            survey: &survey,
            machine: &machine,
        },
    )?;
    if stopped {
        let out = folder.publish_unfinished()?;
        let (done, all) = survey.done();
        terminal::complain(&format!(
            "stopped; {done} of {all} pieces are in {}; `{command} --resume` does the rest",
            out.display()
        ));
        return Ok(STOPPED);
    }
    let out = folder.publish()?;
    terminal::show(&screen::table(&survey, &out.join("index.html")))?;
    let unserved = judged::unserved(&survey);
    if unserved.is_empty() {
        return Ok(0);
    }
    terminal::complain(&format!(
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

/// The survey that was stopped in `out`.
fn earlier(out: &Path, plan: Plan) -> Result<Survey, Failure> {
    let place = out.join("summary.json");
    let refuse = |what: String| {
        Failure::input(format!(
            "--resume: {}: {what}; leave out --resume to begin anew",
            place.display()
        ))
    };
    let text =
        fs::read_to_string(&place).map_err(|error| refuse(format!("cannot be read: {error}")))?;
    let Earlier { survey } = serde_json::from_str(&text)
        .map_err(|error| refuse(format!("holds no study to go on with: {error}")))?;
    if survey.plan != plan || !survey.is_whole() {
        return Err(refuse(
            "was made with other scenes, another length or another version".to_owned(),
        ));
    }
    Ok(survey)
}

/// Does what is open; true if the user stopped it.
fn work(survey: &mut Survey, args: &StabilityArgs) -> Result<bool, Failure> {
    interrupt::check()?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = args.jobs.map_or(cores, usize::from);
    let (done, total) = survey.done();
    let bar = ProgressBar::new(total as u64);
    bar.set_position(done as u64);
    let template = "[{bar:30}] {pos} of {len}, {elapsed} gone, {eta} left: {msg}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.enable_steady_tick(std::time::Duration::from_secs(1));
    let shown = Mutex::new(&bar);
    let progress = |p: Progress<'_>| {
        if let Ok(bar) = shown.lock() {
            bar.set_position(p.done as u64);
            bar.set_message(p.piece.to_owned());
        }
    };
    let outcome = survey.go_on(
        jobs,
        &Control {
            cancel: interrupt::flag(),
            progress: &progress,
        },
    );
    bar.finish_and_clear();
    match outcome {
        Ok(()) => Ok(false),
        Err(StudyError::Cancelled) => Ok(true),
        Err(StudyError::Load(error)) => Err(Failure::from(error)),
        Err(error @ StudyError::Scene { .. }) => Err(Failure::input(error.to_string())),
        Err(error) => Err(Failure::engine(format!("the study failed: {error}"))),
    }
}

/// The command that repeats this study.
fn typed(args: &StabilityArgs) -> String {
    let mut command = "pinwheel stability".to_owned();
    for scene in &args.scenes {
        command.push(' ');
        command.push_str(&quoted(scene));
    }
    if args.quick {
        command.push_str(" --quick");
    }
    if let Some(out) = &args.out {
        command.push_str(" --out ");
        command.push_str(&quoted(&out.display().to_string()));
    }
    command
}
