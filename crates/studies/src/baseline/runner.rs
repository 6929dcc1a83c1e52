//! Runs of the set: results and counts, on one thread or several.

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

/// A run that came to its end.
#[derive(Debug, Clone)]
pub(super) struct Finished {
    pub(super) statistics: BTreeMap<Quantity, Statistics>,
    pub(super) costs: Costs,
    /// Hash of every bit of every sample.
    pub(super) bits: u64,
}

/// Results, or how the run ended without.
pub(super) type RunResult = Result<Finished, Ending>;

/// One run to make.
#[derive(Debug, Clone)]
pub(super) struct Job {
    /// For progress.
    pub(super) label: String,
    pub(super) scene: Scene,
    pub(super) kernel: Kernel,
    /// A solver that joined instead of our own.
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
        // It keeps no account of energy, and not all have joints.
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

/// Makes all runs; results in the order of the jobs, the same to the bit for any number of `threads`
/// (with one, this thread makes them).
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
