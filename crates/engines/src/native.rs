//! Pinwheel's own solver as an engine, in two formulations.

use cpu_time::ThreadTime;
use pinwheel_gearbox::native::{self, NativeError};
use pinwheel_gearbox::resolve::{self, BUDGET, Uncertainty};
use pinwheel_gearbox::{Gearbox, auto};
use pinwheel_mbs::integrators::method;
use pinwheel_scene::{Detection, Fault, Formulation, Scene, load_profile};

use crate::control::{Cancelled, Control};
use crate::engine::{Ending, Engine, Halt, Prepared, Run, RunStats, prepared};
use crate::info::{EngineInfo, Form};
use crate::known::native as facts;

/// Native solver in one of its forms.
#[derive(Debug, Clone, Copy)]
pub struct Native(Form);

/// Target of the resolved form without friction, below any visible effect of the step.
const RESOLVED: f64 = 1e-7;
/// Target of the resolved form if friction switches or forces jump from point to point. Two foreign solvers of `paper-friction`
/// agree to 1.5e-5.
const RESOLVED_ROUGH: f64 = 1e-5;

impl Native {
    /// Reduced form: centre-pinned bodies eliminated.
    pub const REDUCED: Self = Self(Form::Reduced);
    /// Lagrange form: all bodies, Eq. 2.
    pub const LAGRANGE: Self = Self(Form::Lagrange);
    /// Reduced form, refined until the step has no visible effect.
    pub const RESOLVED: Self = Self(Form::Resolved);

    pub(crate) const fn new(form: Form) -> Self {
        Self(form)
    }

    /// Returns the solver for a scene's formulation.
    pub fn of(scene: &Scene) -> Self {
        match scene.solver.formulation {
            Formulation::Reduced => Self::REDUCED,
            Formulation::Lagrange => Self::LAGRANGE,
        }
    }

    /// Returns the gearbox with the settings of this form.
    fn formed(&self, gearbox: &Gearbox) -> Result<Gearbox, Fault> {
        gearbox.with_solver(|solver| {
            solver.formulation = match self.0 {
                Form::Lagrange => Formulation::Lagrange,
                Form::Reduced | Form::Resolved => Formulation::Reduced,
            };
            if self.0 == Form::Resolved {
                auto::AUTO.clone_into(&mut solver.integrator);
            }
        })
    }

    /// Returns the target of the resolved form: relative L2 of the forces and of the driver's torque.
    pub fn resolved_target(scene: &Scene) -> f64 {
        if !scene.slides() && scene.contact.detection == Detection::Exact {
            RESOLVED
        } else {
            RESOLVED_ROUGH
        }
    }

    /// Returns the target of the run; `None` if the scene names its method.
    fn target(&self, scene: &Scene) -> Option<f64> {
        if self.0 == Form::Resolved {
            return Some(Self::resolved_target(scene));
        }
        (scene.solver.integrator == auto::AUTO).then_some(auto::TARGET)
    }
}

impl Engine for Native {
    fn info(&self) -> EngineInfo<'_> {
        match self.0 {
            Form::Reduced => facts::REDUCED,
            Form::Lagrange => facts::LAGRANGE,
            Form::Resolved => facts::RESOLVED,
        }
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let gearbox = self.formed(gearbox).map_err(Ending::unsupported)?;
        Ok(prepared(gearbox, |gearbox, control| {
            self.integrate(gearbox, control)
        }))
    }
}

impl Native {
    fn integrate(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, Halt> {
        let scene = &gearbox.scene;
        let (wall, cpu) = (std::time::Instant::now(), ThreadTime::now());
        let mut watch = |t| control.reached(t);
        let outcome = match self.target(scene) {
            Some(target) => resolve::run_resolved(gearbox, target, BUDGET, &mut watch)
                .map(|(run, uncertainty)| (run, Some(uncertainty))),
            None => {
                native::run_bounded(gearbox, control.evaluations, &mut watch).map(|run| (run, None))
            }
        };
        let (wall_s, cpu_s) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
        let (run, uncertainty) = outcome.map_err(|error| match error {
            NativeError::Stopped => Halt::from(Cancelled),
            NativeError::Model(error) => Ending::unsupported(error).into(),
            NativeError::TimeSeries(error) => Ending::failed(error).into(),
            NativeError::Ended(ending) => ending.into(),
        })?;
        let uncertainty = uncertainty.filter(|_| run.ending.is_finished());
        let late = load_profile::unreached(scene);
        let notes = uncertainty.iter().flat_map(Uncertainty::notes);
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
            settings: settings(&gearbox.scene, uncertainty.as_ref()),
            joint_drift_m: (self.0 == Form::Lagrange).then_some(run.joint_drift_m),
            energy: windows(scene)
                .into_iter()
                .filter_map(|(from, to)| run.energy.audit(from, to))
                .collect(),
            notes: late.into_iter().chain(notes).collect(),
            ..RunStats::default()
        };
        Ok(Run {
            uncertainty,
            ..Run::new(run.time_series, stats).with_ending(run.ending)
        })
    }
}

/// Describes formulation, method and the setting of its steps.
fn settings(scene: &Scene, uncertainty: Option<&Uncertainty>) -> String {
    let solver = &scene.solver;
    let form = match solver.formulation {
        Formulation::Reduced => "reduced",
        Formulation::Lagrange => "lagrange",
    };
    if let Some(level) = uncertainty.and_then(Uncertainty::chosen) {
        return format!("{form}, {}, {}", level.integrator, level.setting);
    }
    let named = &solver.integrator;
    let adaptive = method(named).is_some_and(|m| m.adaptive);
    if adaptive {
        format!("{form}, {named}, tolerance {:e}", solver.tolerance)
    } else {
        // Ten digits, because a fraction of a step may be a long number.
        let step: f64 = format!("{:.9e}", solver.step_s)
            .parse()
            .unwrap_or(solver.step_s);
        format!("{form}, {named}, {step:e} s")
    }
}

/// Returns the times of the run and of its second half, after the start-up, or of the rest after the last load change.
fn windows(scene: &Scene) -> [(f64, f64); 2] {
    let duration = scene.solver.duration_s;
    let half = 0.5 * duration;
    let changed = load_profile::last_change_s(scene).map_or(half, |last| half.max(last));
    let from = if changed < duration { changed } else { half };
    [(0.0, duration), (from, duration)]
}
