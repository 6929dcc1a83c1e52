//! Runs of the set of scenes on one thread or several, with results and counts.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_scene::Scene;
use pinwheel_timeseries::Ending;
use serde::{Deserialize, Serialize};

use super::snapshot::{self, Quantity, Statistics};
use crate::StudyError;
use crate::control::{self, Control, Progress};
use crate::pool;

/// Cost of a run.
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
}

/// Results of a run that finished.
#[derive(Debug, Clone)]
pub(super) struct Finished {
    pub(super) statistics: BTreeMap<Quantity, Statistics>,
    pub(super) costs: Costs,
    /// Hash of every bit of every sample.
    pub(super) bits: u64,
}

/// Results of a run, or the ending of one without.
pub(super) type RunResult = Result<Finished, Ending>;

/// Description of one run.
#[derive(Debug, Clone)]
pub(super) struct Job {
    /// Name in the progress display.
    pub(super) label: String,
    pub(super) scene: Scene,
    pub(super) kernel: Kernel,
    /// Name of a user's solver in place of the native one.
    pub(super) solver: Option<String>,
}

/// Makes one run on this thread.
fn run(job: &Job, cancel: &AtomicBool) -> Result<RunResult, StudyError> {
    let mut gearbox = control::compile(&job.scene)?;
    gearbox.kernel = job.kernel;
    let (ending, time_series, costs, account, joint_m) = match &job.solver {
        None => {
            let mut watch = |_| cancel.load(Ordering::Relaxed);
            let run = control::run_compiled(&gearbox, &mut watch)?;
            let costs = Costs {
                right_hand_sides: run.counts.evaluations,
                steps: run.counts.steps,
                rejections: run.counts.rejected,
                newton_steps: run.newton_steps,
            };
            let (account, joint_m) = (run.energy.total(), Some(run.joint_drift_m));
            (run.ending, run.time_series, costs, account, joint_m)
        }
        // A user's solver has no energy balance, and may have no joints.
        Some(solver) => {
            let run = control::run_on(solver, &job.scene, &Control::silent(cancel))?;
            let costs = Costs {
                right_hand_sides: run.stats.rhs_calls,
                steps: run.stats.steps,
                rejections: run.stats.rejected_steps,
                ..Costs::default()
            };
            let joint_m = run.stats.joint_drift_m;
            (run.ending, run.time_series, costs, None, joint_m)
        }
    };
    if !ending.is_finished() {
        return Ok(Err(ending));
    }
    Ok(Ok(Finished {
        statistics: snapshot::statistics(&gearbox, &time_series, account, joint_m),
        bits: snapshot::bits(&time_series),
        costs,
    }))
}

/// Makes all runs on a number of `threads`, with one on this thread. Results are in the order of the jobs and equal to the
/// bit for any number of threads.
pub(super) fn run_all(
    jobs: &[Job],
    threads: usize,
    control: &Control<'_>,
) -> Result<Vec<RunResult>, StudyError> {
    let begun = AtomicUsize::new(0);
    let make = |(): &mut (), k: usize| {
        let done = begun.fetch_add(1, Ordering::Relaxed);
        (control.progress)(Progress::new(done, jobs.len(), &jobs[k].label));
        run(&jobs[k], control.cancel)
    };
    match pool::map(threads, jobs.len(), || (), make) {
        (_, Some(error)) => Err(error),
        (results, None) => Ok(results.into_iter().flatten().collect()),
    }
}
