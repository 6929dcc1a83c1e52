//! Run common to the three engines: steps, samples, guards, cost.
//!
//! A sample at t_n is taken after the step from t_n, because only then the half-step velocities on both sides, and the impulses
//! over it, are known.

use std::time::Instant;

use cpu_time::ThreadTime;
use pinwheel_gearbox::channels::{EngineState, PairSource};
use pinwheel_gearbox::{Gearbox, Recorder, guard};
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{FrictionLaw, Scene};
use pinwheel_scene::{Layout, load_profile};

use super::reactions::reactions;
use super::sums::Evaluation;
use super::world::World;
use crate::control::{Cancelled, Control};
use crate::engine::{Ending, Halt, Run, RunStats};

/// Source of the contact forces, which differs between the engines.
pub trait Contacts {
    /// Takes one step of `world` under contact forces and `loads` (initially the load torque only). `now`: states at t_n with
    /// extrapolated velocities.
    ///
    /// # Errors
    /// Quantity that diverged.
    fn step(
        &mut self,
        world: &mut World,
        now: &[BodyState],
        loads: &mut [Wrench],
    ) -> Result<(), String>;

    /// Sums the contact forces at t_n; called right after the step from t_n. `now`: states at t_n with centred velocities.
    /// `share`: of the step, see [`World::share`].
    fn forces(&mut self, world: &World, now: &[BodyState], share: f64, sums: &mut Evaluation);

    /// Returns the figures of single contacts at t_n for channels, at the time of [`forces`](Self::forces).
    fn pair_source<'a>(&'a mut self, world: &'a World, share: f64) -> Box<dyn PairSource + 'a>;
}

/// Grid of steps with the scene's samples.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Step h, s.
    pub step_s: f64,
    /// Node number and time of every sample.
    pub samples: Vec<(u64, f64)>,
}

impl Grid {
    /// Creates a grid with nodes at multiples of `step_s`, and every sample on a node.
    ///
    /// # Errors
    /// Message with the remedy, if `step_s` does not divide the sampling step or the duration.
    pub fn new(scene: &Scene, step_s: f64) -> Result<Self, Ending> {
        let solver = &scene.solver;
        let integer = |ratio: f64| ratio > 0.5 && (ratio - ratio.round()).abs() <= 1e-6;
        let per_sample = solver.sample_s / step_s;
        if !integer(per_sample) {
            return Err(Ending::unsupported(format!(
                "its steps are equal and its samples lie on them; choose solver.step_s so that \
                 solver.sample_s = {} s is a whole number of steps, not {per_sample:.6}",
                solver.sample_s
            )));
        }
        let step_s = solver.sample_s / per_sample.round();
        let mut samples = Vec::new();
        for time in solver.sample_times_s() {
            let node = time / step_s;
            if time > 0.0 && !integer(node) {
                return Err(Ending::unsupported(format!(
                    "its steps are equal and its samples lie on them; choose solver.duration_s as a whole number \
                     of steps of {step_s} s, not {node:.6}"
                )));
            }
            samples.push((node.round() as u64, time));
        }
        Ok(Self { step_s, samples })
    }
}

/// Refuses friction laws that rapier's own friction does not support.
pub fn friction_is_plain(scene: &Scene) -> Result<(), Ending> {
    let contact = &scene.contact;
    if contact.friction_coefficient > 0.0 && contact.friction_law != FrictionLaw::Regularised {
        return Err(Ending::unsupported(
            "rapier's friction has one coefficient at all speeds; use contact.friction_law = \"regularised\"",
        ));
    }
    Ok(())
}

/// Advances `contacts` over the grid, with one evaluation of Pinwheel's law per step; `settings` in words.
///
/// # Errors
/// A stop, or a failure if the samples give no time series. A divergence keeps the time series so far.
pub fn march(
    gearbox: &Gearbox,
    mut world: World,
    contacts: &mut dyn Contacts,
    grid: &Grid,
    settings: String,
    control: &Control<'_>,
) -> Result<Run, Halt> {
    let (wall, cpu) = (Instant::now(), ThreadTime::now());
    let layout = gearbox.layout;
    let mut recorder = Recorder::new(gearbox);
    let mut sums = Evaluation::new(layout);
    let mut now: Vec<BodyState> = Vec::with_capacity(layout.bodies());
    let mut loads = vec![Wrench::default(); layout.bodies()];
    let mut samples = grid.samples.iter().peekable();
    let mut joints = Vec::new();
    let mut drift: f64 = 0.0;
    let (mut node, mut law_calls): (u64, u64) = (0, 0);
    let mut ran_away = None;

    while let Some(&&(sample_node, sample_s)) = samples.peek() {
        let time_s = node as f64 * grid.step_s;
        world.at_node(&mut now);
        loads.fill(Wrench::default());
        loads[Layout::OUTPUT].moment = load(gearbox, time_s, grid.step_s);
        let share = world.share();
        if node == sample_node {
            if let Err(quantity) = guard::check(gearbox, &now) {
                ran_away = Some((sample_s, quantity));
                break;
            }
            drift = drift.max(world.joint_drift());
        }
        law_calls += 1;
        if let Err(quantity) = contacts.step(&mut world, &now, &mut loads) {
            ran_away = Some((time_s, quantity));
            break;
        }
        if node == sample_node {
            world.centre(&mut now);
            sums.clear();
            contacts.forces(&world, &now, share, &mut sums);
            let driver_torque_n_m = sums.driver_torque(&now, gearbox.floats())
                + gearbox.accelerating_torque_n_m(sample_s);
            recorder.record_forces(
                sample_s,
                driver_torque_n_m,
                &now,
                &sums.sleeves,
                sums.output_n_m,
            );
            if recorder.wants_channels() {
                reactions(gearbox, &world, &sums, &mut joints);
                recorder.record_channels(&mut EngineState {
                    bodies: &now,
                    driver_torque_n_m,
                    // Floating discs have no joint, so the list of reactions differs.
                    reactions: (!gearbox.floats()).then_some(&joints[..]),
                    contacts: contacts.pair_source(&world, share).as_mut(),
                });
            }
            if control.reached(sample_s) {
                return Err(Cancelled.into());
            }
            samples.next();
        }
        node += 1;
    }

    let stats = RunStats {
        wall_s: wall.elapsed().as_secs_f64(),
        cpu_s: cpu.elapsed().as_secs_f64(),
        rhs_calls: law_calls,
        steps: node,
        // Every body but the driven one keeps its three velocities.
        degrees_of_freedom: 3 * (layout.bodies() - 1),
        bodies: layout.bodies(),
        step_s: grid.step_s,
        settings,
        joint_drift_m: Some(drift),
        ..RunStats::default()
    };
    let run = Run::new(recorder.finish().map_err(Ending::failed)?, stats);
    Ok(match ran_away {
        None => run,
        Some((time_s, quantity)) => run.with_ending(Ending::Diverged { time_s, quantity }),
    })
}

/// Returns the load on the output shaft in the step from the node at `time_s`, N m.
///
/// The leapfrog's kick acts from half a step before the node to half a step after, the first one from the node on. A load that
/// changes within it has its mean: the impulse is then exact and the method of second order, for a change anywhere in the step.
fn load(gearbox: &Gearbox, time_s: f64, step_s: f64) -> f64 {
    let drive = &gearbox.scene.drive;
    if drive.load_changes.is_empty() {
        return gearbox.load_torque(time_s);
    }
    let (from, to) = ((time_s - 0.5 * step_s).max(0.0), time_s + 0.5 * step_s);
    load_profile::mean(drive, from, to)
}
