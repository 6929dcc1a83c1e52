//! `pinwheel compare`: one scene, several engines, one report.

use std::fs;
use std::time::{SystemTime, UNIX_EPOCH};

use pinwheel_compare::{
    Comparison, Context, Cost, Divergence, Energy, Participant, Status, compare_stated, limits,
};
use pinwheel_courses::Courses;
use pinwheel_engines::{Engine, EngineError, RunStats, recorded, registry};
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::Statement;
use pinwheel_gearbox::load_course;
use pinwheel_gearbox::scene::{Assumption, Scene, Start, assumptions};
use pinwheel_report::{Fact, ReportInput};
use pinwheel_studies::{StudyError, divergence};
use serde::Serialize;

use crate::animation;
use crate::args::{CompareArgs, quoted};
use crate::commands::{foreign, verdicts};
use crate::engines;
use crate::failure::{ENGINE, EXCEEDED, Failure};
use crate::folder::Folder;
use crate::interrupt;
use crate::machine::Machine;
use crate::progress::Progress;
use crate::record::{self, Ending};
use crate::screen;

/// `summary.json`: the comparison and what it was made from.
#[derive(Serialize)]
struct Summary<'a> {
    pinwheel_version: &'static str,
    command: &'a str,
    #[serde(flatten)]
    comparison: &'a Comparison,
    modelled: &'a [Statement],
    left_out: &'a [Statement],
    assumptions: &'a [Assumption],
    scene: &'a Scene,
    machine: &'a Machine,
}

pub(crate) fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let (scene, gearbox) = args.scene.load()?;
    let foreign = foreign::open(&args.foreign)?;
    let (scene, gearbox) = foreign::with_channels(&foreign, scene, gearbox)?;
    let asked_by_name = !args.engines.is_empty();
    let engines = chosen(&args.engines, &scene)?;
    let folder = Folder::prepare(&args.out.folder(&scene.name, "compare"), args.out.force)?;

    let mut participants = Vec::new();
    for (k, engine) in engines.iter().enumerate() {
        let label = format!("{} ({} of {})", engine.name(), k + 1, engines.len());
        participants.push(take_part(engine.as_ref(), &scene, &label, &folder)?);
    }
    let mut stated = Vec::new();
    for data in &foreign {
        let (participant, limits) = data.take_part(&scene, &participants)?;
        write_courses(&folder, &participant)?;
        participants.push(participant);
        stated.extend(limits);
    }

    let context = Context {
        divergence: divergence(&scene, &participants)?,
        ..context(&scene)
    };
    let comparison = compare_stated(&context, &participants, limits::TABLE, &stated)
        .map_err(|error| Failure::engine(format!("the courses cannot be compared: {error}")))?;
    write(args, &folder, &gearbox, &comparison, &participants)?;
    let out = folder.publish()?;
    screen::show(&verdicts::table(
        &scene,
        &comparison,
        &out.join("index.html"),
    ))?;

    let broken = participants
        .iter()
        .find(|participant| match participant.status {
            Status::Finished => false,
            // Left out with its reason, which is what one wants unless it was asked for.
            Status::Unsupported { .. } => asked_by_name,
            Status::Diverged { .. } | Status::Failed { .. } => true,
        });
    if let Some(participant) = broken {
        let remedy = match participant.status {
            Status::Diverged { .. } => "try a smaller solver.step_s or another solver.integrator",
            _ => "leave it out with --engines, or change the scene",
        };
        screen::complain(&format!(
            "{} {}; {remedy}",
            participant.name,
            participant.status.reason().unwrap_or_default()
        ));
        return Ok(ENGINE);
    }
    Ok(if comparison.counts.exceeded > 0 {
        EXCEEDED
    } else {
        0
    })
}

/// The columns of a foreign set as they are compared.
fn write_courses(folder: &Folder, participant: &Participant) -> Result<(), Failure> {
    let place = folder.path().join(&participant.name);
    fs::create_dir_all(&place).map_err(|error| Failure::unwritable(&place, &error))?;
    participant
        .courses
        .save_csv(&place.join("courses.csv"))
        .map_err(|error| Failure::unwritable(&place, &error))
}

/// The engines named, or all of this build and the recordings of those it lacks.
fn chosen(names: &[String], scene: &Scene) -> Result<Vec<Box<dyn Engine>>, Failure> {
    if names.is_empty() {
        let mut engines = registry();
        engines.extend(recorded::missing(scene));
        return Ok(engines);
    }
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    for name in names {
        let engine = engines::find_or_recorded(name.trim(), scene)?;
        if engines.iter().any(|other| other.name() == engine.name()) {
            return Err(Failure::input(format!(
                "--engines names {} twice; name each engine once",
                engine.name()
            )));
        }
        engines.push(engine);
    }
    Ok(engines)
}

/// Runs one engine, writes its courses, and makes a participant of it, however it ended.
fn take_part(
    engine: &dyn Engine,
    scene: &Scene,
    label: &str,
    folder: &Folder,
) -> Result<Participant, Failure> {
    let ran = match engine.supports(scene) {
        Ok(()) => engines::run(engine, scene, label)?,
        Err(error) => Err(error),
    };
    // A live engine that is missing here (no Python, no network) may have been recorded.
    if let Err(EngineError::Failed { reason, .. }) = &ran
        && let Some(recorded) = recorded::instead(engine.name(), scene, reason)
    {
        return take_part(recorded.as_ref(), scene, label, folder);
    }
    let nothing = || (Courses::default(), RunStats::default());
    let ((courses, stats), status) = match ran {
        Ok(run) => ((run.courses, run.stats), Status::Finished),
        Err(EngineError::Diverged {
            time_s,
            quantity,
            partial,
            ..
        }) => (
            (partial.courses, partial.stats),
            Status::Diverged { time_s, quantity },
        ),
        Err(EngineError::Unsupported { reason, .. }) => (nothing(), Status::Unsupported { reason }),
        Err(EngineError::Failed { reason, .. }) => (nothing(), Status::Failed { reason }),
        Err(EngineError::Cancelled) => return Err(Failure::stopped()),
    };
    let ending = match &status {
        Status::Finished => Some(Ending::Finished),
        Status::Diverged { time_s, quantity } => Some(Ending::Diverged {
            diverged_at_s: *time_s,
            diverged_quantity: quantity.clone(),
        }),
        Status::Unsupported { .. } | Status::Failed { .. } => None,
    };
    if let Some(ending) = ending {
        let place = folder.path().join(engine.name());
        fs::create_dir_all(&place).map_err(|error| {
            Failure::input(format!(
                "{}: cannot be made: {error}; choose another --out",
                place.display()
            ))
        })?;
        record::write(&place, engine, scene, ending, &courses, &stats)?;
    }
    Ok(Participant {
        name: engine.name().to_owned(),
        track: engine.track().as_str().to_owned(),
        version: engine.version(),
        summary: engine.summary().to_owned(),
        differences: engine.differences().to_owned(),
        courses,
        cost: cost(stats),
        status,
    })
}

fn cost(stats: RunStats) -> Cost {
    Cost {
        wall_s: stats.wall_s,
        cpu_s: stats.cpu_s,
        rhs_calls: stats.rhs_calls,
        steps: stats.steps,
        rejected_steps: stats.rejected_steps,
        degrees_of_freedom: stats.degrees_of_freedom,
        bodies: stats.bodies,
        step_s: stats.step_s,
        settings: stats.settings,
        notes: stats.notes,
        joint_drift_m: stats.joint_drift_m,
        recorded: stats.recorded,
        energy: stats
            .energy
            .iter()
            .map(|e| Energy {
                from_s: e.from_s,
                to_s: e.to_s,
                driver_j: e.driver_j,
                load_j: e.load_j,
                kinetic_j: e.kinetic_j,
                stored_j: e.stored_j,
                damping_j: e.damping_j,
                friction_j: e.friction_j,
                remainder_j: e.remainder_j,
                remainder_share: e.remainder_share,
            })
            .collect(),
    }
}

fn context(scene: &Scene) -> Context {
    Context {
        scene: scene.name.clone(),
        description: scene.description.clone(),
        duration_s: scene.solver.duration_s,
        load_n_m: Some(load_course::final_load(scene)),
        load_changes_s: load_course::breaks(&scene.drive),
        input_speed_rad_s: Some(scene.drive.input_speed_rad_s),
        friction_coefficient: scene.contact.friction_coefficient,
        settling_s: (scene.drive.start == Start::Equilibrium).then_some(0.0),
        guarded: guarded(scene),
        ..Context::default()
    }
}

/// The preset that the scene is, but for its name, its duration and what it writes, if the table of limits was
/// measured on it.
fn guarded(scene: &Scene) -> Option<String> {
    let same = |name: &&&str| {
        let Ok(preset) = Scene::load(name, &[]) else {
            return false;
        };
        let mut wanted = Scene {
            name: scene.name.clone(),
            description: scene.description.clone(),
            output: scene.output.clone(),
            ..preset
        };
        wanted.solver.duration_s = scene.solver.duration_s;
        wanted.solver.sample_s = scene.solver.sample_s;
        wanted == *scene
    };
    let found = limits::MEASURED_ON.iter().find(same);
    found.map(|name| (*name).to_owned())
}

/// Longest step of the two runs that differ by a rounding, s.
const DIVERGENCE_STEP: f64 = 5e-6;

/// What a rounding does to the scene; `None` where nothing is compared or it cannot be measured.
fn divergence(scene: &Scene, participants: &[Participant]) -> Result<Option<Divergence>, Failure> {
    if participants
        .iter()
        .filter(|p| p.status.is_finished())
        .count()
        < 2
    {
        return Ok(None);
    }
    let progress = Progress::new("divergence of a rounding", scene.solver.duration_s);
    let found = divergence::horizon(scene, DIVERGENCE_STEP, &mut |time_s| {
        progress.reached(time_s);
        interrupt::check().is_err()
    });
    progress.finish();
    match found {
        Ok(horizon) => Ok(Some(Divergence {
            horizon_s: horizon.horizon_s,
            largest_share: horizon.largest_share,
            told: horizon.sentence(),
        })),
        Err(StudyError::Cancelled) => Err(Failure::stopped()),
        // Another engine may honour a scene that the native one refuses.
        Err(_) => Ok(None),
    }
}

fn write(
    args: &CompareArgs,
    folder: &Folder,
    gearbox: &Gearbox,
    comparison: &Comparison,
    participants: &[Participant],
) -> Result<(), Failure> {
    let scene = &gearbox.scene;
    let model =
        pinwheel_gearbox::explain(scene).map_err(|error| Failure::input(error.to_string()))?;
    let (assumed, machine) = (assumptions(scene), Machine::here());
    let command = typed(args);
    let facts = |list: &[Statement]| list.iter().map(|s| Fact::new(&s.what, &s.why)).collect();
    let mut versions = vec![("pinwheel".to_owned(), env!("CARGO_PKG_VERSION").to_owned())];
    versions.extend(
        participants
            .iter()
            .map(|p| (p.name.clone(), p.version.clone())),
    );
    let page = pinwheel_report::render(&ReportInput {
        comparison,
        participants,
        animation: animation::of(scene)?,
        modelled: facts(&model.modelled),
        left_out: facts(&model.left_out),
        assumptions: assumed
            .iter()
            .map(|a| Fact::new(format!("{} = {}", a.key, a.value), &a.reason))
            .collect(),
        versions,
        machine: machine.rows(),
        command: command.clone(),
        scene_toml: scene.to_toml(),
        made: today(),
    })
    .map_err(|error| Failure::engine(format!("the report cannot be made: {error}")))?;
    record::write_text(&folder.path().join("index.html"), &page)?;
    record::write_json(
        &folder.path().join("summary.json"),
        &Summary {
            pinwheel_version: env!("CARGO_PKG_VERSION"),
            command: &command,
            comparison,
            modelled: &model.modelled,
            left_out: &model.left_out,
            assumptions: &assumed,
            scene,
            machine: &machine,
        },
    )
}

/// The command that repeats this comparison.
fn typed(args: &CompareArgs) -> String {
    let mut command = format!("pinwheel compare {}", args.scene.typed());
    if !args.engines.is_empty() {
        command.push_str(" --engines ");
        command.push_str(&quoted(&args.engines.join(",")));
    }
    command.push_str(&args.foreign.typed());
    command
}

/// Today's date, `2026-01-31`.
pub(crate) fn today() -> Option<String> {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .ok()
        .map(|since| date(since.as_secs()))
}

/// `2026-01-31` in UTC from seconds since 1970, by the Gregorian calendar's 400-year cycle of
/// 146 097 days counted from 1 March of the year 0, so that leap days come last.
fn date(seconds: u64) -> String {
    let days = seconds / 86_400 + 719_468;
    let (cycle, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 {
        (month + 3, 0)
    } else {
        (month - 9, 1)
    };
    format!("{:04}-{month:02}-{day:02}", 400 * cycle + year + next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates() {
        for (days, text) in [
            (0, "1970-01-01"),
            (11_016, "2000-02-29"),
            (11_017, "2000-03-01"),
            (19_782, "2024-02-29"),
            (20_088, "2024-12-31"),
            (20_089, "2025-01-01"),
        ] {
            assert_eq!(date(days * 86_400 + 86_399), text);
        }
    }
}
