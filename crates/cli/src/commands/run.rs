//! `pinwheel run`: one scene, one engine.

use pinwheel_courses::Courses;
use pinwheel_engines::{Engine, EngineError, Track};
use pinwheel_scene::{CheckedScene, Formulation};
use pinwheel_studies::StudyError;
use pinwheel_studies::resolution::{self, Resolution};

use crate::args::RunArgs;
use crate::engines;
use crate::failure::{ENGINE, EXCEEDED, Failure};
use crate::folder::Folder;
use crate::interrupt;
use crate::progress::Progress;
use crate::record::{self, Ending};
use crate::screen::{self, TITLE, styled};
use crate::table::{Cell, lines};

pub(crate) fn run(args: &RunArgs) -> Result<u8, Failure> {
    let (scene, _) = args.scene.load()?;
    let engine = engines::find(&args.engine, &scene)?;
    engine.supports(&scene).map_err(|error| {
        Failure::engine(format!(
            "{error}; choose another engine (`pinwheel engines`) or change the scene"
        ))
    })?;
    let folder = Folder::prepare(&args.out.folder(&scene.name, "run"), args.out.force)?;

    let (run, ending) = match engines::run(engine.as_ref(), &scene, engine.name())? {
        Ok(run) => (run, Ending::Finished),
        Err(EngineError::Diverged {
            time_s,
            quantity,
            partial,
            ..
        }) => (
            *partial,
            Ending::Diverged {
                diverged_at_s: time_s,
                diverged_quantity: quantity,
            },
        ),
        Err(error) => {
            return Err(Failure::engine(format!(
                "{error}; nothing was written; see `pinwheel engines` for others"
            )));
        }
    };
    let resolution = if ending == Ending::Finished && !args.unchecked {
        check(engine.as_ref(), &scene, &run.courses)?
    } else {
        None
    };
    record::write_checked(
        folder.path(),
        engine.as_ref(),
        &scene,
        ending.clone(),
        &run.courses,
        &run.stats,
        resolution.as_ref(),
    )?;
    let out = folder.publish()?;

    if let Ending::Diverged {
        diverged_at_s,
        diverged_quantity,
    } = ending
    {
        screen::complain(&format!(
            "{} diverged at t = {diverged_at_s:.6} s: {diverged_quantity}; what there is until then is in {}; try a smaller solver.step_s or another solver.integrator",
            engine.name(),
            out.join("courses.partial.csv").display()
        ));
        return Ok(ENGINE);
    }
    let stats = &run.stats;
    let mut rows = vec![
        row(
            "engine",
            format!(
                "{} {} ({})",
                engine.name(),
                engine.version(),
                engine.track().as_str()
            ),
        ),
        row("settings", stats.settings.clone()),
        row(
            "samples",
            format!("{}, to {} s", run.courses.len(), scene.solver.duration_s),
        ),
        row(
            "time",
            format!("{:.3} s wall, {:.3} s CPU", stats.wall_s, stats.cpu_s),
        ),
        row(
            "steps",
            format!("{}, {} contact evaluations", stats.steps, stats.rhs_calls),
        ),
        row(
            "freedom",
            format!("{} velocities integrated", stats.degrees_of_freedom),
        ),
    ];
    if let Some(resolution) = &resolution {
        rows.push(row("resolution", resolution.sentence()));
    }
    rows.extend(stats.notes.iter().map(|note| row("note", note.clone())));
    rows.push(row(
        "courses",
        out.join("courses.csv").display().to_string(),
    ));
    screen::show(&format!("{}\n{}", styled(TITLE, &scene.name), lines(&rows)))?;
    if let Some(resolution) = resolution.filter(|resolution| !resolution.holds()) {
        screen::complain(&format!(
            "the step does not resolve this scene: {}; make solver.step_s or solver.tolerance smaller, or set solver.integrator to \"auto\"",
            resolution.sentence()
        ));
        return Ok(EXCEEDED);
    }
    Ok(0)
}

/// What a native run shows at twice its step. The resolved engine has no step of the scene's.
fn check(
    engine: &dyn Engine,
    scene: &CheckedScene,
    courses: &Courses,
) -> Result<Option<Resolution>, Failure> {
    let mut scene = scene.clone().into_scene();
    scene.solver.formulation = match engine.name() {
        "native-reduced" => Formulation::Reduced,
        "native-lagrange" => Formulation::Lagrange,
        _ => return Ok(None),
    };
    debug_assert_eq!(engine.track(), Track::Native);
    let label = format!("{} once more, coarser", engine.name());
    let progress = Progress::new(label, scene.solver.duration_s);
    let found = resolution::check(&scene, courses, &mut |time_s| {
        progress.reached(time_s);
        interrupt::check().is_err()
    });
    progress.finish();
    match found {
        Ok(found) => Ok(Some(found)),
        Err(StudyError::Cancelled) => Err(Failure::stopped()),
        Err(error) => Err(Failure::engine(format!(
            "the run cannot be repeated at twice its step: {error}; --unchecked leaves that out"
        ))),
    }
}

fn row(label: &str, value: String) -> Vec<Cell> {
    vec![Cell::text(label), Cell::text(value)]
}
