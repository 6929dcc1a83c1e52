//! Judgement of all stages of a run.

use std::cell::Cell;
use std::ops::Range;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::load_profile;
use pinwheel_timeseries::TimeSeries;
use serde::Serialize;

use super::cause::{Cause, cause, changes};
use super::judged::{EXACT, EXPLAINED, FLOW, Judged, ROUNDING, SAMPLES, SURE, Stage, percent};
use super::model::{Changes, Model, Work};
use super::motion::{self, Motion};
use super::pictures::Picture;
use super::suspects::Suspect;
use super::{forces, states};

/// First stage of a run that differs from the native model, with the likely cause.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Located {
    /// Name of the engine.
    pub run: String,
    /// Judgements of all stages.
    pub stages: Vec<Judged>,
    /// Likely cause.
    pub cause: Option<Cause>,
    /// Plots of the residuals of stages that are off.
    pub pictures: Vec<Picture>,
    /// Force evaluations used by the judgement, and their limit: the number of the run itself.
    pub evaluations: [u64; 2],
    /// Reason for a missing cause, or the part left out because it would have cost more than the run, in words.
    pub left_out: Option<String>,
}

impl Located {
    /// Returns the first stage that is off: that of the cause, if there is one.
    pub fn first(&self) -> Option<Stage> {
        let off = self.stages.iter().find(|judged| judged.is_off());
        let off = off.map(|judged| judged.stage);
        off.and_then(|stage| self.cause.as_ref().map_or(Some(stage), Cause::stage))
    }

    /// Returns a line for the first screen, which begins with `stage` if a stage is off.
    pub fn sentence(&self) -> String {
        let stage = self.first().map_or("", |_| "stage ");
        format!("{stage}{}", self.words())
    }

    /// Returns the first stage that is off and the likely cause with its size, or that no stage is off.
    pub fn words(&self) -> String {
        let mut stages = self.stages.iter();
        let blind = stages.find(|judged| judged.residual.is_none());
        let why = self.left_out.iter().map(|why| format!("; {why}"));
        let why = why.collect::<String>();
        match (self.first(), &self.cause, blind) {
            (Some(_), Some(cause), _) => cause.words(),
            (Some(_), None, _) => self.off() + &why,
            (None, _, Some(judged)) => {
                format!("no stage that can be checked differs: {}", judged.note)
            }
            _ if why.is_empty() => "no stage differs beyond the error of its step".to_owned(),
            _ => format!("no stage differs{why}"),
        }
    }

    /// Returns the first stage that is off with its residual and place; empty if none is.
    pub fn off(&self) -> String {
        let mut stages = self.stages.iter();
        let judged = stages.find(|judged| judged.is_off());
        judged.map_or_else(String::new, |judged| {
            let (name, note) = (judged.stage.name(), &judged.note);
            let residual = percent(judged.residual.unwrap_or(f64::NAN));
            let comma = if note.starts_with("of ") { "" } else { "," };
            format!("{name}: off by {residual}{comma} {note}")
        })
    }

    /// Keeps only plots of stages that are off, with values above 0.
    pub(super) fn with_pictures(mut self) -> Self {
        let off = self.stages.iter().filter(|judged| judged.is_off());
        let off: Vec<Stage> = off.map(|judged| judged.stage).collect();
        self.pictures.retain(|picture| {
            let mut values = picture.curves.iter().flat_map(|(_, values)| values);
            off.contains(&picture.stage) && values.any(|value| *value > 0.0)
        });
        self
    }

    /// Withdraws the judgement of the motion, which a still smaller step must confirm.
    pub(super) fn unconfirmed(mut self) -> Self {
        let note = "a still smaller step would tell, at more than the cost of the run";
        let motion = self.stages.iter_mut().filter(|judged| {
            judged.is_off() && [Stage::Equations, Stage::Integration].contains(&judged.stage)
        });
        motion.for_each(|judged| *judged = Judged::unknown(judged.stage, note));
        self.with_pictures()
    }

    /// Returns [`words`](Self::words) with the native runs that confirm the cause.
    pub fn in_full(&self) -> String {
        let distance = self.cause.as_ref().and_then(|cause| cause.distance);
        let confirmed = distance.map_or_else(String::new, |distance| {
            let [without, with] = distance.map(percent);
            format!("; a native run with it is {with} away, without it {without}")
        });
        self.words() + &confirmed
    }
}

/// Relative distance from a native run below which nothing needs an explanation.
const NEAR: f64 = 1e-5;
/// Number of intervals to which changes are fitted: least, most without friction, most with friction.
const FITTED: [usize; 3] = [3, 7, 10];
/// Number of flows per interval that the search may use.
const FLOWS: u64 = 64;
/// Least number of judged intervals; more may use at most an eighth of the remaining evaluations.
const INTERVALS: usize = 8;
/// Largest relative distance of a run from a native one with its cause.
const WITH: f64 = 0.05;
/// Least and largest number of samples of the native run that confirms a cause, and evaluations per sample in two runs.
const CONFIRMED: [usize; 2] = [20, 60];
const CONFIRMS: u64 = 300;

/// Run to be judged.
#[derive(Clone, Copy)]
pub struct Runs<'a> {
    /// Name of the engine.
    pub name: &'a str,
    /// Run with columns of its states.
    pub run: &'a TimeSeries,
    /// Run at the same samples with a smaller step or tolerance, and the expected factor between the errors.
    pub finer: Option<(&'a TimeSeries, f64)>,
    /// Largest numbers of force evaluations, without and with the search for a cause.
    pub evaluations: [u64; 2],
}

/// Judges every stage of a run and searches for the cause if one is off. Returns `None` if the scene has no reduced form or the
/// run lacks a standard column.
pub fn locate(gearbox: &Gearbox, runs: Runs<'_>) -> Option<Located> {
    let work = &Work::new(gearbox, runs.evaluations[0]);
    let mut native = Model::new(work, Vec::new())?;
    let states = states::Columns::of(gearbox, native.free());
    let best = runs.finer.map_or(runs.run, |(finer, _)| finer);
    let missing = states.missing(best);
    let mut located = Located {
        run: runs.name.to_owned(),
        ..Located::default()
    };
    let mut samples = motion::samples(gearbox, &states, best, SAMPLES);
    let start = match samples.first().filter(|first| first.time_s == 0.0) {
        Some(first) => {
            let (judged, picture) = start(&first.y, &native, &states.coordinates);
            located.pictures.push(picture);
            judged
        }
        None => Judged::unknown(Stage::Start, "needs a sample at t = 0"),
    };
    if !missing.is_empty() {
        let note = format!("needs these columns: {}", missing.join(", "));
        let blind = |stage| Judged::unknown(stage, &note);
        located.stages = Stage::ALL.map(blind).into();
        located.stages[0] = start;
        // Positions alone determine which pairs touch.
        let known = native.start();
        let half = known.len() / 2;
        for sample in &mut samples {
            sample.y[half..].copy_from_slice(&known[half..]);
        }
        let mut places = samples.iter().flat_map(|sample| &sample.y);
        if places.all(|y| y.is_finite()) {
            let columns = forces::Columns::of(gearbox, &mut native, best, &samples)?;
            let (differ, first) = columns.search(false);
            located.stages[1] = Judged::measured(Stage::ContactSearch, differ, 0.0, first);
            located.pictures.extend(columns.pictures());
        }
        return Some(located.with_pictures());
    }
    let columns = forces::Columns::of(gearbox, &mut native, best, &samples)?;
    located.pictures.extend(columns.pictures());
    let rough = runs.finer.and_then(|_| {
        let samples = motion::samples(gearbox, &states, runs.run, SAMPLES);
        forces::Columns::of(gearbox, &mut native, runs.run, &samples)
    });
    located.stages = vec![start];
    located.stages.extend(by_columns(&columns, rough.as_ref()));
    let sought = Cell::new(false);
    let search = || {
        // The search leaves evaluations to confirm its cause.
        work.allow(runs.evaluations[1].saturating_sub(CONFIRMS * CONFIRMED[0] as u64));
        sought.set(true);
    };
    let of_columns = |located: &Located| {
        search();
        // Forces are exact to rounding, or their error falls with the step.
        let off = located.stages.iter().filter(|judged| judged.is_off());
        let noise = off.filter_map(|judged| Some((judged.bound / judged.residual?).powi(2)));
        let least = (1.0 - noise.fold(0.0, f64::max)).clamp(EXPLAINED, EXACT);
        // Large errors of the geometry are linear only in penetrations.
        forces::POWERS.into_iter().find_map(|power| {
            let stacked = |rows: &[Vec<f64>]| columns.stacked(rows, power);
            let [written, base] = [&columns.written, &columns.native].map(|rows| stacked(rows));
            let both = [&written[..], &base[..]];
            cause(work, both, least, Suspect::shows_in_columns, &|model| {
                Some(stacked(&forces::rows(model, &samples)))
            })
        })
    };
    let off = |located: &Located, stages: &[Stage]| {
        let mut of = located.stages.iter();
        of.any(|judged| stages.contains(&judged.stage) && judged.is_off())
    };
    let motion = [Stage::Equations, Stage::Integration];
    let untold = |note: &str| motion.map(|stage| Judged::unknown(stage, note));
    let mut suspect = None;
    let hides = [Stage::ContactSearch, Stage::Law, Stage::Assembly];
    let is_loaded = load_profile::largest(&gearbox.scene.drive) > 0.0;
    if off(&located, &hides) || !is_loaded {
        located.stages.extend(untold(match is_loaded {
            true => "hidden by an earlier stage",
            false => "needs a load, by whose work the motion is measured",
        }));
        if off(&located, &Stage::ALL) {
            suspect = of_columns(&located);
        }
    } else if let Some((fine, samples, each)) = judged_motion(work, &mut native, &states, best) {
        let finer = runs.finer.map(|(_, falls)| falls);
        let rough =
            finer.and_then(|_| Motion::of(gearbox, &mut native, &states, runs.run, &samples));
        let rough = rough.as_ref();
        let pictures = fine.pictures(rough, &states.coordinates);
        located.pictures.extend(pictures);
        located.stages.extend(fine.judged(rough.zip(finer)));
        let is_open = rough.is_none() || off(&located, &[Stage::Equations]);
        // Pins that keep their rates are recognised without a search.
        if fine.size() > FLOW && is_open && !fine.keeps_pins() {
            search();
            let most = (work.left() / (FLOWS * each)) as usize;
            let [least, ..] = FITTED;
            let few = fine.few(most.clamp(least, FITTED[1 + usize::from(gearbox.has_friction())]));
            let [reached, base] = few.ends();
            let sure = if rough.is_some() { EXPLAINED } else { SURE };
            let both = [&reached[..], &base[..]];
            suspect = cause(work, both, sure, Suspect::moves_alone, &|model| {
                few.flows(model)
            });
        }
        let is_open = suspect.is_none() && work.left() > 0 && !fine.keeps_pins();
        let alone = is_open && fine.is_alone();
        for judged in &mut located.stages {
            match judged.stage {
                Stage::Equations if suspect.is_some() => judged.residual = Some(fine.size()),
                // Errors of the equations appear in all intervals.
                Stage::Equations if alone && judged.is_off() => judged.stage = Stage::Integration,
                Stage::Integration if alone && judged.residual.is_none() => {
                    judged.stage = Stage::Equations;
                }
                _ => {}
            }
        }
        if suspect.is_none() && off(&located, &[Stage::Driver]) {
            suspect = of_columns(&located);
        }
    } else {
        let note = "the native motion from its states ends early";
        located.stages.extend(untold(note));
    }
    located.stages.sort_by_key(|judged| judged.stage);
    let is_ended = work.left() == 0;
    work.allow(runs.evaluations[1]);
    let shown = suspect.map(|suspect| {
        let changes = changes(&suspect);
        // Changes of the written columns do not affect the motion.
        let moves = changes.iter().any(|(change, _)| change.moves());
        let distance = moves
            .then(|| distance(work, changes, &states, best))
            .flatten();
        Cause {
            distance,
            ..suspect.0
        }
    });
    // A native run with the cause must be nearer to the run, unless the distance is negligible already.
    located.cause = shown.filter(|cause| {
        let mut distance = cause.distance.iter();
        distance.all(|[without, with]| *without < NEAR || *with <= WITH.min(0.5 * without))
    });
    if located.cause.is_none() && sought.get() && off(&located, &Stage::ALL) {
        let why = match is_ended {
            true => "the search for its cause ended at the cost of the run",
            false => "no known fault explains it",
        };
        located.left_out = Some(why.to_owned());
    }
    located.evaluations = [work.taken(), runs.evaluations[0]];
    Some(located.with_pictures())
}

/// Returns the motion of a run over as many intervals as the evaluations allow, the samples at which they begin, and the
/// evaluations per interval; `None` if the native flow fails.
fn judged_motion(
    work: &Work<'_>,
    native: &mut Model<'_>,
    states: &states::Columns,
    run: &TimeSeries,
) -> Option<(Motion, Vec<motion::Sample>, u64)> {
    let mut of = |most: usize| {
        let samples = motion::samples(work.gearbox, states, run, most);
        let motion = Motion::of(work.gearbox, native, states, run, &samples)?;
        Some((motion, samples))
    };
    let before = work.taken();
    let mut judged = of(INTERVALS)?;
    let each = ((work.taken() - before) / INTERVALS as u64).max(1);
    // A run with a larger step costs as much.
    let most = (work.left() / (16 * each)) as usize;
    if most > INTERVALS {
        judged = of(most.min(SAMPLES))?;
    }
    Some((judged.0, judged.1, each))
}

/// Judges contact search, law, assembly and driver by columns. `rough` has the columns of a run with a larger step: a lag of
/// the forces falls with the step.
pub(super) fn by_columns(
    columns: &forces::Columns,
    rough: Option<&forces::Columns>,
) -> [Judged; 4] {
    let column = |stage, of: Range<usize>| {
        let (residual, note) = columns.worst(of.clone());
        let falls = rough.map_or(0.0, |rough| rough.worst(of).0 - residual);
        Judged::measured(stage, residual, ROUNDING + falls.abs(), note)
    };
    let (differ, first) = columns.search(true);
    [
        Judged::measured(Stage::ContactSearch, differ, 0.0, first),
        column(Stage::Law, columns.forces()),
        column(Stage::Assembly, forces::OUTPUT..forces::OUTPUT + 1),
        column(Stage::Driver, forces::DRIVER..forces::DRIVER + 1),
    ]
}

/// Judges an initial state by its largest difference from the scene's start, relative to the state or to 1, and plots it over
/// the named coordinates. NaN counts as unknown.
pub(super) fn start(
    first: &[f64],
    native: &Model<'_>,
    coordinates: &[String],
) -> (Judged, Picture) {
    let known = native.start();
    let off = |(a, b): (&f64, &f64)| (a - b).abs() / b.abs().max(1.0);
    let off: Vec<f64> = first.iter().zip(&known).map(off).collect();
    let count = coordinates.len();
    let list = (0..off.len()).filter(|k| off[*k].is_finite());
    let most = list.max_by(|&a, &b| off[a].total_cmp(&off[b])).unwrap_or(0);
    let of = &coordinates[most % count];
    let kind = if most < count { "" } else { "rate of " };
    let note = match off[most] {
        0.0 => String::new(),
        _ => format!(
            "{kind}{of} is {:.6} for {:.6} at t = 0",
            first[most], known[most]
        ),
    };
    let both = (0..count).map(|k| off[k].max(off[count + k])).collect();
    (
        Judged::measured(Stage::Start, off[most], ROUNDING, note),
        Picture::over_columns(Stage::Start, &[both], coordinates.to_vec()),
    )
}

/// Returns the relative L2 distance of a run's forces from the native flow from the same state, without changes and with them.
fn distance(
    work: &Work<'_>,
    changes: Changes<'_>,
    states: &states::Columns,
    run: &TimeSeries,
) -> Option<[f64; 2]> {
    let [least, most] = CONFIRMED;
    let most = ((work.left() / CONFIRMS) as usize).clamp(least, most);
    let times = &run.time_s()[..run.len().min(most)];
    let of = |changes| {
        let mut model = Model::new(work, changes)?;
        let all = model.follow(times[0], &states.at(run, 0), times)?;
        let samples = motion::numbered(times, all);
        Some(forces::Columns::of(work.gearbox, &mut model, run, &samples)?.distance())
    };
    Some([of(Vec::new())?, of(changes)?])
}
