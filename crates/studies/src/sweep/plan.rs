//! Runs of a sweep: every combination as a checked scene.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_compare::limits::fits;
use pinwheel_engines::{Engine, by_name};
use pinwheel_scene::channels::Channels;
use pinwheel_scene::{CheckedScene, Draft, Override, Scene, SceneError, did_you_mean};
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::{columns, group_of};

use crate::StudyError;
use crate::sweep::Sweep;
use crate::sweep::axis::{Axis, Value};
use crate::sweep::spread::columns_of;
use crate::sweep::statics::{self, STATICS, Statics};

/// Remedy for a sample that draws invalid gears.
const WIDER: &str = "the sample includes gears that cannot be built: narrow its intervals, or give the scene the clearances of a \
                     gear as built (`pinwheel init` suggests them)";

/// Largest number of runs of a sweep.
pub const MOST_RUNS: usize = 100_000;

/// Run of a plan.
pub struct PlannedRun {
    /// Number of the run, from 1.
    pub number: usize,
    /// Engine.
    pub engine: Arc<dyn Engine>,
    /// Varied keys and their values, in the order of the axes.
    pub values: Vec<(String, Value)>,
    /// Checked scene.
    pub scene: CheckedScene,
    /// Start and end of the figures' window, s.
    pub window_s: [f64; 2],
    /// Why the values of a sample make no gear; `scene` is then the one they are about.
    pub refused: Option<String>,
}

/// Engines of the caller, beside those of the build; their names take precedence.
#[derive(Clone, Default)]
pub struct Guests(pub Vec<Arc<dyn Engine>>);

impl Guests {
    /// Returns an engine by name, for a scene.
    pub fn engine(&self, name: &str, scene: &Scene) -> Option<Arc<dyn Engine>> {
        let guest = self.0.iter().find(|guest| guest.name() == name);
        guest
            .cloned()
            .or_else(|| by_name(name, scene).map(Arc::from))
            .or_else(|| (name == STATICS).then(|| Arc::new(Statics) as Arc<dyn Engine>))
    }
}

impl fmt::Debug for Guests {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = self.0.iter().map(|guest| guest.name());
        f.debug_list().entries(names).finish()
    }
}

/// Sweep whose runs are derived when they are needed: a plan of many is as small as the values that vary.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Content of the sweep file.
    pub sweep: Sweep,
    /// Engines of the caller.
    pub guests: Guests,
    /// Part common to all scenes.
    draft: Draft,
    /// Scene whose sample is drawn.
    about: Option<CheckedScene>,
    /// Simulated time of a run, s, for each point of the axes other than the sample.
    durations_s: Vec<f64>,
}

impl Plan {
    /// Plans a sweep. `overrides` apply after the file's own settings and before the varied keys.
    ///
    /// # Errors
    /// A refused scene, an unknown engine, a window that no run reaches, too many runs.
    pub fn new(sweep: Sweep, overrides: &[Override]) -> Result<Self, StudyError> {
        Self::within(sweep, overrides, Guests::default(), &AtomicBool::new(false))
    }

    /// Plans a sweep with the caller's engines. Every combination is checked, of a sample as many points as it takes to draw a gear.
    /// It stops when `cancel` is set, because checking many scenes takes time.
    ///
    /// # Errors
    /// Errors of [`new`](Self::new), and [`StudyError::Cancelled`].
    pub fn within(
        mut sweep: Sweep,
        overrides: &[Override],
        guests: Guests,
        cancel: &AtomicBool,
    ) -> Result<Self, StudyError> {
        let values = values_at(&sweep, 0);
        let common = [sweep.set.as_slice(), overrides].concat();
        let draft =
            Draft::load(&sweep.scene, &common).map_err(|source| no_scene(1, &values, source))?;
        let mut about = None;
        if let Some(sample) = &sweep.sample {
            // At the first point of the other axes: distributions without a mean are centred on the scene's value.
            let scene = scene_at(&draft, 1, &values)?;
            let axis = sample.axis(&scene);
            let axis = axis.map_err(|what| refused(1, &values, &what))?;
            sweep.axes.push(axis);
            about = Some(scene);
        }
        let factors = sweep.axes.iter().map(Axis::len);
        let factors = factors.chain([sweep.engines.len()]);
        let points = factors.clone().try_fold(1, usize::checked_mul);
        let count = points.filter(|&runs| runs <= MOST_RUNS).ok_or_else(|| {
            let factors: Vec<String> = factors.map(|count| count.to_string()).collect();
            let runs = factors.join(" x ");
            StudyError::Input(format!(
                "the sweep asks for {runs} runs, more than {MOST_RUNS}; give shorter lists, or split the sweep"
            ))
        })?;
        let mut plan = Self {
            sweep,
            guests,
            draft,
            about,
            durations_s: Vec::new(),
        };
        let (each, engines) = (plan.each(), plan.sweep.engines.len());
        let first = plan.run(0)?;
        (1..engines).try_for_each(|run| plan.run(run).map(drop))?;
        let wrong = |what: String| refused(1, &first.values, &what);
        measured(&plan.sweep, &first.scene).map_err(wrong)?;
        let (mut fault, mut drawn) = (None, false);
        for block in (0..count).step_by(each) {
            let mut duration_s = 0.0;
            for run in (block..block + each).step_by(engines) {
                if cancel.load(Ordering::Relaxed) {
                    return Err(StudyError::Cancelled);
                }
                let run = plan.run(run)?;
                duration_s = run.scene.solver.duration_s;
                if run.refused.is_none() {
                    drawn = true;
                    break;
                }
                fault = fault.or(run.refused);
            }
            plan.durations_s.push(duration_s);
        }
        match fault.filter(|_| !drawn) {
            Some(fault) => Err(StudyError::Input(format!("{fault}; {WIDER}"))),
            None => Ok(plan),
        }
    }

    /// Number of runs at a point of the axes other than the sample.
    fn each(&self) -> usize {
        let sample = self.sweep.sample.as_ref();
        self.sweep.engines.len() * sample.map_or(1, |sample| sample.points)
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.durations_s.len() * self.each()
    }

    /// True without runs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns a run by its index; the engine changes fastest, then the last axis.
    ///
    /// # Errors
    /// Errors of [`new`](Self::new).
    pub fn run(&self, run: usize) -> Result<PlannedRun, StudyError> {
        let engines = &self.sweep.engines;
        let (number, values) = (run + 1, values_at(&self.sweep, run / engines.len()));
        let (scene, no_gear) = match (scene_at(&self.draft, number, &values), &self.about) {
            (Ok(scene), _) => (scene, None),
            (Err(why), Some(about)) => (about.clone(), Some(why.to_string())),
            (Err(why), None) => return Err(why),
        };
        let wrong = |what: String| refused(number, &values, &what);
        let duration = scene.solver.duration_s;
        let window_s = self.sweep.window_s.unwrap_or([0.5 * duration, duration]);
        if window_s[1] > duration * (1.0 + 1e-9) {
            return Err(wrong(format!(
                "window_s ends at {} s, after the run's {duration} s; make solver.duration_s longer or the window earlier",
                window_s[1]
            )));
        }
        let name = &engines[run % engines.len()];
        let engine = self.guests.engine(name, &scene).ok_or_else(|| {
            let registry = pinwheel_engines::registry();
            let mut known: Vec<&str> = registry.iter().map(|e| e.name()).collect();
            known.push(STATICS);
            let remedy = did_you_mean(name, &known);
            wrong(format!("there is no engine `{name}`; {remedy}"))
        })?;
        Ok(PlannedRun {
            number,
            engine,
            values,
            scene,
            window_s,
            refused: no_gear,
        })
    }

    /// Returns the simulated time of a run, s; if a sample draws it, of its first gear.
    pub fn duration_s(&self, run: usize) -> f64 {
        self.durations_s[run / self.each()]
    }

    /// Returns the names of the varied keys, in the order of the axes.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        let axes = self.sweep.axes.iter();
        axes.flat_map(|axis| axis.keys.iter().map(|(key, _)| key.as_str()))
    }

    /// Returns the values of a run, in the order of the keys.
    pub fn values(&self, run: usize) -> Vec<&Value> {
        let places = places_at(&self.sweep, run / self.sweep.engines.len());
        let axes = self.sweep.axes.iter().zip(places);
        axes.flat_map(|(axis, place)| axis.keys.iter().map(move |(_, list)| &list[place]))
            .collect()
    }

    /// Returns the index of a run on every axis, and among the engines if there are several.
    pub fn places(&self, run: usize) -> Vec<usize> {
        let engines = self.sweep.engines.len();
        let mut places = places_at(&self.sweep, run / engines);
        places.extend((engines > 1).then_some(run % engines));
        places
    }
}

/// Refuses a measured pattern that fits no quantity of the scene, and a limit on a column that the results will not have.
fn measured(sweep: &Sweep, scene: &CheckedScene) -> Result<(), String> {
    let channels = Channels::of(scene)?;
    let asked = channels.names().map(|name| group_of(name).0);
    let forces = [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE];
    let moves = sweep.engines.iter().any(|engine| engine != STATICS);
    let rests = sweep.engines.iter().any(|engine| engine == STATICS);
    let quantities = columns::HEAD.into_iter().chain(forces).chain(asked);
    let mut there: Vec<&str> = quantities.filter(|_| moves).collect();
    there.dedup();
    let balanced: Vec<FigureDef> = statics::columns().filter(|_| rests).collect();
    let figures: Vec<&str> = balanced.iter().map(|def| &*def.key).collect();
    let known: Vec<&str> = there.iter().chain(&figures).copied().collect();
    let fits_none = |pattern: &&String| !known.iter().any(|name| fits(pattern, name));
    if let Some(pattern) = sweep.measure.iter().find(fits_none) {
        return Err(format!(
            "measure: `{pattern}` fits no quantity of the scene; there are {}",
            known.join(", ")
        ));
    }
    let wanted = |name: &&str| sweep.measure.iter().any(|pattern| fits(pattern, name));
    let columns: Vec<String> = columns_of(there.into_iter().filter(wanted), moves)
        .chain(figures.into_iter().filter(wanted).map(str::to_owned))
        .collect();
    for limit in &sweep.specification {
        if !columns.contains(&limit.figure) {
            let known: Vec<&str> = columns.iter().map(String::as_str).collect();
            return Err(format!(
                "specification: `{}` is no column that the results will have; {}",
                limit.figure,
                did_you_mean(&limit.figure, &known)
            ));
        }
    }
    Ok(())
}

/// Returns the index on every axis at one point of the grid; the last axis changes fastest.
fn places_at(sweep: &Sweep, point: usize) -> Vec<usize> {
    let mut rest = point;
    let mut places = vec![0; sweep.axes.len()];
    for (place, axis) in places.iter_mut().zip(&sweep.axes).rev() {
        *place = rest % axis.len();
        rest /= axis.len();
    }
    places
}

/// Returns the values at a point.
fn values_at(sweep: &Sweep, point: usize) -> Vec<(String, Value)> {
    let axes = sweep.axes.iter().zip(places_at(sweep, point));
    let value =
        |(key, list): &(String, Vec<Value>), place: usize| (key.clone(), list[place].clone());
    axes.flat_map(|(axis, place)| axis.keys.iter().map(move |one| value(one, place)))
        .collect()
}

/// Returns the error of a run that cannot be planned.
fn refused(number: usize, values: &[(String, Value)], what: &str) -> StudyError {
    StudyError::Input(format!("run {number} ({}): {what}", in_words(values)))
}

/// Returns the scene of run `number`.
fn scene_at(
    draft: &Draft,
    number: usize,
    values: &[(String, Value)],
) -> Result<CheckedScene, StudyError> {
    let varied = values.iter();
    let varied = varied.map(|(key, value)| Override::new(key.clone(), value.to_toml()));
    draft
        .with(&varied.collect::<Vec<_>>())
        .map_err(|source| no_scene(number, values, source))
}

/// Returns the error of a run whose scene is refused.
fn no_scene(number: usize, values: &[(String, Value)], source: SceneError) -> StudyError {
    StudyError::Run {
        number,
        values: in_words(values),
        source: Box::new(source),
    }
}

/// Formats values as `gear.backlash_m = 0.0003, contact.damping_n_s_m = 8`.
pub fn in_words(values: &[(String, Value)]) -> String {
    if values.is_empty() {
        return "the scene as it is".to_owned();
    }
    let words = values.iter().map(|(key, value)| match value {
        Value::Other(list) if list.matches(',').count() > 2 => {
            format!("{key} = {} values", list.matches(',').count() + 1)
        }
        value => format!("{key} = {value}"),
    });
    words.collect::<Vec<_>>().join(", ")
}
