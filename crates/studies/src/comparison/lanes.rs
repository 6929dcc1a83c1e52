//! Engines of a comparison in parallel: on threads, with Python engines on one of them or in separate processes.
//!
//! ```text
//!  engines ──the dearest first──> jobs threads ──> refine ──> participants in the engines' order
//!            in Python: another process refines ahead and stores its runs for refine
//! ```
//! CPU time is measured by the clock of each run's own thread or process, so that it does not depend on the number of parallel
//! runs. Neither do the results of an engine.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use pinwheel_compare::{Context, Divergence, Evidence, Participant, SharedModel};
use pinwheel_engines::Engine;
use pinwheel_engines::kept::{self, Store};
use pinwheel_gearbox::Gearbox;

use super::refine::{Refiner, refine};
use super::{Effort, Input, context};
use crate::StudyError;
use crate::control::{Control, Progress};
use crate::output::OutputError;
use crate::pool::{self, lock};
use crate::provenance::{Provenance, SOURCES};

/// Function that refines an engine, by its name and the scene's divergence, in another process that stores its runs, see
/// [`ahead`].
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

/// Opens the store of other projects' runs, see [`kept`]; `None` if none are stored. `fresh`: only runs from now on are used.
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
            let usual = |k: &usize| match engines[*k].info() {
                info if info.in_python && info.track == SharedModel::OwnContact => 30.0,
                info if info.in_python => 20.0,
                info if info.outside => 10.0,
                _ => 1.0,
            };
            let cost = |k: &usize| lock(&board.lanes).0[*k].cost_s.unwrap_or(usual(k));
            order.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
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
                let found = refine(engines[k], input.gearbox, context, effort, at, control)?;
                Ok((k, found))
            })
        };
        let work = |(): &mut (), piece: usize| {
            let piece = pieces[piece].iter();
            piece.map(|&k| one(k)).collect::<Result<Vec<_>, _>>()
        };
        let (found, fault) = pool::map(self.jobs, pieces.len(), || (), work);
        if let Some(fault) = fault {
            return Err(fault);
        }
        let mut found: Vec<_> = found.into_iter().flatten().flatten().collect();
        found.sort_by_key(|(k, _)| *k);
        Ok(found.into_iter().map(|(_, found)| found).unzip())
    }
}

/// Time between two reports.
const EVERY: Duration = Duration::from_millis(100);

/// State of one engine.
struct Lane<'a> {
    name: &'a str,
    /// CPU time of its latest stored runs, s.
    cost_s: Option<f64>,
    /// True if it runs once.
    once: bool,
    begun: Option<Instant>,
    /// Remaining time, s, with the time of the report.
    left: Option<(Instant, f64)>,
    /// Duration of the work, s.
    took: Option<f64>,
}

impl Lane<'_> {
    fn since_s(&self) -> f64 {
        self.begun
            .map_or(0.0, |begun| begun.elapsed().as_secs_f64())
    }

    /// Returns the remaining time, s, if known; `pace`: present duration of one second of the estimate.
    fn left_s(&self, pace: f64) -> Option<f64> {
        match self.left {
            _ if self.took.is_some() => Some(0.0),
            Some((at, left)) => Some((left - at.elapsed().as_secs_f64()).max(0.0)),
            // Once the stored cost is exceeded, the remaining time is unknown.
            None => Some(self.cost_s? * pace - self.since_s()).filter(|left| *left >= 0.0),
        }
    }
}

/// Common progress report of parallel engines.
struct Board<'a> {
    control: &'a Control<'a>,
    jobs: usize,
    /// Engines, with the time of the last report.
    lanes: Mutex<(Vec<Lane<'a>>, Instant)>,
}

impl<'a> Board<'a> {
    fn new(
        engines: &[&'a dyn Engine],
        gearbox: &Gearbox,
        lanes: &Lanes<'_>,
        control: &'a Control<'a>,
    ) -> Self {
        let lane = |engine: &&'a dyn Engine| Lane {
            name: engine.name(),
            cost_s: lanes
                .store
                .and_then(|store| store.cost_s(engine.name(), &gearbox.scene)),
            once: Refiner::of(*engine, gearbox.clone()).is_none(),
            begun: None,
            left: None,
            took: None,
        };
        Self {
            control,
            jobs: lanes.jobs.max(1),
            lanes: Mutex::new((engines.iter().map(lane).collect(), Instant::now())),
        }
    }

    /// Does the work of an engine and records its progress.
    fn watch<T>(
        &self,
        k: usize,
        work: impl FnOnce(Progress<'_>, &Control<'_>) -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        self.control.check()?;
        let name = self.change(k, true, |lane| {
            lane.begun = Some(Instant::now());
            lane.name
        });
        let heard = |at: Progress<'_>| {
            self.change(k, false, |lane| {
                let since = lane.since_s();
                let by_pace = |[at, of]: [f64; 2]| since * (of - at).max(0.0) / at;
                let paced = at.simulated_s.filter(|_| lane.once).map(by_pace);
                let left = at.left_s.or(paced).filter(|left| left.is_finite());
                lane.left = left.map(|left| (Instant::now(), left)).or(lane.left);
            });
        };
        let control = self.control.limited(self.control.cancel, &heard);
        let done = work(Progress::new(0, 1, name), &control);
        self.change(k, false, |lane| lane.took = Some(lane.since_s()));
        done
    }

    /// Changes the state of an engine and reports, at once or when a report is due.
    fn change<T>(&self, k: usize, at_once: bool, by: impl FnOnce(&mut Lane<'a>) -> T) -> T {
        let (lanes, told) = &mut *lock(&self.lanes);
        let changed = by(&mut lanes[k]);
        if at_once || told.elapsed() >= EVERY {
            *told = Instant::now();
            let runs = lanes
                .iter()
                .filter(|lane| lane.begun.is_some() && lane.took.is_none());
            let runs: Vec<&str> = runs.map(|lane| lane.name).collect();
            let done = lanes
                .iter()
                .filter_map(|lane| Some((lane.took?, lane.cost_s)));
            let known = done.clone().filter_map(|(took, cost)| Some((took, cost?)));
            let [took, cost] = known.fold([0.0; 2], |[a, b], (took, cost)| [a + took, b + cost]);
            // A busy machine is slower; stored runs are faster.
            let pace = if took > cost && cost > 0.0 {
                took / cost
            } else {
                1.0
            };
            let left = lanes.iter().map(|lane| lane.left_s(pace));
            let left = left.collect::<Option<Vec<f64>>>();
            (self.control.progress)(Progress {
                // Longest remaining time, or the total over the number of lanes if larger.
                left_s: left.map(|left| {
                    let longest = left.iter().copied().fold(0.0, f64::max);
                    longest.max(left.iter().sum::<f64>() / self.jobs as f64)
                }),
                ..Progress::new(done.count() + 1, lanes.len() + 1, &runs.join(", "))
            });
        }
        changed
    }
}
