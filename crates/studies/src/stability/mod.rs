//! Stability atlas: correct formulations and integrators for each hard scene, and the failures of the others.
//!
//! An entry for each scene and method has the largest step with a correct run (by bisection), the error at the paper's step
//! against a converged run, the first failure above the largest step, and the energy balance.
//!
//! Scenes are independent: they run in parallel, and an interrupted atlas resumes with the missing ones.

mod search;
mod verdict;
mod write;

use std::sync::atomic::{AtomicUsize, Ordering};

use pinwheel_engines::{AccuracySetting, by_name};
use pinwheel_gearbox::{Gearbox, auto};
use pinwheel_mbs::integrators;
use pinwheel_scene::{Formulation, PRESETS, Scales, Scene};
use pinwheel_timeseries::norms::{Distance, LoadMagnitude};
use serde::{Deserialize, Serialize};

pub use verdict::Failure;

use crate::StudyError;
use crate::control::{Control, Progress, run_on};
use crate::pool;
use crate::reference::{self, Reference};

/// Formulation with an integrator, or a user's solver.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Method {
    /// Name of a user's solver, with the scene's values in the other fields.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solver: Option<String>,
    /// Formulation of the equations of motion.
    pub formulation: Formulation,
    /// Name of the integrator in scenes.
    pub integrator: String,
    /// Tolerance of adaptive methods: per step for `dopri5`, per run for `imex2-adaptive`.
    pub tolerance: Option<f64>,
}

impl Method {
    /// Returns the method of the user's solver `name` on `scene`.
    pub fn of_solver(name: &str, scene: &Scene) -> Self {
        let knob = by_name(name, scene).and_then(|engine| Some(engine.info().refinement?.knob));
        Self {
            solver: Some(name.to_owned()),
            formulation: Formulation::Reduced,
            integrator: name.to_owned(),
            tolerance: (knob == Some(AccuracySetting::Tolerance)).then_some(scene.solver.tolerance),
        }
    }

    /// Returns `reduced`, `lagrange`, or the name of the user's solver.
    pub fn form(&self) -> &str {
        match (&self.solver, self.formulation) {
            (Some(solver), _) => solver,
            (None, Formulation::Reduced) => "reduced",
            (None, Formulation::Lagrange) => "lagrange",
        }
    }

    /// Returns the formulation and integrator, `reduced rk2`, with the tolerance of adaptive methods.
    pub fn name(&self) -> String {
        let (form, integrator) = (self.form(), &self.integrator);
        match (&self.solver, self.tolerance) {
            (Some(solver), _) => solver.clone(),
            (None, Some(tolerance)) => format!("{form} {integrator} {tolerance:.0e}"),
            (None, None) => format!("{form} {integrator}"),
        }
    }
}

/// Choices of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Presets or scene files.
    pub scenes: Vec<String>,
    /// Methods to study.
    pub methods: Vec<Method>,
    /// Step at which errors are measured, s.
    pub step_s: f64,
    /// Longest duration of a run, s; longer scenes are shortened.
    pub longest_s: f64,
    /// Least and largest step of the search for the largest stable one, s.
    pub steps_s: [f64; 2],
    /// Number of evaluations after which a native run with a tolerance is not continued.
    pub most_evaluations: Option<u64>,
    /// Factor of the fixed steps of converged runs.
    pub coarser: f64,
}

impl Default for Options {
    /// Returns all hard presets and all methods, at the paper's step.
    fn default() -> Self {
        let method = |(formulation, integrator): (Formulation, &str)| Method {
            solver: None,
            formulation,
            integrator: integrator.to_owned(),
            tolerance: integrators::method(integrator)
                .filter(|method| method.adaptive)
                .map(|method| method.usual_tolerance),
        };
        let (reduced, lagrange) = (Formulation::Reduced, Formulation::Lagrange);
        let names = PRESETS.iter().map(|preset| preset.name);
        let hard = names.filter(|name| name.starts_with("hard-"));
        Self {
            scenes: hard.map(str::to_owned).collect(),
            methods: [
                (reduced, "rk2"),
                (reduced, "rk4"),
                (reduced, "dopri5"),
                (reduced, "etd-adams"),
                (reduced, "imex2"),
                (reduced, "imex2-adaptive"),
                (reduced, "rodas5p"),
                (lagrange, "rk2"),
                (lagrange, "imex2"),
            ]
            .map(method)
            .into(),
            step_s: 1e-5,
            longest_s: 0.05,
            steps_s: [2e-7, 1e-3],
            most_evaluations: None,
            coarser: 1.0,
        }
    }
}

impl Options {
    /// Returns the default options with runs of 0.02 s, which include the first impacts, and at most fifty times the evaluations of
    /// the paper's step. Converged runs by fixed steps, of discrete points and of stiff friction, are good to some 1e-5.
    pub fn quick() -> Self {
        Self {
            longest_s: 0.02,
            most_evaluations: Some(200_000),
            coarser: 2.0,
            ..Self::default()
        }
    }

    /// Returns the options with other scenes, unchanged for an empty list.
    ///
    /// # Errors
    /// A scene that is repeated, cannot be read, or cannot be modelled.
    pub fn of(self, scenes: &[String]) -> Result<Self, StudyError> {
        if scenes.is_empty() {
            return Ok(self);
        }
        for (k, name) in scenes.iter().enumerate() {
            if scenes[..k].contains(name) {
                let what = format!("{name} is named twice; name each scene once");
                return Err(StudyError::Input(what));
            }
            Gearbox::new(&Scene::load(name, &[])?).map_err(|source| StudyError::Scene {
                scene: name.clone(),
                source,
            })?;
        }
        Ok(Self {
            scenes: scenes.to_vec(),
            ..self
        })
    }
}

/// Result of one method on one scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Cell {
    /// Method of the entry.
    pub method: Method,
    /// Error at the study's step or the method's tolerance; `None` if that run stopped, or if the converged forces are rounding
    /// (no load).
    pub error: Option<Distance>,
    /// Failure of that run, if any.
    pub failure: Option<Failure>,
    /// Number of evaluations at which that run was ended as too dear; neither a failure nor a correct run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dearer_than: Option<u64>,
    /// Largest and mean loads of the run's time series.
    pub level: Option<LoadMagnitude>,
    /// Remainder of the energy balance as a share of the larger work, after friction, damping and stored energy; the paper's
    /// law creates about 0.01 in the steady state.
    pub energy_remainder_share: Option<f64>,
    /// Largest joint error, m (Lagrange form).
    pub joint_drift_m: f64,
    /// Evaluations of the contact forces.
    pub evaluations: u64,
    /// Largest step with a correct run, s; `None` for adaptive methods, or if no step gives one.
    pub largest_step_s: Option<f64>,
    /// True if the longest step gave a correct run.
    pub never_failed: bool,
    /// First failure above the largest step.
    pub fails_first: Option<Failure>,
}

impl Cell {
    /// True if the method gives a correct run at the study's step or at a shorter one.
    pub fn is_right(&self) -> bool {
        self.largest_step_s.is_some() || self.right_to().is_some()
    }

    /// Returns the error of the forces of a correct run (0 if no pin carries force).
    pub fn right_to(&self) -> Option<f64> {
        let right = self.failure.is_none() && self.dearer_than.is_none();
        right.then(|| self.error.map_or(0.0, |error| error.forces))
    }
}

/// Results of every method on one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneRow {
    /// Name of the scene.
    pub scene: String,
    /// Reason why the scene is hard.
    pub why: String,
    /// Method that `integrator = "auto"` selects for the scene.
    pub auto: String,
    /// Converged run, the reference of all errors.
    pub reference: Option<Reference>,
    /// Reason for the absence of a converged run, which is a result, too.
    pub refused: Option<String>,
    /// Results, one for each method.
    pub cells: Vec<Cell>,
}

impl SceneRow {
    /// Returns the method with the smallest error among correct runs.
    pub fn best(&self) -> Option<(&Cell, f64)> {
        let cells = self.cells.iter();
        let right = cells.filter_map(|cell| Some((cell, cell.right_to()?)));
        right.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Largest relative error of the forces for which a method is sufficient for a scene.
pub const SERVED: f64 = 0.01;

/// Result of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Atlas {
    /// Choices of the study.
    pub options: Options,
    /// Results, one for each scene; `None` if not complete.
    pub rows: Vec<Option<SceneRow>>,
}

impl Atlas {
    /// Returns an atlas without results.
    pub fn new(options: Options) -> Self {
        Self {
            rows: vec![None; options.scenes.len()],
            options,
        }
    }

    /// Returns the results of the completed scenes.
    pub fn done(&self) -> impl Iterator<Item = &SceneRow> {
        self.rows.iter().flatten()
    }

    /// Studies every incomplete scene, on `jobs` threads. A scene that cannot be modelled becomes a row with the reason.
    ///
    /// # Errors
    /// Cancelled, or a scene that cannot be loaded, reported after the others have ended. Complete rows are kept.
    pub fn go_on(&mut self, jobs: usize, control: &Control<'_>) -> Result<(), StudyError> {
        let (options, total) = (&self.options, self.rows.len());
        let open = (0..total).filter(|&k| self.rows[k].is_none());
        let open: Vec<usize> = open.collect();
        let begun = AtomicUsize::new(total - open.len());
        let study = |(): &mut (), k: usize| {
            let name = &options.scenes[open[k]];
            let done = begun.fetch_add(1, Ordering::Relaxed);
            (control.progress)(Progress::new(done, total, name));
            control.check()?;
            row(name, options, control)
        };
        let (rows, fault) = pool::map(jobs, open.len(), || (), study);
        for (k, row) in open.into_iter().zip(rows) {
            self.rows[k] = row;
        }
        fault.map_or(Ok(()), Err)
    }

    /// Returns a line for each user's solver, and true if the solver is sufficient for a scene.
    pub fn findings(&self) -> impl Iterator<Item = (String, bool)> {
        let methods = self.options.methods.iter().enumerate();
        methods.filter_map(|(place, method)| {
            let name = method.solver.as_ref()?;
            let cells: Vec<&Cell> = self.done().filter_map(|row| row.cells.get(place)).collect();
            let right = cells.iter().filter(|cell| cell.is_right()).count();
            if right > 0 {
                let line = format!("{name}: right in {right} of {} scenes", cells.len());
                return Some((line, true));
            }
            let first = cells.iter().find_map(|cell| cell.failure.as_ref());
            let first = first.map(|why| format!("; first: {}", why.sentence()));
            let first = first.unwrap_or_default();
            Some((
                format!("{name}: nothing shown: right in no scene{first}"),
                false,
            ))
        })
    }

    /// Returns the names of the scenes without a sufficient method, [`SERVED`].
    pub fn unserved(&self) -> Vec<String> {
        let served = |row: &&SceneRow| row.best().is_some_and(|(_, error)| error <= SERVED);
        let unserved = self.done().filter(|row| !served(row));
        unserved.map(|row| row.scene.clone()).collect()
    }
}

/// Studies one scene, a preset or a file, with every method. A scene without a converged run is a row with the reason.
fn row(name: &str, options: &Options, control: &Control<'_>) -> Result<SceneRow, StudyError> {
    let mut scene = Scene::load(name, &[])?.into_scene();
    scene.solver.duration_s = scene.solver.duration_s.min(options.longest_s);
    scene.solver.sample_s = scene.solver.sample_s.min(1e-4).min(scene.solver.duration_s);
    let mut automatic = scene.clone();
    auto::AUTO.clone_into(&mut automatic.solver.integrator);
    let mut row = SceneRow {
        scene: scene.name.clone(),
        why: scene.description.clone(),
        auto: auto::integrator(&automatic).0,
        reference: None,
        refused: None,
        cells: Vec::new(),
    };
    match reference::run(&scene, options.coarser, control, &mut |_| {}) {
        Ok((reference, [time_series, _])) => {
            let judge = verdict::Judge::new(&time_series, Scales::of(&scene));
            let methods = options.methods.iter();
            let cells = methods.map(|method| cell(&scene, method, options, &judge, control));
            row.cells = cells.collect::<Result<_, _>>()?;
            row.reference = Some(reference);
        }
        Err(StudyError::Cancelled) => return Err(StudyError::Cancelled),
        Err(refused) => row.refused = Some(refused.to_string()),
    }
    Ok(row)
}

fn cell(
    scene: &Scene,
    method: &Method,
    options: &Options,
    judge: &verdict::Judge<'_>,
    control: &Control<'_>,
) -> Result<Cell, StudyError> {
    let (mut scene, mut method) = (scene.clone(), method.clone());
    // A scene with a tenth of the usual tolerance gets a tenth of the method's.
    let share = (scene.solver.tolerance / Scene::paper().solver.tolerance).min(1.0);
    method.tolerance = method.tolerance.map(|tolerance| tolerance * share);
    scene.solver.tolerance = method.tolerance.unwrap_or(scene.solver.tolerance);
    if method.solver.is_none() {
        scene.solver.formulation = method.formulation;
        scene.solver.integrator.clone_from(&method.integrator);
    }
    let engine = method.solver.as_deref().unwrap_or("native");
    let bounded = method.solver.is_none() && method.tolerance.is_some();
    let most = options
        .most_evaluations
        .filter(|_| bounded)
        .unwrap_or(u64::MAX);
    let mut control = Control::silent(control.cancel);
    control.evaluations = most;
    let mut at = |step_s: f64| {
        scene.solver.step_s = step_s;
        run_on(engine, &scene, &control)
    };
    let run = at(options.step_s)?;
    let is_dearer = run.stats.rhs_calls > most && !run.ending.is_finished();
    let mut cell = Cell {
        failure: judge.failure(&run).filter(|_| !is_dearer),
        dearer_than: is_dearer.then_some(most),
        ..Cell::default()
    };
    if run.ending.is_finished() {
        cell.error = judge.error(&run.time_series);
        cell.level = Some(LoadMagnitude::of(&run.time_series));
        let audit = run.stats.energy.first();
        cell.energy_remainder_share = audit.and_then(|audit| audit.remainder_share);
        cell.joint_drift_m = run.stats.joint_drift_m.unwrap_or(0.0);
        cell.evaluations = run.stats.rhs_calls;
    }
    if method.tolerance.is_none() {
        let stable = cell.failure.is_none();
        let first = |step: f64| Ok(judge.failure(&at(step)?));
        (cell.largest_step_s, cell.fails_first) = search::largest_step(options, stable, first)?;
        cell.never_failed = cell.fails_first.is_none() && cell.largest_step_s.is_some();
    }
    Ok(Cell { method, ..cell })
}
