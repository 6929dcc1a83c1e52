//! Cost of accuracy: every engine, integrator and step (or tolerance) of one scene against a converged run.
//!
//! [`run`] returns a [`WorkPrecision`]: the reference with its own error; a [`Series`] for each engine and method, with a
//! [`Point`] for each setting (errors by window, CPU time, right-hand-side calls); and the cost of a given error for each
//! ([`WorkPrecision::ranking`]).

pub(crate) mod front;
pub(crate) mod norms;
mod options;
pub(crate) mod ranking;
mod series;
pub(crate) mod settings;
mod table;

pub use front::CostAt;
pub use norms::{Errors, Span};
use norms::{errors, spans};
pub use options::Options;
pub use ranking::{Advantage, Entry, Ranking};
use series::Setup;
pub use series::{Cost, Measure, Point, Series};
pub use settings::Stopped;

use std::path::Path;

use pinwheel_engines::{Engine, SharedModel, by_name, registry};
use pinwheel_mbs::integrators::METHODS;
use pinwheel_scene::Scene;
use serde::Serialize;

use crate::control::{Control, Progress, compile};
use crate::output::{OutputError, write_with};
use crate::provenance::{Provenance, Summary};
use crate::reference::{self, Reference};
use crate::{StudyError, choice};

/// Result of the bench.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorkPrecision {
    /// Scene of the runs.
    #[serde(skip)]
    pub scene: Scene,
    /// Choices of the bench.
    pub options: Options,
    /// Windows, in the order of all lists of errors. The first is the entire run.
    pub windows: Vec<Span>,
    /// Reference from which all errors are measured.
    pub reference: Reference,
    /// Distance of the reference's second run in each window: an upper estimate of its error.
    pub reference_errors: Vec<Errors>,
    /// Series of each engine and method, native first.
    pub series: Vec<Series>,
    /// Names of the engines, with their differences from the native solver.
    #[serde(skip)]
    pub differences: Vec<(String, String)>,
    /// False if the user stopped the study; results so far are kept.
    pub complete: bool,
}

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Measured<'a> {
    /// False if the user stopped the measurement.
    complete: bool,
    scene: &'a Scene,
    work_precision: &'a WorkPrecision,
    /// Costs of errors in each window.
    rankings: &'a [Ranking],
}

impl WorkPrecision {
    /// Returns the rankings of all windows at the target, then of the entire run at ten times and a tenth of it.
    pub fn rankings(&self) -> Vec<Ranking> {
        let target = self.options.target;
        let windows = 0..self.windows.len();
        let at_target = windows.map(|window| self.ranking(window, target));
        let decades = [10.0 * target, target / 10.0].map(|error| self.ranking(0, error));
        at_target.chain(decades).collect()
    }

    /// Writes `summary.json` and `bench.csv` into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, origin: &Provenance) -> Result<(), OutputError> {
        write_with(dir, "bench.csv", |sink| self.table().write_csv(sink))?;
        let measured = Measured {
            complete: self.complete,
            scene: &self.scene,
            work_precision: self,
            rankings: &self.rankings(),
        };
        Summary::new(origin, measured).write(dir)
    }
}

/// Returns the engines by name (`native` for both formulations); without names both native formulations and the peers that
/// solve the same equations.
///
/// # Errors
/// Unknown engine, or one that chooses its own integrator and step.
pub fn engines(names: &[String], scene: &Scene) -> Result<Vec<Box<dyn Engine>>, StudyError> {
    let native = ["native-reduced", "native-lagrange"];
    if names.is_empty() {
        let friction = scene.contact.friction_coefficient > 0.0;
        let mut engines = registry();
        engines.retain(|engine| match engine.track() {
            SharedModel::Native => native.contains(&engine.name()),
            SharedModel::SharedLaw => true,
            SharedModel::OwnContact => friction || engine.info().outside,
            SharedModel::Measured => false,
        });
        return Ok(engines);
    }
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        let named: Vec<Box<dyn Engine>> = match name {
            "native" => native
                .iter()
                .filter_map(|form| by_name(form, scene))
                .collect(),
            _ => vec![choice::find(name, scene)?],
        };
        for engine in named {
            if engine.track() == SharedModel::Native && !native.contains(&engine.name()) {
                return Err(StudyError::Input(format!(
                    "{} chooses its own integrator and step, which this study varies; name native, native-reduced \
                     or native-lagrange",
                    engine.name()
                )));
            }
            if engines.iter().all(|other| other.name() != engine.name()) {
                engines.push(engine);
            }
        }
    }
    Ok(engines)
}

/// Runs the study. `engines` must not include the resolved native form, whose settings are not the scene's.
///
/// # Errors
/// Cancelled before the reference was complete, or a failed reference run. Faults of an engine are in its series.
pub fn run(
    scene: &Scene,
    engines: &[Box<dyn Engine>],
    options: &Options,
    control: &Control<'_>,
) -> Result<WorkPrecision, StudyError> {
    let tasks = engines.iter();
    let tasks = tasks.flat_map(|engine| methods(engine.as_ref(), options));
    let tasks: Vec<_> = tasks.collect();
    let total = tasks.len() + 2;
    let mut done = 0;
    // One run does not indicate the remaining time of the study.
    let quiet = Control::silent(control.cancel);
    let (reference, [time_series, second]) = reference::run(scene, 1.0, &quiet, &mut |piece| {
        (control.progress)(Progress::new(done, total, piece));
        done += 1;
    })?;
    let windows = spans(scene, &time_series);
    let least = compile(scene)?.least_loads();
    let error = |span| errors(&second, &time_series, span, least);
    let reference_errors: Vec<Errors> = windows.iter().map(error).collect();
    let setup = Setup {
        scene,
        options,
        reference: &time_series,
        windows: &windows,
        least,
        reference_error: reference_errors[0].force_l2,
        control: &quiet,
    };
    let mut all = Vec::new();
    for by in tasks {
        if control.is_cancelled() {
            break;
        }
        let mut announce = |piece: &str| (control.progress)(Progress::new(done, total, piece));
        all.push(setup.series(by, &mut announce)?);
        done += 1;
    }
    let differences = engines.iter().map(|engine| {
        let info = engine.info();
        (info.name.to_owned(), info.differences.to_owned())
    });
    Ok(WorkPrecision {
        scene: scene.clone(),
        options: options.clone(),
        windows,
        reference,
        reference_errors,
        series: all,
        differences: differences.collect(),
        complete: !control.is_cancelled(),
    })
}

/// Returns the methods of an engine: Pinwheel's for the native forms, its own for others.
fn methods<'a>(
    engine: &'a dyn Engine,
    options: &'a Options,
) -> Vec<(&'a dyn Engine, Option<&'a str>)> {
    if engine.track() != SharedModel::Native {
        return vec![(engine, None)];
    }
    let asked = &options.methods;
    let names = METHODS.iter().map(|method| method.name);
    let names = names.filter(|name| asked.is_empty() || asked.iter().any(|one| one == name));
    names.map(|name| (engine, Some(name))).collect()
}
