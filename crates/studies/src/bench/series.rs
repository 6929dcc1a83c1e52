//! One engine and method at every setting, coarse to fine.

use std::time::Duration;

use pinwheel_engines::{AccuracySetting, Ending, Engine, Run, SharedModel};
use pinwheel_gearbox::Gearbox;
use pinwheel_mbs::integrators;
use pinwheel_scene::Scene;
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::LoadFloor;
use serde::Serialize;

use super::Options;
use super::front::{CostAt, cost_at};
use super::norms::{Errors, Span, errors};
use super::settings::{State, Stopped, settings};
use crate::StudyError;
use crate::control::{Control, TimeLimit};

/// Cost of a setting.
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
    /// Cost of the point; `None` if it did not run.
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
    pub track: SharedModel,
    /// Integrator of ours, or `own`.
    pub method: String,
    /// Classical order, where it is one of ours.
    pub order: Option<u32>,
    /// Setting that is varied.
    pub knob: AccuracySetting,
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
        let known = |point: &Point| {
            let cost = point.cost?;
            let cost = match measure {
                Measure::Cpu => cost.cpu_min_s,
                Measure::Rhs => cost.rhs_calls? as f64,
            };
            Some((cost, point.errors.get(window)?.force_l2))
        };
        self.points.iter().filter_map(known).collect()
    }

    /// Cost of a relative L2 force error in a window.
    #[must_use]
    pub fn cost_at(&self, window: usize, error: f64, measure: Measure) -> Option<CostAt> {
        cost_at(&self.points(window, measure), error)
    }
}

/// Reference from which the errors of points are measured.
pub(super) struct Truth<'a> {
    pub(super) time_series: &'a TimeSeries,
    pub(super) windows: &'a [Span],
    /// Loads that count as none.
    pub(super) least: LoadFloor,
    /// Upper estimate of the reference's error.
    pub(super) error: f64,
}

/// Runs a series.
pub(super) fn run(
    scene: &Scene,
    (engine, method): (&dyn Engine, Option<&str>),
    truth: &Truth<'_>,
    options: &Options,
    control: &Control<'_>,
    announce: &mut dyn FnMut(&str),
) -> Result<Series, StudyError> {
    let own = engine.info().refinement.map(|refinement| refinement.knob);
    let knob = method.map_or(own.unwrap_or(AccuracySetting::Step), AccuracySetting::of);
    let mut series = Series {
        engine: engine.name().to_owned(),
        version: engine.version(),
        track: engine.track(),
        method: method.unwrap_or("own").to_owned(),
        order: method.and_then(integrators::method).map(|m| m.order),
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
            Ending::Finished | Ending::Diverged { .. } => None,
            Ending::TimedOut { .. } => Some(Stopped::TooLong),
            Ending::Unsupported { .. } | Ending::Absent { .. } | Ending::Failed { .. } => {
                Some(Stopped::Failed)
            }
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
    let without = |ending| Point {
        setting,
        ending,
        errors: Vec::new(),
        cost: None,
    };
    let checked = scene.clone().check().map_err(Ending::unsupported);
    let compiled = checked.and_then(|scene| Gearbox::new(&scene).map_err(Ending::unsupported));
    let gearbox = match compiled {
        Ok(gearbox) => gearbox,
        Err(ending) => return Ok(without(ending)),
    };
    let longest = options.longest(engine.track());
    let patience = TimeLimit {
        most: Duration::from_secs_f64(PATIENCE * longest),
        suggested_limit_s: options.longest_s / (PATIENCE * longest),
        outside: true,
    };
    let mut times = Vec::new();
    let mut first: Option<Run> = None;
    loop {
        let run = patience.run(engine, &gearbox, control)?;
        if !matches!(run.ending, Ending::Finished | Ending::Diverged { .. }) {
            return Ok(without(run.ending));
        }
        times.push(run.stats.cpu_s);
        let finished = run.ending.is_finished();
        let run = first.get_or_insert(run);
        let spent: f64 = times.iter().sum();
        let is_short = run.stats.cpu_s < 0.5 * options.repeat_s;
        let least = options.repeats.min(if is_short { 3 } else { 2 });
        let enough = times.len() >= least && spent >= options.repeat_s;
        if !finished || enough || times.len() >= options.repeats.max(1) {
            break;
        }
    }
    let Some(run) = first else {
        return Ok(without(Ending::failed("never ran")));
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
    let whole = run.ending.is_finished() && run.time_series.len() == truth.time_series.len();
    let windows = truth.windows.iter().filter(|_| whole);
    let error = |window| errors(&run.time_series, truth.time_series, window, truth.least);
    let errors = windows.map(error).collect();
    Ok(Point {
        setting,
        ending: run.ending,
        errors,
        cost: Some(cost),
    })
}

/// A run is given up after this many times the time it may take.
const PATIENCE: f64 = 3.0;

/// Median of values in order, of which there are some.
fn median(sorted: &[f64]) -> f64 {
    let n = sorted.len();
    0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])
}
