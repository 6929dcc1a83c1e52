//! `pinwheel run`: one scene, one engine.

use pinwheel_engines::EngineError;

use crate::args::RunArgs;
use crate::engines;
use crate::failure::{ENGINE, Failure};
use crate::folder::Folder;
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
    record::write(
        folder.path(),
        engine.as_ref(),
        &scene,
        ending.clone(),
        &run.courses,
        &run.stats,
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
    rows.extend(stats.notes.iter().map(|note| row("note", note.clone())));
    rows.push(row(
        "courses",
        out.join("courses.csv").display().to_string(),
    ));
    screen::show(&format!("{}\n{}", styled(TITLE, &scene.name), lines(&rows)))?;
    Ok(0)
}

fn row(label: &str, value: String) -> Vec<Cell> {
    vec![Cell::text(label), Cell::text(value)]
}
