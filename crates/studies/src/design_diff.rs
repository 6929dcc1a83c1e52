//! Comparison of two designs: changes of the scene, of every figure of `design`, and of the time series.
//!
//! ```text
//!                ┌─ keys, and what follows from them ─> what changed
//!  two scenes ───┼─ design::run of each ─────────────> figures, each with its uncertainty
//!                └─ refinement study of one engine, each ──> time series, their means and peaks with uncertainty
//! ```
//!
//! A difference within both uncertainties together is not significant, and is reported as such.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use pinwheel_compare::uncertainty::Norm;
use pinwheel_compare::{
    Comparison, Context, Evidence, Participant, Rules, Scales, WindowKind, compare,
};
use pinwheel_engines::Engine;
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{CheckedScene, Derived, Line, Scene, Source};
use pinwheel_timeseries::figure::definitions::DIGITS;
use pinwheel_timeseries::figure::{Diff, Figure, FigureDef, diff};
use pinwheel_timeseries::norms::Statistics;
use serde::Serialize;
use serde_json::Value;

use crate::comparison::{Effort, context, refine};
use crate::control::of_scene;
use crate::motion::{Motion, sampled};
use crate::output::{self, OutputError};
use crate::provenance::{Provenance, Summary};
use crate::stages::{Course, Located, Stage, between};
use crate::{Control, Progress, StudyError, design, single};

/// Inputs of the comparison of two designs.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Both designs.
    pub gearboxes: [&'a Gearbox; 2],
    /// Names for scenes with equal names: as typed.
    pub specs: [&'a str; 2],
    /// Engine of both runs.
    pub engine: &'a dyn Engine,
    /// Effort for the uncertainty of each design.
    pub efforts: [Effort; 2],
}

/// Key with differing values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeyDiff {
    /// Full name, with its unit.
    pub key: String,
    /// Values of the key; `None` if a scene has none.
    pub values: [Option<Value>; 2],
    /// True if both scenes leave the key to a formula, so that it differs as a consequence.
    pub follows: bool,
    /// First stage of the model that this key alone changes, if any.
    pub stage: Option<Stage>,
}

/// Both designs and their differences.
#[derive(Debug, Clone, Serialize)]
pub struct DesignDiff {
    /// Names of the designs, always distinct.
    #[serde(rename = "designs")]
    pub names: [String; 2],
    /// Results of `design` for each.
    #[serde(skip)]
    pub designs: [design::DesignResult; 2],
    /// Engine of both runs.
    pub engine: String,
    /// Keys that differ, except name, description and recorded channels.
    pub changed: Vec<KeyDiff>,
    /// Stages of the second model, evaluated at the states of the first; `None` for gears with other numbers of bodies.
    pub stages: Option<Located>,
    /// Quantities that follow exactly from the dimensions and the load.
    pub derived: Vec<Diff>,
    /// Figures of `design`.
    pub figures: Vec<Diff>,
    /// Means and peaks of the time series, by window.
    #[serde(skip)]
    pub time_series: Vec<(WindowKind, Vec<Diff>)>,
    /// Time series of both designs with their uncertainties.
    #[serde(skip)]
    pub comparison: Comparison,
    /// Runs of both designs.
    #[serde(skip)]
    pub participants: Vec<Participant>,
    /// Motions of both designs over their common time, for a page.
    #[serde(skip)]
    pub motion: Vec<Motion>,
}

/// Content of `summary.json`.
#[derive(Serialize)]
struct DiffSummary<'a> {
    identical: bool,
    #[serde(flatten)]
    found: &'a DesignDiff,
    #[serde(rename = "courses")]
    time_series: BTreeMap<&'static str, &'a [Diff]>,
    scenes: [&'a CheckedScene; 2],
}

/// Computes both designs and their differences.
///
/// # Errors
/// Cancelled; a design without a load; a scene that cannot be modelled or that the engine cannot run.
pub fn run(input: &Input<'_>, control: &Control<'_>) -> Result<DesignDiff, StudyError> {
    let scenes = input.gearboxes.map(|gearbox| &gearbox.scene);
    let names = names(scenes, input.specs);
    for gearbox in input.gearboxes {
        single::prepare(input.engine, gearbox)?;
    }
    let grid = on_one_grid(input.gearboxes)?;
    // The remaining time of one run does not indicate that of the study.
    let tell = |at: Progress<'_>| {
        (control.progress)(Progress { left_s: None, ..at });
    };
    let control = &control.limited(control.cancel, &tell);
    let answer = |k: usize| -> Result<_, StudyError> {
        let design = design::answers(input.gearboxes[k], true, control)?;
        let (name, effort) = (&names[k], input.efforts[k]);
        let (at, context) = (Progress::new(k, 2, name), context(&grid[k].scene));
        let (participant, evidence) =
            refine(input.engine, &grid[k], &context, effort, at, control)?;
        let participant = Participant {
            name: name.clone(),
            ..participant
        };
        let evidence = Evidence {
            engine: name.clone(),
            ..evidence
        };
        Ok((design, participant, evidence))
    };
    let [(a, first, of_a), (b, second, of_b)] = [answer(0)?, answer(1)?];
    let (designs, participants, evidence) = ([a, b], vec![first, second], [of_a, of_b]);
    let rules = Rules {
        evidence: &evidence,
        resolution: input.efforts[0].resolution,
        ..Rules::default()
    };
    let context = shared(scenes);
    let comparison = compare(&context, &participants, &rules)?;
    // Gears with other numbers of pins have other channels, so each has its own figures.
    let alone = |k: usize| {
        let rules = Rules {
            evidence: &evidence[k..=k],
            ..rules
        };
        compare(&context, &participants[k..=k], &rules)
    };
    let alone = [alone(0)?, alone(1)?];
    let [of_a, of_b] = scenes.map(|scene| sampled(scene));
    let (step, duration) = (of_a.0.min(of_b.0), of_a.1.min(of_b.1));
    let both = [0, 1].map(|k| (names[k].as_str(), scenes[k]));
    let mut motion = Motion::beside(both, (0.0, duration), step, control)?;
    for one in &mut motion {
        one.begin_s = 0.5 * duration;
    }
    let course = Course::of(input.gearboxes[0]);
    Ok(DesignDiff {
        motion,
        engine: input.engine.name().to_owned(),
        changed: changed(scenes, course.as_ref()),
        stages: course
            .as_ref()
            .and_then(|course| between(course, input.gearboxes[1])),
        derived: derived(scenes, [&designs[0].dimensions, &designs[1].dimensions]),
        figures: figures(&designs),
        time_series: time_series(&alone),
        names,
        designs,
        comparison,
        participants,
    })
}

/// Returns the names of both designs: of their scenes, or as typed, or first and second.
fn names(scenes: [&CheckedScene; 2], specs: [&str; 2]) -> [String; 2] {
    let names = scenes.map(|scene| scene.name.clone());
    if names[0] != names[1] {
        return names;
    }
    if specs[0] != specs[1] {
        return specs.map(str::to_owned);
    }
    let name = &names[0];
    [format!("{name} (first)"), format!("{name} (second)")]
}

/// Returns both gearboxes with the sample times of the longer run, for drawing and comparison on one axis.
fn on_one_grid(gearboxes: [&Gearbox; 2]) -> Result<[Gearbox; 2], StudyError> {
    let longer = gearboxes.map(|gearbox| gearbox.scene.solver.duration_s);
    let of = &gearboxes[usize::from(longer[1] > longer[0])].scene.solver;
    let (duration_s, sample_s) = (of.duration_s, of.sample_s);
    let [a, b] = gearboxes.map(|gearbox| {
        let solver = &gearbox.scene.solver;
        if (solver.duration_s, solver.sample_s) == (duration_s, sample_s) {
            return Ok(gearbox.clone());
        }
        let moved = gearbox.with_solver(|solver| {
            solver.duration_s = duration_s;
            solver.sample_s = sample_s;
            solver.step_s = solver.step_s.min(sample_s);
        });
        moved.map_err(|source| of_scene(&gearbox.scene, source.into()))
    });
    Ok([a?, b?])
}

/// Returns the facts common to both scenes.
fn shared(scenes: [&CheckedScene; 2]) -> Context {
    let [a, b] = scenes.map(|scene| context(scene));
    let same = |a: Option<f64>, b: Option<f64>| a.filter(|_| a == b);
    let larger = |a: Option<f64>, b: Option<f64>| Some(a?.max(b?));
    let mut load_changes_s = [a.load_changes_s, b.load_changes_s].concat();
    load_changes_s.sort_by(f64::total_cmp);
    load_changes_s.dedup();
    Context {
        scene: format!("{} and {}", a.scene, b.scene),
        duration_s: a.duration_s.max(b.duration_s),
        load_n_m: same(a.load_n_m, b.load_n_m),
        load_changes_s,
        input_speed_rad_s: same(a.input_speed_rad_s, b.input_speed_rad_s),
        friction_coefficient: a.friction_coefficient.max(b.friction_coefficient),
        settling_s: larger(a.settling_s, b.settling_s),
        scales: Scales {
            force_n: larger(a.scales.force_n, b.scales.force_n),
            torque_n_m: larger(a.scales.torque_n_m, b.scales.torque_n_m),
        },
        ..Context::default()
    }
}

/// Returns the keys that differ, except names, descriptions and recorded channels, which change no result.
fn changed(scenes: [&CheckedScene; 2], course: Option<&Course<'_>>) -> Vec<KeyDiff> {
    fn flat(value: Value, at: &str, keys: &mut BTreeMap<String, Value>) {
        let Value::Object(inner) = value else {
            keys.insert(at.to_owned(), value);
            return;
        };
        let dot = if at.is_empty() { "" } else { "." };
        for (key, value) in inner {
            flat(value, &format!("{at}{dot}{key}"), keys);
        }
    }
    let mut keys: BTreeMap<String, [Option<Value>; 2]> = BTreeMap::new();
    for (k, scene) in scenes.into_iter().enumerate() {
        let mut own = BTreeMap::new();
        flat(scene.to_json(), "", &mut own);
        for (key, value) in own {
            keys.entry(key).or_default()[k] = Some(value);
        }
    }
    let by_formula = |scene: &&CheckedScene, key: &str| {
        let mut origins = scene.origins().into_iter();
        origins.any(|origin| origin.key == key && matches!(origin.source, Source::Formula(_)))
    };
    let counts = |key: &str| !matches!(key, "name" | "description") && !key.starts_with("output.");
    let changed = keys.into_iter();
    let changed = changed.filter(|(key, [a, b])| a != b && counts(key));
    let change = |(key, values): (String, [Option<Value>; 2])| KeyDiff {
        follows: scenes.iter().all(|scene| by_formula(scene, &key)),
        stage: course.and_then(|course| stage(course, scenes[0], &key, &values[1])),
        key,
        values,
    };
    changed.map(change).collect()
}

/// Returns the first stage of a model that a key's value alone changes.
fn stage(
    course: &Course<'_>,
    of: &CheckedScene,
    key: &str,
    value: &Option<Value>,
) -> Option<Stage> {
    if key.starts_with("solver.") {
        return Some(Stage::Integration);
    }
    let mut scene = toml::Table::try_from(&**of).ok()?;
    let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
    let mut place = &mut scene;
    for part in table.split('.').filter(|part| !part.is_empty()) {
        let inner = place.entry(part);
        place = inner
            .or_insert_with(|| toml::Table::new().into())
            .as_table_mut()?;
    }
    match value
        .as_ref()
        .and_then(|value| toml::Value::try_from(value).ok())
    {
        Some(value) => place.insert(name.to_owned(), value),
        None => place.remove(name),
    };
    let scene: Scene = toml::Value::Table(scene).try_into().ok()?;
    let scene = of.changed(|own| *own = scene).ok()?;
    between(course, &Gearbox::new(&scene).ok()?)?.first()
}

/// Creates a definition by names, with the digits of a design's figures.
fn def<W: Into<Cow<'static, str>>>(key: W, label: W, unit: W) -> FigureDef {
    FigureDef {
        digits: DIGITS,
        ..FigureDef::named(key, label, unit)
    }
}

/// Returns differences of quantities that follow exactly from the dimensions.
fn derived(scenes: [&CheckedScene; 2], of: [&Derived; 2]) -> Vec<Diff> {
    let [a, b] = [0, 1].map(|k| of[k].lines(scenes[k]));
    let exact = |line: &Line| def(line.what, line.what, line.unit).of(line.value, 0.0);
    let both = a.iter().zip(&b);
    both.map(|(a, b)| diff(&exact(a), &exact(b))).collect()
}

fn figures(designs: &[design::DesignResult; 2]) -> Vec<Diff> {
    let [a, b] = [0, 1].map(|k| &designs[k].figures);
    let other = |one: &Figure| b.iter().find(|figure| figure.is(&one.def));
    let both = a.iter().filter_map(|one| Some(diff(one, other(one)?)));
    both.collect()
}

/// Returns differences of mean and peak of every quantity, by window.
fn time_series(alone: &[Comparison; 2]) -> Vec<(WindowKind, Vec<Diff>)> {
    let mut windows: Vec<_> = alone[0].windows.iter().map(|w| w.kind).collect();
    // The first window represents the run: the complete run if it does not become steady.
    windows.sort_by_key(|kind| *kind == WindowKind::Transient);
    windows
        .into_iter()
        .map(|window| (window, statistics(alone, window)))
        .collect()
}

fn statistics(alone: &[Comparison; 2], window: WindowKind) -> Vec<Diff> {
    let mut rows = Vec::new();
    let only_b = alone[1].quantities.iter();
    let only_b = only_b.filter(|q| alone[0].quantities.iter().all(|other| other.name != q.name));
    for quantity in alone[0].quantities.iter().chain(only_b) {
        let engines = [0, 1].map(|k| alone[k].engines.first());
        let statistics =
            engines.map(|engine| engine?.figures_in(window)?.quantities.get(&quantity.name));
        if statistics.iter().all(Option::is_none) {
            continue;
        }
        let mut row = |word: &str, norm: Norm, of: fn(&Statistics) -> f64| {
            let key = format!("{} {word}", quantity.name);
            let label = format!("{}, {word}", quantity.label);
            let def = def(key, label, quantity.unit.clone());
            let off = engines.map(|engine| engine?.u(&quantity.name, window, norm));
            let [a, b] = [0, 1].map(|k| def.of(statistics[k].map(of), off[k]));
            rows.push(diff(&a, &b));
        };
        row("mean", Norm::Mean, |s| s.mean);
        row("peak", Norm::Peak, |s| s.peak);
    }
    rows
}

impl DesignDiff {
    /// True if both scenes are equal except for their names.
    pub fn identical(&self) -> bool {
        self.changed.is_empty()
    }

    /// Returns the first unfinished run with its reason.
    pub fn broken(&self) -> Option<(&str, String)> {
        let mut each = self.participants.iter();
        each.find_map(|p| Some((p.name.as_str(), p.status.reason()?)))
    }

    /// Writes `summary.json` and, in `design-1` and `design-2`, the files of `pinwheel design` and `courses.csv` into the
    /// folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, origin: &Provenance) -> Result<(), OutputError> {
        let folders = ["design-1", "design-2"].into_iter().zip(&self.participants);
        for (design, (folder, participant)) in self.designs.iter().zip(folders) {
            let place = output::folder(dir, folder)?;
            design.write(&place, origin)?;
            single::save(&participant.time_series, &place.join("courses.csv"))?;
        }
        let time_series = self.time_series.iter();
        let summary = DiffSummary {
            identical: self.identical(),
            found: self,
            time_series: time_series
                .map(|(window, rows)| (window.word(), rows.as_slice()))
                .collect(),
            scenes: [&self.designs[0].scene, &self.designs[1].scene],
        };
        Summary::new(origin, summary).write(dir)
    }
}
