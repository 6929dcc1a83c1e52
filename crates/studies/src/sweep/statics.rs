//! Statics as an engine of sweeps: no time series, but figures of `pinwheel design` by their keys.

use std::time::Instant;

use cpu_time::ThreadTime;
use pinwheel_compare::quantities::label_and_unit;
use pinwheel_engines::{
    Cancelled, Control, Ending, Engine, EngineInfo, Halt, Prepared, Run, RunStats, SharedModel,
};
use pinwheel_gearbox::Gearbox;
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::figure::{Figure, FigureDef, definitions as defs};

use crate::StudyError;
use crate::balances::poses::Poses;
use crate::balances::solve::at_poses;
use crate::control::of_scene;

/// Name of the engine in sweeps.
pub const STATICS: &str = "statics";

/// Figures of a design in the results, each with its statistic over the mesh; empty for the figure itself.
const FIGURES: [(&str, &FigureDef); 12] = [
    ("", &defs::LOST_MOTION),
    ("mean", &defs::LOST_MOTION),
    ("", &defs::STIFFNESS),
    ("least", &defs::STIFFNESS),
    ("", &defs::ERROR_RATED),
    ("", &defs::ERROR_NO_LOAD),
    ("", &defs::EXTERNAL_FORCE),
    ("", &defs::INTERNAL_FORCE),
    ("", &defs::CRANK_FORCE),
    ("", &defs::EXTERNAL_PRESSURE),
    ("", &defs::INTERNAL_PRESSURE),
    ("", &defs::BEARING_FORCE),
];

/// Returns the definitions of the columns.
pub(super) fn columns() -> impl Iterator<Item = FigureDef> {
    FIGURES.into_iter().map(|(statistic, def)| match statistic {
        "" => def.clone(),
        _ => FigureDef {
            key: format!("{statistic}_{}", def.key).into(),
            label: format!("{}, {statistic}", def.label).into(),
            ..def.clone()
        },
    })
}

/// Returns the definition of a column of the results: the design figure's for statics, otherwise from the column's name.
pub fn definition(column: &str) -> FigureDef {
    let balanced = columns().find(|def| def.key == column);
    balanced.unwrap_or_else(|| {
        let (label, unit) = label_and_unit(column);
        FigureDef::named(column.to_owned(), label, unit)
    })
}

/// Returns the figures of a design for the columns.
fn figures(all: &[Figure]) -> Vec<Figure> {
    let figure = |(column, (statistic, def)): (FigureDef, (&str, &FigureDef))| {
        let figure = all.iter().find(|figure| figure.is(def))?;
        let mesh = figure.over_mesh;
        Some(match statistic {
            "mean" => column.of(mesh.map(|mesh| mesh.mean), None),
            "least" => column.of(mesh.map(|mesh| mesh.ends[0]), None),
            _ => figure.clone(),
        })
    };
    columns().zip(FIGURES).filter_map(figure).collect()
}

/// Engine that solves equilibria instead of a run.
pub(super) struct Statics;

impl Engine for Statics {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            differences: "No motion: inertia and damping have no part, and friction in the forces alone.",
            summary: "balances at rest over one period of the mesh; for sweeps alone",
            ..EngineInfo::own(STATICS, SharedModel::Native)
        }
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let gearbox = gearbox.clone();
        Ok(Box::new(move |control: &Control<'_>| {
            let (wall, cpu) = (Instant::now(), ThreadTime::now());
            let ended = |error| match error {
                StudyError::Cancelled => Halt::from(Cancelled),
                error => Ending::unsupported(error).into(),
            };
            let solver = pinwheel_gearbox::statics::Statics::new(&gearbox);
            let mut solver = solver.map_err(|source| ended(of_scene(&gearbox.scene, source)))?;
            let poses = Poses::of(&gearbox.scene).resolving();
            let solved = at_poses(&mut solver, (&poses, true), control.cancel).map_err(ended)?;
            let all = figures(&solved.figures());
            let stats = RunStats {
                wall_s: wall.elapsed().as_secs_f64(),
                cpu_s: cpu.elapsed().as_secs_f64(),
                settings: "balances".to_owned(),
                steps: solver.balances()[0],
                rhs_calls: solver.evaluations(),
                notes: solved.preloaded().into_iter().collect(),
                ..RunStats::default()
            };
            let mut run = Run::new(TimeSeries::default(), stats);
            run.figures = all;
            Ok(run)
        }))
    }
}
