//! `pinwheel compare`: one scene, several engines, one report; or two scenes, one engine.

use std::io::Write as _;
use std::sync::Arc;

use pinwheel::compare::Divergence;
use pinwheel::engines::kept::Store;
use pinwheel::engines::process::{self, End};
use pinwheel::gearbox::Gearbox;
use pinwheel::pages;
use pinwheel::scene::CheckedScene;
use pinwheel::studies::comparison::{self, Effort, Input, Lanes, foreign};
use pinwheel::studies::{Control, Progress, StudyError, choice, design_diff, junit};

use super::idle;
use crate::args::{self, CompareArgs, SceneArgs};
use crate::failure::{Failure, STOPPED};
use crate::folder::{Folder, check_junit};
use crate::progress::watched;
use crate::{interrupt, screen, words};

pub(crate) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let gearbox = args.scene.load()?;
    if let Some(other) = &args.other {
        return designs(args, &gearbox, other);
    }
    let data = foreign::open_all(&args.foreign.against, &args.foreign.map)?;
    let gearbox = foreign::with_channels(&data, gearbox)?;
    let scene = &gearbox.scene;
    let asked_by_name = !args.engines.is_empty();
    let store = comparison::store(args.fresh).unwrap_or_else(|error| {
        screen::warn(&format!("runs are not kept: {error}"));
        None
    });
    let effort = effort(args, &args.scene.scene, scene)?;
    if let (Some(ahead), Some(store)) = (&args.ahead, &store) {
        return keep(store, ahead, &gearbox, effort);
    }
    let mut engines = choice::engines(&args.solvers.join_named(&args.engines)?, scene)?;
    if let Some(store) = &store {
        engines = store.around(engines);
    }
    let folder = Folder::of_scenes(&args.out, &[&args.scene.scene], "compare")?;
    check_junit(args.junit.as_deref(), folder.place())?;

    let input = Input {
        gearbox: &gearbox,
        engines: &engines,
        data: &data,
    };
    let ahead: comparison::Ahead<'_> = &elsewhere;
    let lanes = Lanes {
        jobs: args.jobs.map_or_else(args::cores, usize::from),
        store: store.as_deref(),
        ahead: Some(ahead),
    };
    let outcome = watched(|control| comparison::run_on(&input, effort, &lanes, control));
    for line in store.iter().flat_map(|store| store.messages()) {
        screen::warn(&line);
    }
    let mut outcome = outcome.map_err(|error| stopped(error, store.as_deref(), args.fresh))?;
    // An engine that was asked for by name and is left out ends in an error.
    outcome.comparison.passed &= outcome.broken(asked_by_name).is_none();
    let origin = folder.write(|dir, origin| outcome.write(dir, origin))?;
    let page = pages::comparison::page(&outcome, &origin);
    let mut text = pages::comparison::text(scene, &outcome);
    if screen::manner().verbose {
        text.push('\n');
        text.push_str(&pages::comparison::details(&outcome));
    }
    screen::answer(pages::comparison::verdict(&outcome));
    folder.show(&page, &text)?;
    if let Some(path) = &args.junit {
        let suites = junit::of_comparison(&outcome.comparison);
        junit::write(path, "pinwheel compare", suites)?;
    }
    name_idle(&args.scene, &gearbox)?;

    match outcome.broken(asked_by_name) {
        Some(broken) => Err(Failure::engine(broken)),
        None => Ok(outcome.exit_status()),
    }
}

/// Returns the failure of a comparison; after a stop, the message names the command that continues it.
fn stopped(error: StudyError, store: Option<&Store>, fresh: bool) -> Failure {
    let stored = store.map_or(0, Store::added);
    match error {
        StudyError::Cancelled if stored > 0 => {
            let without = if fresh { " without --fresh" } else { "" };
            let kept = format!(
                "stopped; {stored} runs are kept: the same command{without} goes on with them"
            );
            Failure::new(STOPPED, kept)
        }
        error => error.into(),
    }
}

/// Stores the runs of an engine for the comparing process, and sends it the remaining time, s, a line each.
fn keep(store: &Arc<Store>, ahead: &str, gearbox: &Gearbox, effort: Effort) -> Result<u8, Failure> {
    let (name, divergence) = ahead.split_once(' ').unwrap_or((ahead, ""));
    let divergence: Option<Divergence> = serde_json::from_str(divergence).unwrap_or_default();
    let engines = store.around(vec![choice::find(name, &gearbox.scene)?]);
    let tell = |at: Progress<'_>| {
        if let Some(left) = at.left_s {
            // There may be no reader.
            let _ = writeln!(std::io::stdout().lock(), "{left}");
        }
    };
    interrupt::watched();
    let control = Control::new(interrupt::flag(), &tell);
    comparison::ahead(engines[0].as_ref(), gearbox, divergence, effort, &control)?;
    Ok(0)
}

/// Runs [`keep`] in another process. This process runs all that is not stored afterwards.
fn elsewhere(name: &str, divergence: Option<&Divergence>, control: &Control<'_>) {
    let divergence = serde_json::to_string(&divergence).unwrap_or_default();
    let Some(mut command) = words::again() else {
        return;
    };
    command.args(["--ahead", &format!("{name} {divergence}")]);
    let _ = process::run(&mut command, None, &mut |piece| {
        let output = piece.filter(|piece| !piece.stderr);
        let output = output.map(|piece| String::from_utf8_lossy(&piece.bytes).into_owned());
        // Without a new time the one that is shown still has to fall.
        (control.progress)(Progress {
            left_s: output.and_then(|output| output.lines().last()?.parse().ok()),
            ..Progress::new(0, 1, name)
        });
        control.is_cancelled().then_some(End::Cancelled)
    });
}

/// Reports model settings without effect: a native run without them is equal to the bit. Solver settings are excluded,
/// because other engines may read them.
fn name_idle(args: &SceneArgs, gearbox: &Gearbox) -> Result<(), Failure> {
    let is_model = |set: &String| !set.starts_with("solver.");
    if !args.set.iter().any(is_model) {
        return Ok(());
    }
    let engine = choice::find("native-reduced", &gearbox.scene)?;
    let of = "the native time series of this scene";
    idle::name(args, gearbox, of, |settings, control| {
        let mut idle = settings.idle(engine.as_ref(), control)?;
        idle.retain(|place| is_model(&args.set[*place]));
        Ok(idle)
    })
}

/// Compares two designs by one engine.
fn designs(args: &CompareArgs, first: &Gearbox, other: &str) -> Result<u8, Failure> {
    let second = args.scene.load_as(other)?;
    let gearboxes = [first, &second];
    let specs = [args.scene.scene.as_str(), other];
    let name = args.solvers.only(&args.engines)?;
    let engine = choice::find(&name, &first.scene)?;
    let [a, b] = [0, 1].map(|k| effort(args, specs[k], &gearboxes[k].scene));
    let folder = Folder::of_scenes(&args.out, &specs, "compare")?;
    let input = design_diff::Input {
        gearboxes,
        specs,
        engine: engine.as_ref(),
        efforts: [a?, b?],
    };
    let diff = watched(|control| design_diff::run(&input, control))?;
    let origin = folder.write(|dir, origin| diff.write(dir, origin))?;
    let page = pages::design_diff::page(&diff, &origin);
    folder.show(&page, &pages::design_diff::text(&diff))?;
    if let Some((name, reason)) = diff.broken() {
        return Err(Failure::engine(format!(
            "{name} {reason}; try a smaller solver.step_s or another solver.integrator"
        )));
    }
    Ok(0)
}

fn effort(args: &CompareArgs, spec: &str, scene: &CheckedScene) -> Result<Effort, Failure> {
    let (sets, longest) = (args::overrides(&args.scene.set)?, args.longest);
    Ok(Effort::asked(scene, spec, &sets, longest, args.resolution)?)
}
