//! The atlas: every hard scene with every formulation and integrator.
//!
//! For each: the largest step that still gives the right picture (bisected), the error at the paper's
//! step against a converged run, what fails first above the largest step, and the energy balance.

mod reference;
mod search;
mod verdict;

use pinwheel_engines::{Knob, by_name};
use pinwheel_gearbox::auto;
use pinwheel_scene::{Formulation, PRESETS, Scales, Scene};
use serde::{Deserialize, Serialize};

pub use reference::Reference;
pub use verdict::Failure;

use crate::StudyError;
use crate::control::{Control, Ended, Progress, run_on};
use pinwheel_courses::norms::{Distance, Level};

/// A formulation with an integrator, or a solver from outside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Method {
    /// Name of a solver that joined; the rest is then what the scene has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solver: Option<String>,
    /// Equations.
    pub formulation: Formulation,
    /// Name in scenes.
    pub integrator: String,
    /// Tolerance of methods that choose their steps: of a step for `dopri5`, of a run for `imex2-adaptive`.
    pub tolerance: Option<f64>,
}

/// What to study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Presets or scene files.
    pub scenes: Vec<String>,
    /// Methods.
    pub methods: Vec<Method>,
    /// Step at which errors are measured, s.
    pub step_s: f64,
    /// Runs are cut to this length, s.
    pub longest_s: f64,
    /// Steps between which the largest stable one is looked for, s.
    pub steps_s: [f64; 2],
}

impl Method {
    /// A solver that joined, by its name.
    #[must_use]
    pub fn of_solver(name: &str, scene: &Scene) -> Self {
        let knob = by_name(name, scene).and_then(|engine| Some(engine.refinement()?.knob));
        Self {
            solver: Some(name.to_owned()),
            formulation: Formulation::Reduced,
            integrator: name.to_owned(),
            tolerance: (knob == Some(Knob::Tolerance)).then_some(scene.solver.tolerance),
        }
    }
}

impl Options {
    /// As the default, with runs of 0.02 s: the first impacts, and a fifth of the time.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            longest_s: 0.02,
            ..Self::default()
        }
    }
}

impl Default for Options {
    /// All hard presets, all methods, at the paper's step.
    fn default() -> Self {
        let method = |formulation, integrator: &str| Method {
            solver: None,
            formulation,
            integrator: integrator.to_owned(),
            tolerance: match integrator {
                "dopri5" | "etd-adams" | "rodas5p" => Some(1e-6),
                "imex2-adaptive" => Some(1e-3),
                _ => None,
            },
        };
        let (reduced, lagrange) = (Formulation::Reduced, Formulation::Lagrange);
        Self {
            scenes: hard_scenes().map(str::to_owned).collect(),
            methods: vec![
                method(reduced, "rk2"),
                method(reduced, "rk4"),
                method(reduced, "dopri5"),
                method(reduced, "etd-adams"),
                method(reduced, "imex2"),
                method(reduced, "imex2-adaptive"),
                method(reduced, "rodas5p"),
                method(lagrange, "rk2"),
                method(lagrange, "imex2"),
            ],
            step_s: 1e-5,
            longest_s: 0.05,
            steps_s: [2e-7, 1e-3],
        }
    }
}

/// Names of the presets that are hard on integrators.
pub fn hard_scenes() -> impl Iterator<Item = &'static str> {
    PRESETS
        .iter()
        .map(|preset| preset.name)
        .filter(|name| name.starts_with("hard-"))
}

/// What one method does on one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The method.
    pub method: Method,
    /// At the study's step or the method's tolerance; `None` if that run stopped, or if the converged forces
    /// are nothing but rounding (no load).
    pub error: Option<Distance>,
    /// How that run failed, if it did.
    pub failure: Option<Failure>,
    /// Sizes of its courses.
    pub level: Option<Level>,
    /// Energy that nothing accounts for, as a share of the larger work. Friction, damping and stored energy
    /// are accounted for; the paper's law itself creates about 0.01 in the steady state.
    pub energy_remainder_share: Option<f64>,
    /// Largest joint error, m (Lagrange form).
    pub joint_drift_m: f64,
    /// Evaluations of the contact forces.
    pub evaluations: u64,
    /// Largest step with the right picture, s; `None` for adaptive methods or where there is none.
    pub largest_step_s: Option<f64>,
    /// True if not even the longest step tried failed.
    pub never_failed: bool,
    /// What fails first above the largest step.
    pub fails_first: Option<Failure>,
}

/// One scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Its name.
    pub scene: String,
    /// Why it is hard.
    pub why: String,
    /// What `integrator = "auto"` takes for it.
    pub auto: String,
    /// The run everything is compared with.
    pub reference: Option<Reference>,
    /// Why there is none: a scene that is refused is a result too.
    pub refused: Option<String>,
    /// One a method.
    pub cells: Vec<Cell>,
}

/// The result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Atlas {
    /// What was asked.
    pub options: Options,
    /// One a scene.
    pub rows: Vec<Row>,
}

/// Studies every scene with every method.
///
/// # Errors
/// Cancelled, or a scene that cannot be loaded. Scenes that cannot be modelled are rows with the reason.
pub fn run(options: &Options, control: &Control<'_>) -> Result<Atlas, StudyError> {
    let mut rows = Vec::new();
    for (done, name) in options.scenes.iter().enumerate() {
        (control.progress)(Progress::new(done, options.scenes.len(), name));
        rows.push(row(name, options, control)?);
    }
    Ok(Atlas {
        options: options.clone(),
        rows,
    })
}

fn auto_choice(scene: &Scene) -> String {
    let mut scene = scene.clone();
    auto::AUTO.clone_into(&mut scene.solver.integrator);
    auto::integrator(&scene).integrator
}

/// Studies one scene, a preset or a file, with every method. A scene that cannot be resolved is a row with the reason.
///
/// # Errors
/// Cancelled, or a scene that cannot be loaded.
pub fn row(name: &str, options: &Options, control: &Control<'_>) -> Result<Row, StudyError> {
    let mut scene = Scene::load(name, &[])?.into_scene();
    scene.solver.duration_s = scene.solver.duration_s.min(options.longest_s);
    scene.solver.sample_s = scene.solver.sample_s.min(1e-4).min(scene.solver.duration_s);
    let mut row = Row {
        scene: scene.name.clone(),
        why: scene.description.clone(),
        auto: auto_choice(&scene),
        reference: None,
        refused: None,
        cells: Vec::new(),
    };
    let (reference, courses) = match reference::run(&scene, control) {
        Ok(found) => found,
        Err(StudyError::Cancelled) => return Err(StudyError::Cancelled),
        Err(refused) => {
            row.refused = Some(refused.to_string());
            return Ok(row);
        }
    };
    for method in &options.methods {
        let mut scene = scene.clone();
        if method.solver.is_none() {
            scene.solver.formulation = method.formulation;
            scene.solver.integrator.clone_from(&method.integrator);
        }
        let judge = verdict::Judge {
            reference: &courses,
            level: reference.level,
            scales: Scales::of(&scene),
        };
        row.cells
            .push(cell(&scene, method, options, &judge, control)?);
    }
    row.reference = Some(reference);
    Ok(row)
}

fn cell(
    scene: &Scene,
    method: &Method,
    options: &Options,
    judge: &verdict::Judge<'_>,
    control: &Control<'_>,
) -> Result<Cell, StudyError> {
    // A scene that asks for a tenth of the usual tolerance gets a tenth of the method's.
    let share = (scene.solver.tolerance / Scene::paper().solver.tolerance).min(1.0);
    let method = Method {
        tolerance: method.tolerance.map(|tolerance| tolerance * share),
        ..method.clone()
    };
    let at = |step: f64| {
        let mut scene = scene.clone();
        scene.solver.step_s = step;
        scene.solver.tolerance = method.tolerance.unwrap_or(scene.solver.tolerance);
        let Some(solver) = &method.solver else {
            return control.run(&scene);
        };
        let ran = run_on(solver, &scene, control.cancel)?;
        Ok(ran.map_or_else(
            |reason| Ended::Diverged {
                time_s: 0.0,
                quantity: reason,
                evaluations: 0,
            },
            |(ended, _)| ended,
        ))
    };
    let mut cell = Cell {
        method: method.clone(),
        error: None,
        failure: None,
        level: None,
        energy_remainder_share: None,
        joint_drift_m: 0.0,
        evaluations: 0,
        largest_step_s: None,
        never_failed: false,
        fails_first: None,
    };
    let ended = at(options.step_s)?;
    cell.failure = judge.failure(&ended);
    if let Ended::Whole(run) = &ended {
        cell.error = judge.error(&run.courses);
        cell.level = Some(Level::of(&run.courses));
        cell.energy_remainder_share = run.energy.total().and_then(|audit| audit.remainder_share);
        cell.joint_drift_m = run.joint_drift_m;
        cell.evaluations = run.counts.evaluations;
    }
    if method.tolerance.is_none() {
        let stable = cell.failure.is_none();
        let first = |step: f64| Ok(judge.failure(&at(step)?));
        (cell.largest_step_s, cell.fails_first) = search::largest_step(options, stable, first)?;
        cell.never_failed = cell.fails_first.is_none() && cell.largest_step_s.is_some();
    }
    Ok(cell)
}
