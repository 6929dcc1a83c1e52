//! One engine and method at every setting, coarse to fine.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::Instant;

use cpu_time::ProcessTime;
use pinwheel_courses::Courses;
use pinwheel_engines::{Engine, EngineError, Run, Track};
use pinwheel_mbs::integrators;
use pinwheel_scene::{Fault, Scene};
use serde::Serialize;

use super::Options;
use super::front::{CostAt, cost_at};
use super::norms::{Errors, Least, Span, errors};
use super::settings::{Knob, State, Stopped, settings};
use crate::StudyError;
use crate::control::Control;

/// What a setting costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Least CPU time of the runs, s.
    pub cpu_min_s: f64,
    /// Their median, s.
    pub cpu_median_s: f64,
    /// How many there were.
    pub runs: usize,
    /// Evaluations of the contact forces in one run; `None` where the engine does not count them.
    pub rhs_calls: Option<u64>,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected_steps: u64,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "kebab-case")]
pub enum Ending {
    /// At its end.
    Finished,
    /// The numbers ran away.
    Diverged {
        /// When, s.
        time_s: f64,
        /// Which quantity.
        quantity: String,
    },
    /// It was given up because it took too long.
    GivenUp {
        /// Simulated time reached, s.
        time_s: f64,
    },
    /// The engine does not take this setting, or broke.
    Failed {
        /// Its own words.
        reason: String,
    },
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Step (s) or tolerance.
    pub setting: f64,
    /// How it ended.
    #[serde(rename = "outcome")]
    pub ending: Ending,
    /// Errors by window; empty unless it finished.
    pub errors: Vec<Errors>,
    /// What it cost; `None` if it did not run.
    pub cost: Option<Cost>,
}

/// One engine and method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// Engine.
    pub engine: String,
    /// Its version.
    pub version: String,
    /// Its track.
    pub track: Track,
    /// Integrator of ours, or `own`.
    pub method: String,
    /// Classical order, where it is one of ours.
    pub order: Option<u32>,
    /// What is turned.
    pub knob: Knob,
    /// Settings tried, coarse to fine.
    pub points: Vec<Point>,
    /// Why there is no finer one.
    pub stopped: Stopped,
}

/// Which cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Least CPU time, s.
    Cpu,
    /// Right-hand-side calls.
    Rhs,
}

impl Series {
    /// For legends: `native-reduced rk4`, `rapier-shared-law`.
    #[must_use]
    pub fn label(&self) -> String {
        if self.order.is_some() {
            format!("{} {}", self.engine, self.method)
        } else {
            self.engine.clone()
        }
    }

    /// (cost, relative L2 force error) of the finished points in a window.
    #[must_use]
    pub fn points(&self, window: usize, measure: Measure) -> Vec<(f64, f64)> {
        self.points
            .iter()
            .filter_map(|point| {
                let cost = point.cost?;
                let cost = match measure {
                    Measure::Cpu => cost.cpu_min_s,
                    Measure::Rhs => cost.rhs_calls? as f64,
                };
                Some((cost, point.errors.get(window)?.force_l2))
            })
            .collect()
    }

    /// Cost of a relative L2 force error in a window.
    #[must_use]
    pub fn cost_at(&self, window: usize, error: f64, measure: Measure) -> Option<CostAt> {
        cost_at(&self.points(window, measure), error)
    }
}

/// What points are measured against.
pub(super) struct Truth<'a> {
    pub(super) courses: &'a Courses,
    pub(super) windows: &'a [Span],
    /// Loads that count as none.
    pub(super) least: Least,
    /// Upper estimate of the reference's error.
    pub(super) error: f64,
}

/// Runs a series.
pub(super) fn run(
    scene: &Scene,
    engine: &dyn Engine,
    method: Option<&str>,
    truth: &Truth<'_>,
    options: &Options,
    control: &Control<'_>,
    announce: &mut dyn FnMut(&str),
) -> Result<Series, StudyError> {
    let refinement = engine.refinement();
    let knob = method.map_or_else(
        || match refinement.map(|refinement| refinement.knob) {
            Some(pinwheel_engines::Knob::Tolerance) => Knob::Tolerance,
            _ => Knob::StepS,
        },
        Knob::of,
    );
    let mut series = Series {
        engine: engine.name().to_owned(),
        version: engine.version(),
        track: engine.track(),
        method: method.unwrap_or("own").to_owned(),
        order: method
            .and_then(integrators::method)
            .map(|method| method.order),
        knob,
        points: Vec::new(),
        stopped: Stopped::Finished,
    };
    let mut state = State {
        track: series.track,
        cpu_s: 0.0,
        cpu_before_s: 0.0,
        error: f64::INFINITY,
        error_before: f64::INFINITY,
        reference_error: truth.error,
    };
    let (mut before, mut last_error) = (None, f64::INFINITY);
    for setting in settings(knob, scene) {
        if let Some(coarser) = before
            && let Some(reason) = state.stop(knob, coarser / setting, options)
        {
            series.stopped = reason;
            break;
        }
        announce(&format!("{}, {setting:.1e}", series.label()));
        let mut scene = scene.clone();
        if let Some(method) = method {
            method.clone_into(&mut scene.solver.integrator);
        }
        knob.set(&mut scene, setting);
        let point = match point(&scene, engine, setting, truth, options, control) {
            Err(StudyError::Cancelled) => {
                series.stopped = Stopped::Interrupted;
                break;
            }
            other => other?,
        };
        let ended = match point.ending {
            Ending::Failed { .. } => Some(Stopped::Failed),
            Ending::GivenUp { .. } => Some(Stopped::TooLong),
            Ending::Finished | Ending::Diverged { .. } => None,
        };
        // A run that diverged early says nothing of what a whole one costs.
        if point.ending == Ending::Finished
            && let Some(cost) = point.cost
        {
            state.cpu_before_s = std::mem::replace(&mut state.cpu_s, cost.cpu_min_s);
        }
        state.error_before = last_error;
        last_error = state.error;
        state.error = point.errors.first().map_or(f64::INFINITY, |e| e.force_l2);
        series.points.push(point);
        if let Some(reason) = ended {
            series.stopped = reason;
            break;
        }
        before = Some(setting);
    }
    Ok(series)
}

/// One setting, as often as is worth it.
fn point(
    scene: &Scene,
    engine: &dyn Engine,
    setting: f64,
    truth: &Truth<'_>,
    options: &Options,
    control: &Control<'_>,
) -> Result<Point, StudyError> {
    let mut times = Vec::new();
    let mut first: Option<(Run, Ending)> = None;
    loop {
        let (run, ending) = match once(scene, engine, options, control)? {
            Ok(found) => found,
            Err(ending) => {
                return Ok(Point {
                    setting,
                    ending,
                    errors: Vec::new(),
                    cost: None,
                });
            }
        };
        times.push(run.stats.cpu_s);
        let finished = ending == Ending::Finished;
        let (run, _) = first.get_or_insert((run, ending));
        let spent: f64 = times.iter().sum();
        let least = options
            .repeats
            .min(if run.stats.cpu_s < 0.5 * options.repeat_s {
                3
            } else {
                2
            });
        let enough = times.len() >= least && spent >= options.repeat_s;
        if !finished || enough || times.len() >= options.repeats.max(1) {
            break;
        }
    }
    let Some((run, ending)) = first else {
        return Ok(Point {
            setting,
            ending: Ending::Failed {
                reason: "never ran".to_owned(),
            },
            errors: Vec::new(),
            cost: None,
        });
    };
    times.sort_by(f64::total_cmp);
    let cost = Cost {
        cpu_min_s: times[0],
        cpu_median_s: median(&times),
        runs: times.len(),
        rhs_calls: (run.stats.rhs_calls > 0).then_some(run.stats.rhs_calls),
        steps: run.stats.steps,
        rejected_steps: run.stats.rejected_steps,
    };
    let whole = ending == Ending::Finished && run.courses.len() == truth.courses.len();
    let errors = if whole {
        let windows = truth.windows.iter();
        windows
            .map(|window| errors(&run.courses, truth.courses, window, truth.least))
            .collect()
    } else {
        Vec::new()
    };
    Ok(Point {
        setting,
        ending,
        errors,
        cost: Some(cost),
    })
}

/// Samples between two looks at the clock, which is not free beside a fast run.
const SAMPLES_BETWEEN_LOOKS: u32 = 64;
/// A run is given up after this many times the time it may take.
const PATIENCE: f64 = 3.0;

/// One run; the inner error says why there is none.
fn once(
    scene: &Scene,
    engine: &dyn Engine,
    options: &Options,
    control: &Control<'_>,
) -> Result<Result<(Run, Ending), Ending>, StudyError> {
    let stop = AtomicBool::new(false);
    let (looks, reached_ns) = (AtomicU32::new(0), AtomicU64::new(0));
    // CPU time of the process: a busy machine must not make a run look long.
    let (started, begun) = (ProcessTime::now(), Instant::now());
    let spent = || match engine.is_outside() {
        true => begun.elapsed(),
        false => started.elapsed(),
    };
    let longest = PATIENCE * options.longest(engine.track());
    let progress = |time_s: f64| {
        if control.cancel.load(Ordering::Relaxed) {
            stop.store(true, Ordering::Relaxed);
        }
        if looks.fetch_add(1, Ordering::Relaxed) % SAMPLES_BETWEEN_LOOKS == 0
            && spent().as_secs_f64() > longest
        {
            reached_ns.store((time_s * 1e9) as u64, Ordering::Relaxed);
            stop.store(true, Ordering::Relaxed);
        }
    };
    let engines = pinwheel_engines::Control {
        cancel: &stop,
        progress: &progress,
    };
    let unsupported = |fault: Fault| EngineError::Unsupported {
        engine: engine.name().to_owned(),
        reason: fault.to_string(),
    };
    let checked = scene.clone().check().map_err(unsupported);
    match checked.and_then(|scene| engine.run(&scene, &engines)) {
        Ok(run) => Ok(Ok((run, Ending::Finished))),
        Err(EngineError::Diverged {
            time_s,
            quantity,
            partial,
            ..
        }) => Ok(Ok((*partial, Ending::Diverged { time_s, quantity }))),
        Err(EngineError::Cancelled) if !control.cancel.load(Ordering::Relaxed) => {
            let time_s = reached_ns.load(Ordering::Relaxed) as f64 * 1e-9;
            Ok(Err(Ending::GivenUp { time_s }))
        }
        Err(EngineError::Cancelled) => Err(StudyError::Cancelled),
        Err(
            EngineError::Unsupported { reason, .. }
            | EngineError::Absent { reason, .. }
            | EngineError::Failed { reason, .. },
        ) => Ok(Err(Ending::Failed { reason })),
    }
}

/// Of values in order.
pub(super) fn median(sorted: &[f64]) -> f64 {
    let n = sorted.len();
    if n == 0 {
        return f64::NAN;
    }
    0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])
}
