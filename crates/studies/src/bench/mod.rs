//! Cost of accuracy: every engine, integrator and step (or tolerance) of one scene against a converged run.
//!
//! [`run`] gives a [`WorkPrecision`]: the reference with its own error, one [`Series`] an engine and method
//! with a [`Point`] a setting (errors by window, CPU time, right-hand-side calls), and what a given
//! error costs each ([`WorkPrecision::ranking`]).

mod front;
mod norms;
mod ranking;
mod series;
mod settings;
mod table;

pub use front::CostAt;
pub use norms::{Errors, Span};
use norms::{errors, spans};
pub use ranking::{Advantage, Entry, Ranking};
pub use series::{Cost, Measure, Point, Series};
pub use settings::Stopped;

use std::path::Path;
use std::sync::atomic::Ordering;

use pinwheel_engines::{Engine, SharedModel, by_name, registry};
use pinwheel_mbs::integrators::METHODS;
use pinwheel_scene::{Scene, did_you_mean};
use serde::Serialize;

use crate::control::{Control, Progress, compile};
use crate::output::{OutputError, write_with};
use crate::provenance::{Provenance, Summary};
use crate::reference::{self, Reference};
use crate::{StudyError, choice};

/// Choices of a bench.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Relative L2 force error over the whole run at which engines are ranked.
    pub target: f64,
    /// Runs of one setting at most; the cost is their minimum and median.
    pub repeats: usize,
    /// CPU time at which a setting is no longer repeated for its own sake, s.
    pub repeat_s: f64,
    /// A foreign engine's single run takes no longer than this, s CPU.
    pub longest_s: f64,
    /// Limit of the native solver's single run, s CPU. It has many more series than a foreign engine.
    pub longest_native_s: f64,
    /// Integrators of the native solver; empty: all.
    pub methods: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            target: 1e-4,
            repeats: 5,
            repeat_s: 1.0,
            longest_s: 20.0,
            longest_native_s: 2.0,
            methods: Vec::new(),
        }
    }
}

impl Options {
    /// Options that a user chooses: the error at which engines are ranked, runs of a setting, CPU seconds of a peer's
    /// run, of which the native solver gets a tenth, and integrators.
    ///
    /// # Errors
    /// A number that measures nothing, or an integrator that is not there.
    pub fn asked(
        target: f64,
        repeats: usize,
        longest_s: f64,
        methods: Vec<String>,
    ) -> Result<Self, StudyError> {
        for (name, value) in [("target", target), ("longest", longest_s)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(StudyError::Input(format!(
                    "{name}: {value} is not a positive number; leave it out for the default"
                )));
            }
        }
        if repeats == 0 {
            return Err(StudyError::Input(
                "repeats: 0 measures nothing; use 1 or more".to_owned(),
            ));
        }
        let known = method_names();
        if let Some(name) = methods.iter().find(|name| !known.contains(&name.as_str())) {
            let remedy = did_you_mean(name, &known);
            let what = format!("there is no integrator `{name}`; {remedy}");
            return Err(StudyError::Input(what));
        }
        Ok(Self {
            target,
            repeats,
            longest_s,
            longest_native_s: 0.1 * longest_s,
            methods,
            ..Self::default()
        })
    }

    /// How long a single run of an engine may take, s CPU.
    #[must_use]
    pub fn longest(&self, track: SharedModel) -> f64 {
        match track {
            SharedModel::Native => self.longest_native_s,
            SharedModel::SharedLaw | SharedModel::OwnContact | SharedModel::Measured => {
                self.longest_s
            }
        }
    }
}

/// The study's result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorkPrecision {
    /// The scene.
    #[serde(skip)]
    pub scene: Scene,
    /// Choices of the bench.
    pub options: Options,
    /// Windows; errors stand in this order everywhere. The first is the whole run.
    pub windows: Vec<Span>,
    /// Reference from which all errors are measured.
    pub reference: Reference,
    /// Distance of its second run, window by window: an upper estimate of its error.
    pub reference_errors: Vec<Errors>,
    /// One engine and method each, native first.
    pub series: Vec<Series>,
    /// Names of the engines, and what each is unlike.
    #[serde(skip)]
    pub differences: Vec<(String, String)>,
    /// False if the user stopped the study; what had been measured until then is kept.
    pub complete: bool,
}

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Measured<'a> {
    /// False if the user stopped the measurement.
    complete: bool,
    scene: &'a Scene,
    work_precision: &'a WorkPrecision,
    /// Costs of errors, window by window.
    rankings: &'a [Ranking],
}

impl WorkPrecision {
    /// Rankings of all windows at the target, then of the whole run at ten times and a tenth of it.
    #[must_use]
    pub fn rankings(&self) -> Vec<Ranking> {
        let target = self.options.target;
        let windows = 0..self.windows.len();
        let at_target = windows.map(|window| self.ranking(window, target));
        let whole = [10.0 * target, target / 10.0].map(|error| self.ranking(0, error));
        at_target.chain(whole).collect()
    }

    /// Writes `summary.json` and `bench.csv` into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, made: &Provenance) -> Result<(), OutputError> {
        write_with(dir, "bench.csv", |sink| self.table().write_csv(sink))?;
        let measured = Measured {
            complete: self.complete,
            scene: &self.scene,
            work_precision: self,
            rankings: &self.rankings(),
        };
        Summary::new(made, measured).write(dir)
    }
}

/// The engines named (`native` stands for both its forms); without names both native forms and the peers that solve
/// the same equations.
///
/// # Errors
/// An engine that there is not, or that chooses its own integrator and step.
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
    let mut add = |engine: Box<dyn Engine>| {
        if engine.track() == SharedModel::Native && !native.contains(&engine.name()) {
            return Err(StudyError::Input(format!(
                "{} chooses its own integrator and step, which is what is varied here; name native, native-reduced \
                 or native-lagrange",
                engine.name()
            )));
        }
        if engines.iter().all(|other| other.name() != engine.name()) {
            engines.push(engine);
        }
        Ok(())
    };
    for name in names {
        if name.trim() == "native" {
            for engine in native.iter().filter_map(|form| by_name(form, scene)) {
                add(engine)?;
            }
        } else {
            add(choice::find(name.trim(), scene)?)?;
        }
    }
    Ok(engines)
}

/// Runs the study. `engines` without the resolved native form, whose settings are not the scene's.
///
/// # Errors
/// Cancelled before the reference was there, or the reference run fails. What an engine does wrong
/// stands in its series.
pub fn run(
    scene: &Scene,
    engines: &[Box<dyn Engine>],
    options: &Options,
    control: &Control<'_>,
) -> Result<WorkPrecision, StudyError> {
    let each = engines.iter();
    let tasks = each.flat_map(|engine| methods(engine.as_ref(), options));
    let tasks: Vec<(&dyn Engine, Option<&str>)> = tasks.collect();
    let total = tasks.len() + 2;
    let mut done = 0;
    let (reference, [time_series, second]) = reference::run(scene, control, &mut |piece| {
        (control.progress)(Progress::new(done, total, piece));
        done += 1;
    })?;
    let windows = spans(scene, &time_series);
    let least = compile(scene)?.least_loads();
    let error = |span| errors(&second, &time_series, span, least);
    let reference_errors: Vec<Errors> = windows.iter().map(error).collect();
    let mut all = Vec::new();
    for (engine, method) in tasks {
        if control.cancel.load(Ordering::Relaxed) {
            break;
        }
        let mut announce = |piece: &str| (control.progress)(Progress::new(done, total, piece));
        let truth = series::Truth {
            time_series: &time_series,
            windows: &windows,
            least,
            error: reference_errors[0].force_l2,
        };
        let by = (engine, method);
        let series = series::run(scene, by, &truth, options, control, &mut announce)?;
        all.push(series);
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
        complete: !control.cancel.load(Ordering::Relaxed),
    })
}

/// Integrators of the native solver.
#[must_use]
pub fn method_names() -> Vec<&'static str> {
    METHODS.iter().map(|method| method.name).collect()
}

/// The methods of an engine: ours for the native forms, its own for others.
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
