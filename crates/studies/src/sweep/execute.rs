//! Runs on all cores: threads take the next run until none is left.

use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use pinwheel_engines::{Ending, Run};
use pinwheel_gearbox::Gearbox;

use crate::StudyError;
use crate::control::{Control, Progress};
use crate::pool;
use crate::provenance::SOURCES;
use crate::sweep::file::KeepTimeSeries;
use crate::sweep::journal::{Journal, keep_time_series};
use crate::sweep::record::{RunRecord, identity};
use crate::sweep::row::Rows;
use crate::sweep::{Plan, PlannedRun};

/// Largest number of progress reports of a run.
const TOLD: u64 = 100;

/// Data common to all threads.
struct Shared<'a> {
    plan: &'a Plan,
    journal: &'a Journal,
    control: &'a Control<'a>,
    duration_s: f64,
    begun: Instant,
    finished: AtomicUsize,
    /// Simulated time, microseconds.
    simulated_us: AtomicU64,
}

/// Runs everything that is missing in the journal, on `jobs` threads; returns their rows.
/// # Errors
/// [`StudyError::Stopped`] when cancelled, with the finished runs in the journal; a journal that cannot be written.
pub fn execute(
    plan: &Plan,
    journal: &Journal,
    jobs: usize,
    control: &Control<'_>,
) -> Result<Rows, StudyError> {
    let durations = (0..plan.len()).map(|run| plan.duration_s(run));
    let shared = Shared {
        plan,
        journal,
        control,
        duration_s: durations.sum(),
        begun: Instant::now(),
        finished: AtomicUsize::new(0),
        simulated_us: AtomicU64::new(0),
    };
    let rows = Mutex::new(Rows::new(plan.len()));
    let run = |last: &mut Option<Gearbox>, k: usize| {
        let record = shared.one(last, k)?;
        shared.finished.fetch_add(1, Ordering::Relaxed);
        shared.report();
        pool::lock(&rows).put(k, record);
        Ok(())
    };
    let (_, fault) = pool::map(jobs, plan.len(), || None, run);
    let rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    match fault {
        None => Ok(rows),
        Some(StudyError::Cancelled) => Err(StudyError::Stopped {
            finished: rows.done(),
            runs: plan.len(),
        }),
        Some(fault) => Err(fault),
    }
}

/// Returns the record of a run that needs no running: one that the journal has with its time series, or of values that make no gear.
/// `identity`: of [`wanted_of`].
pub fn find(
    plan: &Plan,
    planned: &PlannedRun,
    journal: &Journal,
    identity: &str,
) -> Option<RunRecord> {
    let Some(why) = &planned.refused else {
        return journal.find(identity, plan.sweep.time_series);
    };
    let run = Run::ended(Ending::unsupported(why));
    Some(RunRecord::of(planned, "", &run))
}

/// Returns the complete scene of a run as TOML, and the [`RunRecord::identity`] of its record.
pub fn wanted_of(planned: &PlannedRun) -> (String, String) {
    let (scene, engine) = (planned.scene.to_toml(), &planned.engine);
    let made_by = (engine.name(), &*engine.version(), &*engine.build());
    let ours = (env!("CARGO_PKG_VERSION"), SOURCES);
    let identity = identity(made_by, ours, planned.window_s, &scene);
    (scene, identity)
}

/// Performs a run, and stores its time series in the folder in the requested form. `scene`: its complete
/// scene as TOML; `last`: gearbox of the previous run ([`run_after`](pinwheel_engines::Engine::run_after)).
///
/// # Errors
/// Stopped; time series cannot be written.
pub fn perform(
    planned: &PlannedRun,
    scene: &str,
    (folder, keep): (&Path, KeepTimeSeries),
    last: &mut Option<Gearbox>,
    control: &Control<'_>,
) -> Result<RunRecord, StudyError> {
    let run = planned.engine.run_after(last, &planned.scene, control)?;
    let mut record = RunRecord::of(planned, scene, &run);
    if run.ending.is_finished() {
        record.time_series = keep_time_series(folder, &record.identity(), &run.time_series, keep)?;
    }
    Ok(record)
}

impl Shared<'_> {
    fn report(&self) {
        let simulated = self.simulated_us.load(Ordering::Relaxed) as f64 * 1e-6;
        let done = self.finished.load(Ordering::Relaxed);
        let left = (self.duration_s - simulated).max(0.0) / simulated;
        (self.control.progress)(Progress {
            simulated_s: Some([simulated, self.duration_s]),
            left_s: Some(left * self.begun.elapsed().as_secs_f64()),
            ..Progress::new(done, self.plan.len(), &self.plan.sweep.name)
        });
    }

    /// Returns one run, from the journal or computed.
    fn one(&self, last: &mut Option<Gearbox>, k: usize) -> Result<RunRecord, StudyError> {
        self.control.check()?;
        let planned = self.plan.run(k)?;
        let duration = self.plan.duration_s(k);
        let whole_us = (duration * 1e6) as u64;
        let keep = self.plan.sweep.time_series;
        let (scene, identity) = wanted_of(&planned);
        if let Some(record) = find(self.plan, &planned, self.journal, &identity) {
            self.simulated_us.fetch_add(whole_us, Ordering::Relaxed);
            return Ok(record);
        }
        let seen_us = AtomicU64::new(0);
        let reached = |at: Progress<'_>| {
            let time_s = at.simulated_s.map_or(0.0, |[time_s, _]| time_s);
            let now = (time_s.clamp(0.0, duration) * 1e6) as u64;
            // All threads write to one counter, so it is not updated at every sample.
            let before = seen_us.load(Ordering::Relaxed);
            if now < whole_us && now < before + whole_us / TOLD {
                return;
            }
            seen_us.store(now, Ordering::Relaxed);
            self.simulated_us
                .fetch_add(now.saturating_sub(before), Ordering::Relaxed);
            self.report();
        };
        let control = Control::new(self.control.cancel, &reached).lasting(duration);
        let place = (self.journal.folder(), keep);
        let record = perform(&planned, &scene, place, last, &control)?;
        let _ = control.reached(duration);
        self.journal.keep(&record)?;
        Ok(record)
    }
}
