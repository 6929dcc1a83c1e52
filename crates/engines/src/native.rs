//! Pinwheel's own solver as an engine, in its two formulations.

use cpu_time::ThreadTime;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_scene::load_course;
use pinwheel_scene::{Contact, Detection, Fault, Formulation, Scene, Solver};

use crate::engine::{Control, Engine, EngineError, Prepared, Run, RunStats, Track};

/// How the native solver is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// Centre-pinned bodies eliminated.
    Reduced,
    /// All bodies, Eq. 2.
    Lagrange,
    /// The reduced form, integrated until the step no longer matters.
    Resolved,
}

/// The native solver in one of its forms.
#[derive(Debug, Clone, Copy)]
pub struct Native {
    form: Form,
}

/// Tolerance of the resolved form: its forces are then within 1e-6 of those at a hundredth of it
/// (measured over 0.6 s: `paper` 3e-8, `backlash-0.6` 2e-6, `steel` 7e-6 at 1e-10 against RK4).
const RESOLVED_TOLERANCE: f64 = 1e-10;
/// With friction, and with discrete points, no high order is to be had: the scene's step divided by this.
const RESOLVED_DIVISION: f64 = 10.0;

impl Native {
    /// Centre-pinned bodies eliminated.
    pub const REDUCED: Self = Self {
        form: Form::Reduced,
    };
    /// All bodies, Eq. 2.
    pub const LAGRANGE: Self = Self {
        form: Form::Lagrange,
    };
    /// The reduced form with an integrator that leaves no visible error of the step.
    pub const RESOLVED: Self = Self {
        form: Form::Resolved,
    };

    /// The solver that a scene asks for.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        match scene.solver.formulation {
            Formulation::Reduced => Self::REDUCED,
            Formulation::Lagrange => Self::LAGRANGE,
        }
    }

    /// The gearbox as this form solves it.
    fn formed(&self, gearbox: &Gearbox) -> Result<Gearbox, Fault> {
        let contact = gearbox.scene.contact.clone();
        gearbox.with_solver(|solver| self.form_of(&contact, solver))
    }

    fn form_of(&self, contact: &Contact, solver: &mut Solver) {
        solver.formulation = match self.form {
            Form::Lagrange => Formulation::Lagrange,
            Form::Reduced | Form::Resolved => Formulation::Reduced,
        };
        if self.form == Form::Resolved {
            let smooth =
                contact.friction_coefficient == 0.0 && contact.detection == Detection::Exact;
            if smooth {
                solver.integrator = "dopri5".to_owned();
                solver.tolerance = RESOLVED_TOLERANCE;
            } else {
                let friction = contact.friction_coefficient > 0.0;
                solver.integrator = if friction { "imex2" } else { "rk2" }.to_owned();
                solver.step_s /= RESOLVED_DIVISION;
            }
        }
    }

    fn unsupported(&self, error: &dyn std::fmt::Display) -> EngineError {
        EngineError::Unsupported {
            engine: self.name().to_owned(),
            reason: error.to_string(),
        }
    }
}

impl Engine for Native {
    fn name(&self) -> &'static str {
        match self.form {
            Form::Reduced => "native-reduced",
            Form::Lagrange => "native-lagrange",
            Form::Resolved => "native-resolved",
        }
    }

    fn track(&self) -> Track {
        Track::Native
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn summary(&self) -> &'static str {
        match self.form {
            Form::Reduced => "own solver, centre-pinned bodies eliminated exactly",
            Form::Lagrange => "own solver, every body and joint by multipliers (Eq. 2)",
            Form::Resolved => {
                "own solver, reduced form, integrated until the step no longer matters"
            }
        }
    }

    fn differences(&self) -> &'static str {
        match self.form {
            Form::Reduced => {
                "One equation per angle that forces can change: wheels, output, and with friction the sleeves. \
                 Translations of centre-pinned bodies are eliminated exactly, so there are no joints to drift."
            }
            Form::Lagrange => {
                "Three coordinates per body and multipliers for every joint, as the paper writes it. The saddle-point \
                 system is factored along the joints; positions are put back onto the constraints at every stage \
                 unless the scene says otherwise."
            }
            Form::Resolved => {
                "The equations of native-reduced without the scene's integrator and step: Dormand-Prince at a tolerance \
                 of 1e-10 where forces are smooth, otherwise the method for friction or points at a tenth of the step. \
                 Its distance from native-reduced is the error of the scene's own integrator."
            }
        }
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Box<dyn Prepared + 'a>, EngineError> {
        let gearbox = self
            .formed(gearbox)
            .map_err(|fault| self.unsupported(&fault))?;
        Ok(Box::new(move |control: &Control<'_>| {
            self.integrate(&gearbox, control)
        }))
    }
}

impl Native {
    fn integrate(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, EngineError> {
        let scene = &gearbox.scene;
        let (wall, cpu) = (std::time::Instant::now(), ThreadTime::now());
        let outcome = native::run(gearbox, &mut |t| control.reached(t));
        let (wall_s, cpu_s) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
        let dress = |run: NativeRun| {
            let counts = run.counts;
            let stats = RunStats {
                wall_s,
                cpu_s,
                rhs_calls: counts.evaluations,
                steps: counts.steps,
                rejected_steps: counts.rejected,
                degrees_of_freedom: run.degrees_of_freedom,
                bodies: gearbox.layout.bodies(),
                step_s: if counts.steps == 0 {
                    0.0
                } else {
                    run.end_s / counts.steps as f64
                },
                settings: settings(&gearbox.scene),
                joint_drift_m: (self.form == Form::Lagrange).then_some(run.joint_drift_m),
                energy: windows(scene)
                    .into_iter()
                    .filter_map(|(from, to)| run.energy.audit(from, to))
                    .collect(),
                notes: load_course::unreached(scene).into_iter().collect(),
                recorded: None,
            };
            Run {
                courses: run.courses,
                stats,
            }
        };
        let engine = self.name().to_owned();
        match outcome {
            Ok(run) => Ok(dress(run)),
            Err(NativeError::Diverged {
                time_s,
                quantity,
                partial,
            }) => Err(EngineError::Diverged {
                engine,
                time_s,
                quantity,
                partial: Box::new(dress(*partial)),
            }),
            Err(NativeError::Stopped) => Err(EngineError::Cancelled),
            Err(NativeError::Model(error)) => Err(self.unsupported(&error)),
            Err(NativeError::Courses(error)) => Err(EngineError::Failed {
                engine,
                reason: error.to_string(),
            }),
        }
    }
}

/// Formulation, method and what sets its steps.
fn settings(scene: &Scene) -> String {
    let solver = &scene.solver;
    let form = match solver.formulation {
        Formulation::Reduced => "reduced",
        Formulation::Lagrange => "lagrange",
    };
    let choice = pinwheel_gearbox::auto::integrator(scene).integrator;
    let adaptive = pinwheel_mbs::integrators::METHODS
        .iter()
        .any(|m| m.name == choice && m.adaptive);
    if adaptive {
        format!("{form}, {choice}, tolerance {:e}", solver.tolerance)
    } else {
        format!("{form}, {choice}, {:e} s", solver.step_s)
    }
}

/// The whole run and its second half, where a start-up has died away, or what is left of it after the load has
/// changed for the last time.
fn windows(scene: &Scene) -> [(f64, f64); 2] {
    let duration = scene.solver.duration_s;
    let half = 0.5 * duration;
    let changed = load_course::last_change_s(scene).map_or(half, |last| half.max(last));
    let from = if changed < duration { changed } else { half };
    [(0.0, duration), (from, duration)]
}
