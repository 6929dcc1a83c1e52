//! Runs of the set: results, counts and times, on one thread or several.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use cpu_time::ThreadTime;
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_scene::Scene;
use serde::{Deserialize, Serialize};

use super::instructions::Counter;
use super::quantity::{self, Values};
use super::yardstick;
use crate::StudyError;
use crate::control::{self, Control, Progress};
use crate::pool;

/// What a run cost.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Costs {
    /// Evaluations of the contact forces.
    pub right_hand_sides: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejections: u64,
    /// Newton steps of implicit stages.
    pub newton_steps: u64,
    /// Instructions in user space, where the machine counts them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instructions: Option<u64>,
    /// CPU time over the yardstick's; `None` if it was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_ratio: Option<f64>,
}

/// A run that came to its end.
#[derive(Debug, Clone)]
pub(super) struct Finished {
    pub(super) time_s: Vec<f64>,
    pub(super) values: Vec<Values>,
    pub(super) costs: Costs,
}

/// How a run ended: with results, or diverged (in words).
pub(super) type Outcome = Result<Finished, String>;

/// One run to make.
#[derive(Debug, Clone)]
pub(super) struct Job {
    /// For progress.
    pub(super) label: String,
    pub(super) scene: Scene,
    pub(super) kernel: Kernel,
    /// A solver that joined instead of our own.
    pub(super) solver: Option<String>,
    /// Times it is run for its time; 0: time and instructions are not measured.
    pub(super) repeats: usize,
}

/// Makes one run of a solver from outside, which costs what it says, in CPU time of its own.
fn run_solver(job: &Job, solver: &str, cancel: &AtomicBool) -> Result<Outcome, StudyError> {
    let gearbox = control::compile(&job.scene)?;
    let (mut least, mut unit) = (f64::INFINITY, f64::INFINITY);
    for turn in 1.. {
        let run = control::run_on(solver, &job.scene, &Control::silent(cancel))?;
        if !run.ending.is_finished() {
            return Ok(Err(format!("{solver} {}", run.ending)));
        }
        least = least.min(run.stats.cpu_s);
        if job.repeats > 0 {
            unit = unit.min(yardstick::measure());
        }
        if turn >= job.repeats {
            // It keeps no account of energy, and not all have joints.
            let stats = &run.stats;
            let mut values = quantity::values(&gearbox, &run.courses, None, stats.joint_drift_m);
            values.retain(|v| v.count() > 0);
            return Ok(Ok(Finished {
                time_s: run.courses.time_s().to_vec(),
                values,
                costs: Costs {
                    right_hand_sides: stats.rhs_calls,
                    steps: stats.steps,
                    rejections: stats.rejected_steps,
                    newton_steps: 0,
                    instructions: None,
                    time_ratio: (job.repeats > 0 && unit > 0.0).then_some(least / unit),
                },
            }));
        }
    }
    Ok(Err("never ran".to_owned()))
}

/// Makes one run on this thread.
pub(super) fn run(
    job: &Job,
    cancel: &AtomicBool,
    counter: &mut Counter,
) -> Result<Outcome, StudyError> {
    if let Some(solver) = &job.solver {
        return run_solver(job, solver, cancel);
    }
    let mut gearbox = control::compile(&job.scene)?;
    gearbox.kernel = job.kernel;
    let go = || control::run_compiled(&gearbox, &mut |_| cancel.load(Ordering::Relaxed));
    let (mut least, mut unit) = (f64::INFINITY, f64::INFINITY);
    let mut instructions = None;
    let mut result = None;
    for _ in 0..job.repeats {
        unit = unit.min(yardstick::measure());
        let start = ThreadTime::now();
        let (run, count) = counter.count(go);
        least = least.min(start.elapsed().as_secs_f64());
        unit = unit.min(yardstick::measure());
        instructions = count;
        result = Some(run);
    }
    let run = result.unwrap_or_else(go)?;
    if !run.ending.is_finished() {
        return Ok(Err(run.ending.to_string()));
    }
    Ok(Ok(Finished {
        time_s: run.courses.time_s().to_vec(),
        values: quantity::values(
            &gearbox,
            &run.courses,
            run.energy.total(),
            Some(run.joint_drift_m),
        ),
        costs: Costs {
            right_hand_sides: run.counts.evaluations,
            steps: run.counts.steps,
            rejections: run.counts.rejected,
            newton_steps: run.newton_steps,
            instructions,
            time_ratio: (job.repeats > 0 && unit > 0.0).then_some(least / unit),
        },
    }))
}

/// Makes all runs; outcomes in the order of the jobs, the same to the bit for any number of `threads`
/// (with one, this thread makes them).
pub(super) fn run_all(
    jobs: &[Job],
    threads: usize,
    control: &Control<'_>,
) -> Result<Vec<Outcome>, StudyError> {
    let begun = AtomicUsize::new(0);
    let outcomes: Vec<Mutex<Option<Outcome>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    let failed = Mutex::new(None);
    pool::each(threads, jobs.len(), Counter::new, |counter, k| {
        let done = begun.fetch_add(1, Ordering::Relaxed);
        (control.progress)(Progress::new(done, jobs.len(), &jobs[k].label));
        match run(&jobs[k], control.cancel, counter) {
            Ok(outcome) => *pool::lock(&outcomes[k]) = Some(outcome),
            Err(error) => {
                pool::lock(&failed).get_or_insert(error);
                return false;
            }
        }
        true
    });
    match pool::lock(&failed).take() {
        Some(error) => Err(error),
        None => Ok(outcomes
            .iter()
            .filter_map(|outcome| pool::lock(outcome).take())
            .collect()),
    }
}
