//! Runs of one engine and method at every setting, coarse to fine.

use std::time::Duration;

use pinwheel_engines::{AccuracySetting, Ending, Engine, SharedModel};
use pinwheel_mbs::integrators;
use pinwheel_scene::Scene;
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::LoadFloor;
use serde::Serialize;

use super::front::{CostAt, cost_at};
use super::norms::{Errors, Span, errors};
use super::options::Options;
use super::settings::{Stopped, settings};
use crate::StudyError;
use crate::control::{Control, TimeLimit, compile};

/// CPU time below which the next finer run always follows, s.
const CHEAP_S: f64 = 0.25;
/// Least factor by which the error must fall over two settings for the series to continue.
const STAGNANT: f64 = 1.3;
/// Multiple of the time limit after which a run is stopped.
const PATIENCE: f64 = 3.0;

/// Cost of the runs at one setting.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Cost {
    /// Least CPU time of the runs, s.
    pub cpu_min_s: f64,
    /// Median CPU time of the runs, s.
    pub cpu_median_s: f64,
    /// Number of runs.
    pub runs: usize,
    /// Evaluations of the contact forces in one run; `None` if the engine does not count them.
    pub rhs_calls: Option<u64>,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected_steps: u64,
}

/// Errors and cost at one setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Step, s, or tolerance.
    pub setting: f64,
    /// Ending of the run.
    #[serde(rename = "outcome")]
    pub ending: Ending,
    /// Errors by window; empty unless finished.
    pub errors: Vec<Errors>,
    /// Cost of the runs; `None` without a run.
    pub cost: Option<Cost>,
}

/// Series of settings of one engine and method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// Name of the engine.
    pub engine: String,
    /// Version of the engine.
    pub version: String,
    /// Parts of the model that the engine shares with the native solver.
    pub track: SharedModel,
    /// Native integrator, or `own`.
    pub method: String,
    /// Classical order of a native integrator.
    pub order: Option<u32>,
    /// Setting that is varied.
    pub knob: AccuracySetting,
    /// Points by setting, coarse to fine.
    pub points: Vec<Point>,
    /// Reason why the series has no finer setting.
    pub stopped: Stopped,
}

/// Measure of cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Least CPU time, s.
    Cpu,
    /// Right-hand-side calls.
    Rhs,
}

impl Series {
    /// Returns the name of the series in legends: `native-reduced rk4`, `rapier-shared-law`.
    pub fn label(&self) -> String {
        if self.order.is_some() {
            format!("{} {}", self.engine, self.method)
        } else {
            self.engine.clone()
        }
    }

    /// Returns (cost, relative L2 error of the forces) of the finished points in a window.
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

    /// Returns the reason to stop before a run at a finer `setting`; `None` if the series continues.
    #[doc(hidden)]
    pub fn stop(&self, setting: f64, reference_error: f64, options: &Options) -> Option<Stopped> {
        let ratio = self.points.last()?.setting / setting;
        let error = |before: usize| {
            let point = self.points.iter().rev().nth(before);
            let errors = point.and_then(|point| point.errors.first());
            errors.map_or(f64::INFINITY, |errors| errors.force_l2)
        };
        // A run that diverged early does not indicate the cost of a complete one.
        let finished = self.points.iter().rev();
        let mut finished = finished.filter(|point| point.ending.is_finished());
        let mut cpu_s = || Some(finished.next()?.cost?.cpu_min_s);
        let (last_s, before_s) = (cpu_s().unwrap_or(0.0), cpu_s().unwrap_or(0.0));
        // The cost of a tighter tolerance is unknown, and may be lower: RODAS5P is cheap once its steps end on the friction's
        // ramp. Two runs that took too long end a series; a run that takes far too long is stopped.
        let next = match self.knob {
            AccuracySetting::Step => last_s * ratio,
            AccuracySetting::Tolerance => last_s.min(before_s),
        };
        let (error, error_before) = (error(0), error(2));
        if error <= 0.1 * reference_error || error == 0.0 {
            return Some(Stopped::AtTheReference);
        }
        if error <= 0.1 * options.target && next > CHEAP_S {
            return Some(Stopped::GoodEnough);
        }
        if next > options.longest(self.track) {
            return Some(Stopped::TooLong);
        }
        let stagnant = self.track == SharedModel::OwnContact
            && error.is_finite()
            && error_before < STAGNANT * error;
        stagnant.then_some(Stopped::Stagnates)
    }

    /// Returns the cost of a relative L2 force error in a window.
    pub fn cost_at(&self, window: usize, error: f64, measure: Measure) -> Option<CostAt> {
        cost_at(&self.points(window, measure), error)
    }
}

/// Scene, options, and reference of a bench.
pub(super) struct Setup<'a> {
    pub(super) scene: &'a Scene,
    pub(super) options: &'a Options,
    pub(super) reference: &'a TimeSeries,
    pub(super) windows: &'a [Span],
    /// Loads that count as zero.
    pub(super) least: LoadFloor,
    /// Upper estimate of the reference's error.
    pub(super) reference_error: f64,
    pub(super) control: &'a Control<'a>,
}

impl Setup<'_> {
    /// Runs a series.
    pub(super) fn series(
        &self,
        (engine, method): (&dyn Engine, Option<&str>),
        announce: &mut dyn FnMut(&str),
    ) -> Result<Series, StudyError> {
        let own = engine.info().refinement.map(|refinement| refinement.knob);
        let own = own.unwrap_or(AccuracySetting::Step);
        let mut series = Series {
            engine: engine.name().to_owned(),
            version: engine.version(),
            track: engine.track(),
            method: method.unwrap_or("own").to_owned(),
            order: method.and_then(integrators::method).map(|m| m.order),
            knob: method.map_or(own, AccuracySetting::of),
            points: Vec::new(),
            stopped: Stopped::Finished,
        };
        series.stopped = self.refine(&mut series, engine, method, announce)?;
        Ok(series)
    }

    /// Adds points to a series until there is a reason to stop.
    fn refine(
        &self,
        series: &mut Series,
        engine: &dyn Engine,
        method: Option<&str>,
        announce: &mut dyn FnMut(&str),
    ) -> Result<Stopped, StudyError> {
        for setting in settings(series.knob, self.scene) {
            if let Some(reason) = series.stop(setting, self.reference_error, self.options) {
                return Ok(reason);
            }
            announce(&format!("{}, {setting:.1e}", series.label()));
            let mut scene = self.scene.clone();
            if let Some(method) = method {
                method.clone_into(&mut scene.solver.integrator);
            }
            series.knob.set(&mut scene, setting);
            let point = match self.point(&scene, engine, setting) {
                Err(StudyError::Cancelled) => return Ok(Stopped::Interrupted),
                point => point?,
            };
            let ended = match point.ending {
                Ending::Finished | Ending::Diverged { .. } => None,
                Ending::TimedOut { .. } => Some(Stopped::TooLong),
                _ => Some(Stopped::Failed),
            };
            series.points.push(point);
            if let Some(reason) = ended {
                return Ok(reason);
            }
        }
        Ok(Stopped::Finished)
    }

    /// Runs one setting, as often as useful.
    fn point(&self, scene: &Scene, engine: &dyn Engine, setting: f64) -> Result<Point, StudyError> {
        let without = |ending| {
            Ok(Point {
                setting,
                ending,
                errors: Vec::new(),
                cost: None,
            })
        };
        let gearbox = match compile(scene) {
            Err(StudyError::Scene { source, .. }) => return without(Ending::unsupported(source)),
            gearbox => gearbox?,
        };
        let options = self.options;
        let longest_s = PATIENCE * options.longest(engine.track());
        let limit = TimeLimit {
            most: Duration::from_secs_f64(longest_s),
            suggested_limit_s: options.longest_s / longest_s,
            outside: true,
        };
        let mut times = Vec::new();
        let run = loop {
            let run = limit.run(engine, &gearbox, self.control)?;
            if !matches!(run.ending, Ending::Finished | Ending::Diverged { .. }) {
                return without(run.ending);
            }
            times.push(run.stats.cpu_s);
            let spent: f64 = times.iter().sum();
            let is_short = times[0] < 0.5 * options.repeat_s;
            let least = options.repeats.min(if is_short { 3 } else { 2 });
            let enough = times.len() >= least && spent >= options.repeat_s;
            if !run.ending.is_finished() || enough || times.len() >= options.repeats {
                break run;
            }
        };
        times.sort_by(f64::total_cmp);
        let middle = [(times.len() - 1) / 2, times.len() / 2].map(|k| times[k]);
        let cost = Cost {
            cpu_min_s: times[0],
            cpu_median_s: 0.5 * (middle[0] + middle[1]),
            runs: times.len(),
            rhs_calls: (run.stats.rhs_calls > 0).then_some(run.stats.rhs_calls),
            steps: run.stats.steps,
            rejected_steps: run.stats.rejected_steps,
        };
        let (own, reference) = (&run.time_series, self.reference);
        let complete = run.ending.is_finished() && own.len() == reference.len();
        let windows = self.windows.iter().filter(|_| complete);
        let errors = windows.map(|window| errors(own, reference, window, self.least));
        Ok(Point {
            setting,
            errors: errors.collect(),
            ending: run.ending,
            cost: Some(cost),
        })
    }
}
