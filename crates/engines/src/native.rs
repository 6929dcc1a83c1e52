//! Pinwheel's own solver as an engine, in its two formulations.

use cpu_time::ThreadTime;
use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_gearbox::scene::{Formulation, Scene};
use pinwheel_gearbox::{Gearbox, GearboxError};

use crate::engine::{Control, Engine, EngineError, Run, RunStats, Track};

/// The native solver with one formulation.
#[derive(Debug, Clone, Copy)]
pub struct Native {
    formulation: Formulation,
}

impl Native {
    /// Centre-pinned bodies eliminated.
    pub const REDUCED: Self = Self {
        formulation: Formulation::Reduced,
    };
    /// All bodies, Eq. 2.
    pub const LAGRANGE: Self = Self {
        formulation: Formulation::Lagrange,
    };

    /// The solver that a scene asks for.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        Self {
            formulation: scene.solver.formulation,
        }
    }

    fn compile(&self, scene: &Scene) -> Result<Gearbox, EngineError> {
        let mut scene = scene.clone();
        scene.solver.formulation = self.formulation;
        Gearbox::new(&scene).map_err(|error| self.unsupported(&error))
    }

    fn unsupported(&self, error: &GearboxError) -> EngineError {
        EngineError::Unsupported {
            engine: self.name().to_owned(),
            reason: error.to_string(),
        }
    }
}

impl Engine for Native {
    fn name(&self) -> &'static str {
        match self.formulation {
            Formulation::Reduced => "native-reduced",
            Formulation::Lagrange => "native-lagrange",
        }
    }

    fn track(&self) -> Track {
        Track::Native
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn summary(&self) -> &'static str {
        match self.formulation {
            Formulation::Reduced => "own solver, centre-pinned bodies eliminated exactly",
            Formulation::Lagrange => "own solver, every body and joint by multipliers (Eq. 2)",
        }
    }

    fn differences(&self) -> &'static str {
        match self.formulation {
            Formulation::Reduced => {
                "One equation per angle that forces can change: wheels, output, and with friction the sleeves. \
                 Translations of centre-pinned bodies are eliminated exactly, so there are no joints to drift."
            }
            Formulation::Lagrange => {
                "Three coordinates per body and multipliers for every joint, as the paper writes it. The saddle-point \
                 system is factored along the joints; positions are put back onto the constraints at every stage \
                 unless the scene says otherwise."
            }
        }
    }

    fn supports(&self, scene: &Scene) -> Result<(), EngineError> {
        self.compile(scene).map(|_| ())
    }

    fn run(&self, scene: &Scene, control: &Control<'_>) -> Result<Run, EngineError> {
        let gearbox = self.compile(scene)?;
        let (wall, cpu) = (std::time::Instant::now(), ThreadTime::now());
        let outcome = native::run(&gearbox, &mut |t| control.reached(t));
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
                settings: format!("{}, {}", self.name(), scene.solver.integrator),
                joint_drift_m: (self.formulation == Formulation::Lagrange)
                    .then_some(run.joint_drift_m),
                notes: Vec::new(),
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
