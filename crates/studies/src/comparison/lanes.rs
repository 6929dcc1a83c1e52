//! Engines of a comparison in parallel: on threads, with Python engines on one of them or in separate processes.
//!
//! ```text
//!  engines ──the dearest first──> jobs threads ──> refine ──> participants in the engines' order
//!            in Python: another process refines ahead and stores its runs for refine
//! ```
//! CPU time is measured by the clock of each run's own thread or process. CPU times and results therefore do not depend on the
//! number of parallel runs.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use pinwheel_compare::{Context, Divergence, Evidence, Participant};
use pinwheel_engines::kept::{self, Store};
use pinwheel_engines::{Engine, needs};
use pinwheel_gearbox::Gearbox;

use super::outlook::{Foretold, Outlook, left_s};
use super::refine::refine;
use super::{Effort, Input, context};
use crate::StudyError;
use crate::control::{Control, Progress};
use crate::output::OutputError;
use crate::pool::{self, lock};
use crate::provenance::{Provenance, SOURCES};

/// Function that refines an engine in another process, which stores its runs; see [`ahead`]. It receives the engine's name and
/// the scene's divergence.
pub type Ahead<'a> = &'a (dyn Fn(&str, Option<&Divergence>, &Control<'_>) + Sync);

/// Resources of a comparison.
#[derive(Clone, Copy, Default)]
pub struct Lanes<'a> {
    /// Number of engines that run at a time; 0 counts as 1.
    pub jobs: usize,
    /// Store of the engines' runs.
    pub store: Option<&'a Store>,
    /// Separate processes for Python engines, which otherwise share an interpreter.
    pub ahead: Option<Ahead<'a>>,
}

/// Opens the store of other projects' runs, see [`kept`]; `None` if none are stored. With `fresh`, only runs from now on are
/// used.
///
/// # Errors
/// The store's folder cannot be written.
pub fn store(fresh: bool) -> Result<Option<Arc<Store>>, OutputError> {
    let Some(folder) = kept::folder() else {
        return Ok(None);
    };
    let here = Provenance::here("");
    let store = Store::open(&folder, fresh, SOURCES, (here.machine.named(), here.date));
    let store = store.map_err(|error| OutputError::new(&folder, &error))?;
    Ok(Some(Arc::new(store)))
}

/// Refines one engine and stores its runs for another process that compares.
///
/// # Errors
/// Cancelled, or a scene that cannot be modelled.
pub fn ahead(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    divergence: Option<Divergence>,
    effort: Effort,
    control: &Control<'_>,
) -> Result<(), StudyError> {
    let context = Context {
        divergence,
        ..context(&gearbox.scene)
    };
    let board = Board::new(&[engine], gearbox, &Lanes::default(), control);
    board.watch(0, |at, control| {
        refine(engine, gearbox, &context, effort, at, control)
    })?;
    Ok(())
}

impl Lanes<'_> {
    /// Returns the engines' participants and evidence, in order.
    pub(super) fn refine(
        &self,
        input: &Input<'_>,
        context: &Context,
        effort: Effort,
        control: &Control<'_>,
    ) -> Result<(Vec<Participant>, Vec<Evidence>), StudyError> {
        let engines: Vec<&dyn Engine> = input.engines.iter().map(AsRef::as_ref).collect();
        let board = Board::new(&engines, input.gearbox, self, control);
        let in_python = |k: &usize| self.jobs > 1 && engines[*k].info().in_python;
        let ahead = self.ahead.filter(|_| self.jobs > 1 && self.store.is_some());
        let mut order: Vec<usize> = (0..engines.len()).collect();
        if self.jobs > 1 {
            let usual = |k: &usize| lock(&board.lanes).0[*k].outlook.usual_s;
            order.sort_by(|a, b| usual(b).total_cmp(&usual(a)));
        }
        // Without separate processes they are one piece of work.
        let (together, alone): (Vec<usize>, Vec<usize>) = order
            .into_iter()
            .partition(|k| ahead.is_none() && in_python(k));
        let pieces = [together]
            .into_iter()
            .chain(alone.into_iter().map(|k| vec![k]));
        let pieces: Vec<Vec<usize>> = pieces.filter(|piece| !piece.is_empty()).collect();
        let interpreter = Mutex::new(());
        let one = |k: usize| {
            board.watch(k, |at, control| {
                let lane = in_python(&k).then_some(engines[k].name());
                if let (Some(name), Some(ahead)) = (lane, ahead) {
                    ahead(name, context.divergence.as_ref(), control);
                }
                let _alone = lane.map(|_| lock(&interpreter));
                let refined = refine(engines[k], input.gearbox, context, effort, at, control)?;
                Ok((k, refined))
            })
        };
        let work = |(): &mut (), piece: usize| {
            let piece = pieces[piece].iter();
            piece.map(|&k| one(k)).collect::<Result<Vec<_>, _>>()
        };
        let (refined, fault) = pool::map(self.jobs, pieces.len(), || (), work);
        if let Some(fault) = fault {
            return Err(fault);
        }
        let mut refined: Vec<_> = refined.into_iter().flatten().flatten().collect();
        refined.sort_by_key(|(k, _)| *k);
        Ok(refined.into_iter().map(|(_, refined)| refined).unzip())
    }
}

/// Time between two reports.
const EVERY: Duration = Duration::from_millis(100);

/// State of one engine.
struct Lane<'a> {
    name: &'a str,
    outlook: Outlook,
}

/// Common progress report of parallel engines.
struct Board<'a> {
    control: &'a Control<'a>,
    jobs: usize,
    begun: Instant,
    /// Engines, with the time of the last report and the ends it foretold.
    lanes: Mutex<(Vec<Lane<'a>>, Instant, Foretold)>,
}

impl<'a> Board<'a> {
    fn new(
        engines: &[&'a dyn Engine],
        gearbox: &Gearbox,
        lanes: &Lanes<'_>,
        control: &'a Control<'a>,
    ) -> Self {
        let lane = |engine: &&'a dyn Engine| {
            let info = engine.info();
            // Python installs its packages at the first run; a user's solver is asked once.
            let is_absent = !info.in_python && needs(&info).is_some();
            let is_idle = is_absent || !info.brought && engine.prepare(gearbox).is_err();
            let stored = lanes.store.filter(|_| !is_idle);
            let stored = stored.and_then(|store| store.cost_s(info.name, &gearbox.scene));
            let usual_s = if is_idle { 0.0 } else { info.usual_s };
            Lane {
                name: engine.name(),
                outlook: Outlook {
                    measured: stored.is_some(),
                    ..Outlook::usual(stored.unwrap_or(usual_s))
                },
            }
        };
        let now = Instant::now();
        Self {
            control,
            jobs: lanes.jobs.max(1),
            begun: now,
            lanes: Mutex::new((engines.iter().map(lane).collect(), now, Foretold::default())),
        }
    }

    /// Does the work of an engine and records its progress.
    fn watch<T>(
        &self,
        k: usize,
        work: impl FnOnce(Progress<'_>, &Control<'_>) -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        self.control.check()?;
        let name = self.change(k, true, |lane, now_s| {
            lane.outlook.begun_s = Some(now_s);
            lane.name
        });
        let report = |at: Progress<'_>| {
            self.change(k, false, |Lane { outlook, .. }, now_s| {
                let left = at.left_s.filter(|left| left.is_finite());
                outlook.reported_s = left.map(|left| [now_s, left]).or(outlook.reported_s);
            });
        };
        let control = self.control.limited(self.control.cancel, &report);
        let done = work(Progress::new(0, 1, name), &control);
        self.change(k, false, |lane, now_s| lane.outlook.ended_s = Some(now_s));
        done
    }

    /// Changes the state of an engine, given the time, s, and reports, at once or when a report is due.
    fn change<T>(&self, k: usize, at_once: bool, by: impl FnOnce(&mut Lane<'a>, f64) -> T) -> T {
        let (lanes, reported, foretold) = &mut *lock(&self.lanes);
        let now_s = self.begun.elapsed().as_secs_f64();
        let changed = by(&mut lanes[k], now_s);
        if at_once || reported.elapsed() >= EVERY {
            *reported = Instant::now();
            let all: Vec<Outlook> = lanes.iter().map(|lane| lane.outlook).collect();
            let runs = lanes.iter();
            let runs = runs
                .filter(|lane| lane.outlook.begun_s.is_some() && lane.outlook.ended_s.is_none());
            let runs: Vec<&str> = runs.map(|lane| lane.name).collect();
            let done = all.iter().filter(|one| one.ended_s.is_some()).count();
            (self.control.progress)(Progress {
                left_s: foretold.steady(left_s(&all, self.jobs, now_s), now_s),
                ..Progress::new(done + 1, lanes.len() + 1, &runs.join(", "))
            });
        }
        changed
    }
}
