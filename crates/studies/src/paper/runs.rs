//! The runs behind the figures: each scene once, however many figures draw it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;

use pinwheel_scene::{Detection, Scene};
use pinwheel_timeseries::TimeSeries;

use super::Peer;
use super::figure::{Curve, Plot};
use super::read::{part, times};
use crate::StudyError;
use crate::control::{Control, complete};

/// Backlashes drawn, m. Of those in the paper's figures only the largest is named.
pub(super) const BACKLASHES: [f64; 3] = [0.0, 3e-4, 6e-4];

/// How contacts are found and the equations solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Model {
    /// Ours, converged: the exact profile, Runge-Kutta 4.
    Ours,
    /// The paper's: so many points on a disc (and 20 or 100 on a hole), Heun.
    Points(usize),
}

impl Model {
    /// The paper's rough analyses.
    pub(super) const ROUGH: Self = Self::Points(600);
    /// The paper's refined analyses.
    pub(super) const FINE: Self = Self::Points(4000);

    pub(super) fn words(self) -> String {
        match self {
            Self::Ours => "exact profile".to_owned(),
            Self::Points(count) => format!("{count} points"),
        }
    }

    /// The paper's scene with this model.
    pub(super) fn scene(self) -> Scene {
        let mut scene = Scene::paper();
        match self {
            Self::Ours => "rk4".clone_into(&mut scene.solver.integrator),
            Self::Points(count) => {
                scene.contact.detection = Detection::Points;
                scene.contact.wheel_points = count;
                // The paper's rough and refined analyses.
                scene.contact.hole_points = if count < 4000 { 20 } else { 100 };
            }
        }
        scene
    }
}

/// Time series with what they cost.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) time_series: TimeSeries,
    pub(super) wall_s: f64,
}

/// All runs so far.
pub(super) struct Runs<'a> {
    control: Control<'a>,
    /// Run that stands in Adams' place.
    pub(super) peer: Option<&'a Peer>,
    known: RefCell<HashMap<String, Rc<Run>>>,
}

impl<'a> Runs<'a> {
    pub(super) fn new(control: Control<'a>, peer: Option<&'a Peer>) -> Self {
        Self {
            control,
            peer,
            known: RefCell::new(HashMap::new()),
        }
    }

    /// The paper's scene with `model` and one change, run to its end.
    pub(super) fn get(
        &self,
        model: Model,
        change: impl FnOnce(&mut Scene),
    ) -> Result<Rc<Run>, StudyError> {
        let mut scene = model.scene();
        change(&mut scene);
        let key = scene.to_toml();
        if let Some(run) = self.known.borrow().get(&key) {
            return Ok(Rc::clone(run));
        }
        let start = Instant::now();
        let time_series = complete(&scene, &self.control)?.time_series;
        let run = Rc::new(Run {
            time_series,
            wall_s: start.elapsed().as_secs_f64(),
        });
        self.known.borrow_mut().insert(key, Rc::clone(&run));
        Ok(run)
    }

    /// One run for each value of what `change` sets; `label` names its curve.
    pub(super) fn cases(
        &self,
        model: Model,
        values: &[f64],
        label: impl Fn(f64) -> String,
        change: impl Fn(&mut Scene, f64),
    ) -> Result<Cases, StudyError> {
        let run = |&value: &f64| Ok((label(value), self.get(model, |s| change(s, value))?));
        values.iter().map(run).collect::<Result<_, _>>().map(Cases)
    }

    /// One run for each of [`BACKLASHES`].
    pub(super) fn backlashes(&self, model: Model) -> Result<Cases, StudyError> {
        self.cases(model, &BACKLASHES, backlash, |s, d| s.gear.backlash_m = d)
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.known.borrow().len()
    }
}

/// `d = 0.3 mm`.
pub(super) fn backlash(backlash_m: f64) -> String {
    format!("d = {} mm", (backlash_m * 1e6).round() / 1e3)
}

/// Runs that one plot shows, each with the name of its curve; all on the same sample times.
pub(super) struct Cases(pub(super) Vec<(String, Rc<Run>)>);

impl Cases {
    /// A number of every run.
    pub(super) fn each(&self, of: impl Fn(&TimeSeries) -> f64) -> Vec<f64> {
        self.0.iter().map(|(_, run)| of(&run.time_series)).collect()
    }

    /// A channel of every run within a window; `[key, title, y_label]`.
    pub(super) fn plot(&self, words: [&str; 3], channel: &str, window: (f64, f64)) -> Plot {
        let first = self.0.first();
        let x = first.map(|(_, run)| times(&run.time_series, window));
        let curve = |(label, run): &(String, Rc<Run>)| {
            Curve::line(label, part(&run.time_series, channel, window))
        };
        let curves = self.0.iter().map(curve).collect();
        Plot::over_time(words, x.unwrap_or_default(), curves)
    }
}
