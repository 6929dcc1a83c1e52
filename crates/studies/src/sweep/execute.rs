//! Runs over all cores: threads take the next run until there is none.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use pinwheel_courses::Ending;
use pinwheel_engines::{Engine, EngineError, by_name};

use crate::control::{Control, Progress};
use crate::pool::{self, lock};
use crate::sweep::journal::Journal;
use crate::sweep::record::{RunRecord, identity, program};
use crate::sweep::{Plan, PlannedRun, SweepError};

/// What all threads share.
struct Shared<'a> {
    plan: &'a Plan,
    journal: &'a Journal,
    control: &'a Control<'a>,
    duration_s: f64,
    finished: AtomicUsize,
    /// Simulated time, microseconds.
    simulated_us: AtomicU64,
    records: Mutex<Vec<Option<RunRecord>>>,
    fault: Mutex<Option<SweepError>>,
}

/// Runs what the journal does not hold, on `jobs` threads; the records are in the plan's order.
///
/// # Errors
/// [`SweepError::Stopped`] when cancelled, with the finished runs in the journal; a journal that cannot
/// be written.
pub fn execute(
    plan: &Plan,
    journal: &Journal,
    jobs: usize,
    control: &Control<'_>,
) -> Result<Vec<RunRecord>, SweepError> {
    let shared = Shared {
        plan,
        journal,
        control,
        duration_s: plan.duration_s(),
        finished: AtomicUsize::new(0),
        simulated_us: AtomicU64::new(0),
        records: Mutex::new(vec![None; plan.runs.len()]),
        fault: Mutex::new(None),
    };
    pool::each(jobs, plan.runs.len(), || (), |(), k| shared.work(k));
    let fault = shared
        .fault
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(fault) = fault {
        return Err(fault);
    }
    let records = shared
        .records
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let finished = records.iter().flatten().count();
    let whole: Option<Vec<RunRecord>> = records.into_iter().collect();
    whole.ok_or(SweepError::Stopped {
        finished,
        runs: plan.runs.len(),
    })
}

impl Shared<'_> {
    /// Run `k`; false when no other is to begin.
    fn work(&self, k: usize) -> bool {
        if self.control.is_cancelled() {
            return false;
        }
        match self.one(&self.plan.runs[k]) {
            Ok(Some(record)) => {
                lock(&self.records)[k] = Some(record);
                self.finished.fetch_add(1, Ordering::Relaxed);
                self.report();
                true
            }
            Ok(None) => false,
            Err(fault) => {
                lock(&self.fault).get_or_insert(fault);
                false
            }
        }
    }

    fn report(&self) {
        let simulated = self.simulated_us.load(Ordering::Relaxed) as f64 * 1e-6;
        let done = self.finished.load(Ordering::Relaxed);
        (self.control.progress)(Progress {
            simulated_s: Some([simulated, self.duration_s]),
            ..Progress::new(done, self.plan.runs.len(), &self.plan.sweep.name)
        });
    }

    /// One run, from the journal or anew; `None` when cancelled.
    fn one(&self, planned: &PlannedRun) -> Result<Option<RunRecord>, SweepError> {
        let duration = planned.scene.solver.duration_s;
        let keep = self.plan.sweep.courses;
        let Some(engine) = by_name(&planned.engine, &planned.scene) else {
            // Planned, so it was there; a registry does not change while the program runs.
            return Err(SweepError::Run {
                number: planned.number,
                values: crate::sweep::plan::in_words(&planned.values),
                what: format!("engine `{}` is gone", planned.engine),
            });
        };
        let scene = planned.scene.to_toml();
        let version = env!("CARGO_PKG_VERSION");
        let wanted = identity(
            engine.name(),
            &engine.version(),
            version,
            program(),
            planned.window_s,
            &scene,
        );
        if let Some(record) = self.journal.find(&wanted, keep) {
            self.simulated_us
                .fetch_add((duration * 1e6) as u64, Ordering::Relaxed);
            return Ok(Some(record));
        }
        let seen_us = AtomicU64::new(0);
        let reached = |time_s: f64| {
            let now = (time_s.clamp(0.0, duration) * 1e6) as u64;
            let before = seen_us.swap(now, Ordering::Relaxed);
            self.simulated_us
                .fetch_add(now.saturating_sub(before), Ordering::Relaxed);
            self.report();
        };
        let control = pinwheel_engines::Control {
            cancel: self.control.cancel,
            progress: &reached,
        };
        let ran = engine.run(&planned.scene, &control);
        let Some((record, run)) = judged(planned, engine.as_ref(), ran) else {
            return Ok(None);
        };
        reached(duration);
        let nothing = pinwheel_courses::Courses::default();
        let courses = run.as_ref().map_or(&nothing, |run| &run.courses);
        let how = if record.ending.is_finished() {
            keep
        } else {
            crate::sweep::KeepCourses::None
        };
        self.journal.keep(&record, courses, how)?;
        Ok(Some(record))
    }
}

/// The record of a run, and the run if it is complete; `None` when cancelled.
fn judged(
    planned: &PlannedRun,
    engine: &dyn Engine,
    ran: Result<pinwheel_engines::Run, EngineError>,
) -> Option<(RunRecord, Option<pinwheel_engines::Run>)> {
    let empty = |ending: Ending| RunRecord::empty(planned, engine, ending);
    Some(match ran {
        Ok(mut run) => {
            run.note_missing_channels(&planned.scene);
            let record = empty(Ending::Finished)
                .with_cost(&run)
                .with_figures(planned, &run);
            (record, Some(run))
        }
        Err(EngineError::Diverged {
            time_s,
            quantity,
            partial,
            ..
        }) => (
            empty(Ending::Diverged { time_s, quantity }).with_cost(&partial),
            None,
        ),
        Err(EngineError::Unsupported { reason, .. }) => {
            (empty(Ending::Unsupported { reason }), None)
        }
        Err(EngineError::Failed { reason, .. }) => (empty(Ending::Failed { reason }), None),
        Err(EngineError::Cancelled) => return None,
    })
}
