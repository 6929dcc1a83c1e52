//! Native run: integration and recording of a scene's equations.

use pinwheel_mbs::integrators::{Segments, StepCounts, StepError, StepSettings, Stepper, method};
use pinwheel_mbs::{
    BodyState, Detail, Forces, Formulation, Lagrange, Mechanism, Observation, Reduced,
    Stabilisation, Wrench,
};
use pinwheel_timeseries::{Ending, TimeSeries, TimeSeriesError};

use crate::balance::Balance;
use crate::channels::{EngineState, LawPairs};
use crate::contacts::{ContactEnergy, ContactField};
use crate::energy::EnergyAccount;
use crate::events::Event;
use crate::forces::GearForces;
use crate::load_profile;
use crate::run_limits::{Limits, Pace};
use crate::scene;
use crate::{Gearbox, GearboxError, Recorder, auto, guard};

/// Result of a run, complete or not.
#[derive(Debug, Clone)]
pub struct NativeRun {
    /// Recorded samples.
    pub time_series: TimeSeries,
    /// Work of the integrator.
    pub counts: StepCounts,
    /// Newton steps of the implicit stages, samples inside steps included.
    pub newton_steps: u64,
    /// Number of integrated velocities.
    pub degrees_of_freedom: usize,
    /// Largest joint error at any sample, m.
    pub joint_drift_m: f64,
    /// Time reached, s.
    pub end_s: f64,
    /// Energy balance of the run.
    pub energy: EnergyAccount,
    /// Ending of the run: finished, or diverged with the samples before.
    pub ending: Ending,
}

impl NativeRun {
    /// Returns the run if it finished.
    ///
    /// # Errors
    /// The ending of a run that did not finish.
    pub fn finished(self) -> Result<Self, Ending> {
        self.ending.finished().map(|()| self)
    }
}

/// Reasons for a missing run.
#[derive(Debug, thiserror::Error)]
pub enum NativeError {
    /// The scene cannot be modelled.
    #[error(transparent)]
    Model(#[from] GearboxError),
    /// The observer requested a stop.
    #[error("stopped")]
    Stopped,
    /// The run ended early, but a complete one is required ([`NativeRun::finished`]).
    #[error(transparent)]
    Ended(#[from] Ending),
    /// Recording failed.
    #[error(transparent)]
    TimeSeries(#[from] TimeSeriesError),
}

/// Baumgarte's rate in units of 1/step: fast enough to be effective, slow enough for explicit methods.
const BAUMGARTE_PER_STEP: f64 = 0.1;

/// Least time between two evaluations that are used for extremes, in steps of the scene, or of 0.125 rad of the fastest
/// oscillation. Evaluating every step would slow a fast run by about 5 %.
const EXTREMA_STRIDE: f64 = 3.0;

/// Runs the scene; `watch` receives the simulated time at every sample and every 1000 steps, and returns true to stop. With the
/// integrator `auto` this is one run by [`auto::plan`]; [`resolve::run_resolved`](crate::resolve::run_resolved) verifies it.
///
/// # Errors
/// See [`NativeError`].
pub fn run(
    gearbox: &Gearbox,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, NativeError> {
    run_bounded(gearbox, u64::MAX, watch)
}

/// Runs the scene like [`run`], but ends it as diverged at more than `evaluations`, checked every 1000 steps.
///
/// # Errors
/// See [`NativeError`].
pub fn run_bounded(
    gearbox: &Gearbox,
    evaluations: u64,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, NativeError> {
    run_sampling(gearbox, false, evaluations, watch)
}

/// Runs the scene like [`run`], but evaluates nothing between samples: no extremes and no energy balance. Fixed-step methods
/// still compute both, because only the energy balance detects an unresolved step.
///
/// # Errors
/// See [`NativeError`].
pub fn run_at_samples(
    gearbox: &Gearbox,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, NativeError> {
    run_sampling(gearbox, true, u64::MAX, watch)
}

fn run_sampling(
    gearbox: &Gearbox,
    samples_alone: bool,
    evaluations: u64,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, NativeError> {
    let planned = gearbox.scene.solver.integrator == auto::AUTO;
    let plan = planned.then(|| auto::plan(&gearbox.scene, auto::TARGET));
    let (limits, applied) = match &plan {
        Some(plan) => (plan.limits(), Some(plan.applied(gearbox)?)),
        None => (Limits::NONE, None),
    };
    let gearbox = applied.as_ref().unwrap_or(gearbox);
    let method = method(&gearbox.scene.solver.integrator);
    let limits = Limits {
        evaluations,
        samples_alone: samples_alone && method.is_some_and(|method| method.adaptive),
        ..limits
    };
    run_within(gearbox, limits, watch)
}

/// Runs the scene with its named integrator within limits.
pub(crate) fn run_within(
    gearbox: &Gearbox,
    limits: Limits,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, NativeError> {
    let forces = GearForces::new(gearbox)?;
    let mechanism = gearbox.mechanism();
    match gearbox.scene.solver.formulation {
        scene::Formulation::Reduced => {
            let system = reduced(gearbox, mechanism, forces)?;
            integrate(gearbox, system, limits, watch)
        }
        scene::Formulation::Lagrange => {
            let stabilisation = match gearbox.scene.solver.stabilisation {
                scene::Stabilisation::None => Stabilisation::None,
                scene::Stabilisation::Projection => Stabilisation::Projection,
                scene::Stabilisation::Baumgarte => Stabilisation::Baumgarte {
                    rate: BAUMGARTE_PER_STEP / gearbox.scene.solver.step_s,
                },
            };
            let contacts = reduced(gearbox, mechanism.clone(), NoForces)?;
            let system = Lagrange::new(mechanism, forces, stabilisation)
                .map_err(GearboxError::from)?
                .with_contacts(contacts.into_contacts())
                .with_scales(gearbox.error_scales());
            integrate(gearbox, system, limits, watch)
        }
    }
}

/// Empty forces of a system that only determines the dependence of its contacts on the free rates.
struct NoForces;

impl Forces for NoForces {
    fn apply(&mut self, _: f64, _: &[BodyState], _: &mut [Wrench]) {}
}

/// Returns the reduced form of `mechanism`, which may differ from the gear's only in its drivers and masses.
///
/// # Errors
/// The mechanism cannot be reduced.
pub fn reduced<F: Forces>(
    gearbox: &Gearbox,
    mechanism: Mechanism,
    forces: F,
) -> Result<Reduced<F>, GearboxError> {
    let layout = gearbox.layout;
    let sleeves: Vec<usize> = (layout.external_bodies().start..layout.bodies()).collect();
    let spinning = gearbox.spinning();
    let idle: Vec<usize> = (sleeves.iter().copied())
        .filter(|sleeve| !spinning.contains(sleeve))
        .collect();
    Ok(Reduced::new(mechanism, forces, &idle)?
        .with_leaves(&sleeves)
        .with_scales(gearbox.error_scales()))
}

/// Starts the scene's method from `y` at `t`, s. If the method chooses its steps, none is longer than `longest_s`.
pub(crate) fn segments(
    gearbox: &Gearbox,
    t: f64,
    y: &[f64],
    breaks: &[f64],
    longest_s: f64,
) -> Result<Segments, GearboxError> {
    let solver = &gearbox.scene.solver;
    let settings = StepSettings {
        step: solver.step_s,
        tolerance: solver.tolerance,
    };
    Segments::start(&solver.integrator, settings, t, y, breaks)
        .map(|segments| segments.with_longest(longest_s))
        .ok_or_else(|| GearboxError::UnknownIntegrator(solver.integrator.clone()))
}

/// Steps through the run, records samples inside steps, and checks every sample.
fn integrate<F: Formulation>(
    gearbox: &Gearbox,
    mut system: F,
    limits: Limits,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, NativeError> {
    let solver = &gearbox.scene.solver;
    let mut y = system.initial();
    let breaks = load_profile::breaks(&gearbox.scene.drive);
    let mut stepper = segments(gearbox, 0.0, &y, &breaks, limits.longest_step_s)?;
    let mut load = load_profile::piece_at(&gearbox.scene.drive, 0.0);
    // Most methods do not compute the energy, and most scenes request no channels; the field is then not needed.
    let mut field = None;
    let times = solver.sample_times_s();
    let between = !limits.samples_alone;
    let mut recorder = match between {
        true => Recorder::with_between(gearbox, times.len()),
        false => Recorder::new(gearbox),
    };
    if !between {
        system.observe_from(f64::INFINITY);
    }
    let account_step = match between {
        true => solver.step_s,
        false => solver.step_s.max(solver.sample_s),
    };
    let mut joint_drift_m: f64 = 0.0;
    let mut energy = EnergyAccount::new(&gearbox.scene, times.len());
    let mut balance = Balance::new(gearbox);
    let mut pace = Pace::new(&gearbox.scene, gearbox.has_friction());
    let mut before = 0.0;
    let mut list = Vec::new();
    let samples = || -> Result<(), NativeError> {
        for t in times {
            Event::list(&mut list, before, t, &breaks, account_step);
            for &due in &list {
                let time = due.time();
                stepper.set_stop_time(time);
                let until = time - 1e-9 * solver.step_s;
                while stepper.time() < until {
                    advance(&mut stepper, &mut system, limits, &mut pace, watch)?;
                    let at = stepper.time();
                    if at < until
                        && let Some(state) = stepper.evaluated_state()
                        && let Some(observed) = system.cached_observation(at, state)
                    {
                        let torques = [observed.driver_torques[0], load.torque(at)];
                        recorder.record_between(&observed, torques);
                        if let Some(contacts) = &observed.energy {
                            energy.pass(load.torque(at), &observed, contacts);
                        }
                        system.observe_from(at + EXTREMA_STRIDE * solver.step_s);
                    }
                }
                stepper.interpolate(&mut system, time, &mut y);
                if let Event::Entry(time) | Event::Break(time, _) = due
                    && between
                {
                    let observed = system.observe(time, &y, Detail::Forces);
                    let contacts = contact_energy(&observed, gearbox, &mut field)?;
                    energy.add(load.torque(time), &observed, &contacts);
                    let torques = [observed.driver_torques[0], load.torque(time)];
                    recorder.record_between(&observed, torques);
                }
                if let Event::Break(_, from) = due {
                    stepper.enter(&mut system);
                    load = load_profile::piece_at(&gearbox.scene.drive, from);
                    energy.restart_at();
                }
            }
            joint_drift_m = joint_drift_m.max(system.joint_error(t, &y));
            let detail = match recorder.wants_channels() {
                true => Detail::Everything,
                false => Detail::Forces,
            };
            let observed = system.observe(t, &y, detail);
            guard::check(gearbox, observed.bodies).map_err(diverged(t))?;
            if between {
                let contacts = contact_energy(&observed, gearbox, &mut field)?;
                energy.add_sample(load.torque(t), &observed, &contacts);
                if let Some(audit) = energy.latest() {
                    balance.add(&audit).map_err(diverged(t))?;
                }
            }
            recorder.record_observed(&observed, [observed.driver_torques[0], load.torque(t)]);
            if recorder.wants_channels() {
                recorder.record_channels(&mut EngineState {
                    bodies: observed.bodies,
                    driver_torque_n_m: observed.driver_torques[0],
                    reactions: observed.reactions,
                    contacts: &mut LawPairs(built(gearbox, &mut field)?),
                });
            }
            before = t;
            if watch(t) {
                return Err(NativeError::Stopped);
            }
        }
        Ok(())
    };
    let ending = match samples() {
        Ok(()) => Ending::Finished,
        Err(NativeError::Ended(ending)) => ending,
        Err(other) => return Err(other),
    };
    Ok(NativeRun {
        time_series: recorder.finish()?,
        counts: stepper.counts(),
        newton_steps: system.newton_steps(),
        degrees_of_freedom: system.degrees_of_freedom(),
        joint_drift_m,
        end_s: stepper.time(),
        energy,
        ending,
    })
}

/// Ends a run at the given time, s, with the given message.
fn diverged(time_s: f64) -> impl FnOnce(String) -> NativeError {
    move |quantity| NativeError::Ended(Ending::Diverged { time_s, quantity })
}

/// Returns a contact field separate from that of the equations, built when first needed.
fn built<'a>(
    gearbox: &Gearbox,
    field: &'a mut Option<ContactField>,
) -> Result<&'a mut ContactField, GearboxError> {
    Ok(match field {
        Some(field) => field,
        None => field.insert(gearbox.contact_field()?),
    })
}

/// Returns the contacts' energy from the observation, or from a new evaluation if it lacks the energy.
fn contact_energy(
    observed: &Observation<'_>,
    gearbox: &Gearbox,
    field: &mut Option<ContactField>,
) -> Result<ContactEnergy, GearboxError> {
    match observed.energy {
        Some(energy) => Ok(energy),
        None => Ok(built(gearbox, field)?.energy(observed.bodies)),
    }
}

/// Makes a step.
fn advance<F: Formulation>(
    stepper: &mut Segments,
    system: &mut F,
    limits: Limits,
    pace: &mut Pace,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<(), NativeError> {
    if pace.is_due() {
        let (time, counts) = (stepper.time(), stepper.counts());
        if counts.evaluations > limits.evaluations {
            let reason = format!("more than {:.1e} evaluations", limits.evaluations as f64);
            return Err(diverged(time)(reason));
        }
        if watch(time) {
            return Err(NativeError::Stopped);
        }
        pace.look(time, counts.steps).map_err(diverged(time))?;
    }
    stepper.step(system).map_err(|error| {
        let (StepError::NotFinite { time } | StepError::StepTooSmall { time }) = error;
        diverged(time)(error.to_string())
    })
}
