//! Runs behind the figures; figures share the runs of a scene.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use pinwheel_scene::{Detection, Scene};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::figure::Figure;

use super::figure::{Curve, Drawn, number};
use super::read::{part, peak, range, times};
use crate::StudyError;
use crate::control::{Control, complete};
use crate::pool::lock;

/// Backlashes in the plots, m, with their names in numbers. The paper names only the largest of its figures'.
pub(super) const BACKLASHES: [(&str, f64); 3] = [("0", 0.0), ("0.3_mm", 3e-4), ("0.6_mm", 6e-4)];

/// Model of contact detection and integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Model {
    /// Pinwheel's converged model: exact profile, Runge-Kutta 4.
    Ours,
    /// The paper's model: a number of points on a disc (and 20 or 100 on a hole), Heun.
    Points(usize),
}

impl Model {
    /// Model of the paper's rough analyses.
    pub(super) const ROUGH: Self = Self::Points(600);
    /// Model of the paper's refined analyses.
    pub(super) const FINE: Self = Self::Points(4000);

    pub(super) fn words(self) -> String {
        match self {
            Self::Ours => "exact profile".to_owned(),
            Self::Points(count) => format!("{count} points"),
        }
    }

    /// Returns the paper's scene with this model.
    fn scene(self) -> Scene {
        let mut scene = Scene::paper();
        match self {
            Self::Ours => "rk4".clone_into(&mut scene.solver.integrator),
            Self::Points(count) => {
                scene.contact.detection = Detection::Points;
                scene.contact.wheel_points = count;
                // Hole points of the paper's rough and refined analyses.
                scene.contact.hole_points = if count < 4000 { 20 } else { 100 };
            }
        }
        scene
    }
}

/// Time series of an engine that detects and resolves contact itself, on the paper's scene and sample times.
#[derive(Debug, Clone)]
pub struct Peer {
    /// Name, with its version.
    pub name: String,
    /// True if computed now, false if recorded earlier.
    pub live: bool,
    /// Differences from the native solver.
    pub differences: String,
    /// Reason why no closer substitute for Adams was used, if any.
    pub note: String,
    /// Time series of the run.
    pub time_series: TimeSeries,
    /// Wall time, s, if known.
    pub wall_s: Option<f64>,
}

/// Time series with their cost.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) time_series: TimeSeries,
    pub(super) wall_s: f64,
}

/// Result of a run, once complete.
type Slot = Arc<Mutex<Option<Arc<Run>>>>;

/// All runs so far.
pub(super) struct Runs<'a> {
    control: Control<'a>,
    /// Run in place of Adams.
    pub(super) peer: Option<&'a Peer>,
    known: Mutex<HashMap<String, Slot>>,
}

impl<'a> Runs<'a> {
    pub(super) fn new(control: Control<'a>, peer: Option<&'a Peer>) -> Self {
        Self {
            control,
            peer,
            known: Mutex::default(),
        }
    }

    /// Returns the completed run of the paper's scene with `model` and one change.
    pub(super) fn get(
        &self,
        model: Model,
        change: impl FnOnce(&mut Scene),
    ) -> Result<Arc<Run>, StudyError> {
        let mut scene = model.scene();
        change(&mut scene);
        let key = scene.to_toml();
        let slot = Arc::clone(lock(&self.known).entry(key).or_default());
        // Threads that need the same run wait for it.
        let mut slot = lock(&slot);
        if let Some(run) = &*slot {
            return Ok(Arc::clone(run));
        }
        let start = Instant::now();
        let time_series = complete(&scene, &self.control)?.time_series;
        let run = Arc::new(Run {
            time_series,
            wall_s: start.elapsed().as_secs_f64(),
        });
        *slot = Some(Arc::clone(&run));
        Ok(run)
    }

    /// Returns one run for each value set by `change`, named for numbers; `label` names its curve.
    pub(super) fn cases(
        &self,
        model: Model,
        values: &[(&'static str, f64)],
        label: impl Fn(f64) -> String,
        change: impl Fn(&mut Scene, f64),
    ) -> Result<Cases, StudyError> {
        let run = |&(name, value): &(_, f64)| {
            let run = self.get(model, |scene| change(scene, value))?;
            Ok((name, label(value), run))
        };
        values.iter().map(run).collect::<Result<_, _>>().map(Cases)
    }

    /// Returns one run for each of [`BACKLASHES`].
    pub(super) fn backlashes(&self, model: Model) -> Result<Cases, StudyError> {
        self.cases(model, &BACKLASHES, backlash, |s, d| s.gear.backlash_m = d)
    }

    /// Returns one run for each model, named for numbers.
    pub(super) fn models<const N: usize>(
        &self,
        models: [(&'static str, Model); N],
        change: fn(&mut Scene),
    ) -> Result<Cases, StudyError> {
        let run = |(name, model): (_, Model)| Ok((name, model.words(), self.get(model, change)?));
        let each = models.map(run);
        each.into_iter().collect::<Result<_, _>>().map(Cases)
    }

    /// Returns the number of runs.
    pub(super) fn count(&self) -> usize {
        let slots = lock(&self.known);
        slots.values().filter(|slot| lock(slot).is_some()).count()
    }
}

/// Returns a label such as `d = 0.3 mm`.
pub(super) fn backlash(backlash_m: f64) -> String {
    format!("d = {} mm", (backlash_m * 1e6).round() / 1e3)
}

/// Runs of one plot, each with its name in numbers and the label of its curve, all on equal sample times.
pub(super) struct Cases(pub(super) Vec<(&'static str, String, Arc<Run>)>);

impl Cases {
    /// Evaluates a figure of every run.
    pub(super) fn each(&self, of: impl Fn(&TimeSeries) -> f64) -> Vec<f64> {
        self.0
            .iter()
            .map(|(.., run)| of(&run.time_series))
            .collect()
    }

    /// Returns a number of every run, named `what_name`.
    pub(super) fn numbers(
        &self,
        what: &str,
        unit: &'static str,
        of: impl Fn(&TimeSeries) -> f64,
    ) -> Vec<Figure> {
        let named = self.0.iter().zip(self.each(of));
        let named = named.map(|((name, ..), value)| number(format!("{what}_{name}"), value, unit));
        named.collect()
    }

    /// Returns the range of a torque within a window.
    pub(super) fn ranges(&self, what: &str, channel: &str, window: (f64, f64)) -> Vec<Figure> {
        self.numbers(what, "N m", |run| range(part(run, channel, window)))
    }

    /// Returns the largest force of a group within a window.
    pub(super) fn peaks(&self, what: &str, group: &str, window: (f64, f64)) -> Vec<Figure> {
        self.numbers(what, "N", |run| peak(run, group, window))
    }

    /// Plots a channel of every run, or the first of a group, within a window.
    pub(super) fn plot(&self, key: &str, channel: &str, window: (f64, f64)) -> Drawn {
        let x = self
            .0
            .first()
            .map(|(.., run)| times(&run.time_series, window));
        let course = |run: &Run| part(&run.time_series, channel, window).to_vec();
        let curves = self
            .0
            .iter()
            .map(|(_, label, run)| Curve::line(label, course(run)));
        (key.to_owned(), x.unwrap_or_default(), curves.collect())
    }
}
