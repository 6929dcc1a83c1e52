//! All stages of a run, one after the other.

use std::ops::Range;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::load_profile;
use pinwheel_timeseries::TimeSeries;
use serde::Serialize;

use super::cause::{self, Cause};
use super::judged::{Depth, EXPLAINED, FLOW, Judged, ROUNDING, SAMPLES, SURE, Stage, percent};
use super::model::{Change, Model};
use super::motion::{self, Motion, Sample};
use super::{forces, states};

/// Answer to the question which stage of a run differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Located {
    /// Who ran.
    pub run: String,
    /// All stages.
    pub stages: Vec<Judged>,
    /// The likely cause.
    pub cause: Option<Cause>,
    /// Residuals in detail.
    pub depth: Depth,
}

impl Located {
    /// The first stage that is off: that of the cause, if there is one.
    #[must_use]
    pub fn first(&self) -> Option<Stage> {
        let off = self.stages.iter().find(|judged| judged.is_off());
        let off = off.map(|judged| judged.stage);
        off.and_then(|stage| {
            self.cause
                .as_ref()
                .map_or(Some(stage), |cause| Some(cause.stage))
        })
    }

    /// One line for the first screen, which begins with `stage` where a stage is off.
    #[must_use]
    pub fn sentence(&self) -> String {
        match self.first() {
            Some(_) => format!("stage {}", self.words()),
            None => self.words(),
        }
    }

    /// The first stage that is off and the likely cause with its figure; or that no stage is.
    #[must_use]
    pub fn words(&self) -> String {
        let Some(first) = self.first() else {
            let mut blind = self.stages.iter();
            let blind = blind.find(|judged| judged.residual.is_none());
            return blind.map_or_else(
                || "no stage is off: what differs is the error of its step".to_owned(),
                |judged| format!("no stage is off of those that can be told: {}", judged.note),
            );
        };
        let name = first.name();
        if let Some(cause) = &self.cause {
            let explained = percent(cause.explained);
            let (word, what) = (cause.word, &cause.what);
            return format!("{name}, likely {word}: {what} explains {explained}");
        }
        let mut stages = self.stages.iter();
        let judged = stages.find(|judged| judged.stage == first);
        judged.map_or_else(String::new, |judged| {
            let residual = percent(judged.residual.unwrap_or(f64::NAN));
            format!(
                "{name}: off by {residual}, {}; no known fault explains it",
                judged.note
            )
        })
    }

    /// Returns the sentence of [`words`](Self::words) with the native runs that confirm the cause.
    #[must_use]
    pub fn in_full(&self) -> String {
        let distance = self.cause.as_ref().and_then(|cause| cause.distance);
        let confirmed = distance.map_or_else(String::new, |distance| {
            let [without, with] = distance.map(percent);
            format!("; a native run with it is {with} away, without it {without}")
        });
        self.words() + &confirmed
    }
}

/// Distance of a run from a native one, relative, of which nothing has to be explained.
const NEAR: f64 = 1e-5;
/// Samples of the native run that shows a cause.
const SHOWN: usize = 60;

/// A run to be judged.
#[derive(Clone, Copy)]
pub struct Runs<'a> {
    /// Name of who ran.
    pub name: &'a str,
    /// The run with columns of its states.
    pub run: &'a TimeSeries,
    /// A run on the same samples with a smaller step or tolerance, and how far its error should fall.
    pub finer: Option<(&'a TimeSeries, f64)>,
}

/// Judges every stage of a run, and looks for the cause where one is off. `None`: the scene has no reduced form, or the run lacks
/// columns that every run has.
#[must_use]
pub fn locate(gearbox: &Gearbox, runs: Runs<'_>) -> Option<Located> {
    let none = Change::None;
    let mut native = Model::new(gearbox, &none, 0.0)?;
    let states = states::Columns::of(gearbox, native.free());
    let best = runs.finer.map_or(runs.run, |(finer, _)| finer);
    let missing = states.missing(best);
    let mut located = Located {
        run: runs.name.to_owned(),
        stages: Vec::new(),
        cause: None,
        depth: Depth::default(),
    };
    if !missing.is_empty() {
        let note = format!("these columns would tell: {}", missing.join(", "));
        let blind = |stage| Judged::untold(stage, &note);
        located.stages = Stage::ALL.map(blind).into();
        return Some(located);
    }
    let samples = motion::samples(gearbox, &states, best, SAMPLES);
    let columns = forces::Columns::of(gearbox, &mut native, best, &samples)?;
    located.depth = columns.depth(&mut native, gearbox.layout, &samples);
    let rough = runs.finer.and_then(|_| {
        let samples = motion::samples(gearbox, &states, runs.run, SAMPLES);
        forces::Columns::of(gearbox, &mut native, runs.run, &samples)
    });
    let judged = |stage, (residual, note), bound| Judged {
        stage,
        residual: Some(residual),
        bound,
        note,
    };
    // Forces that lag by a part of the step fall with it.
    let column = |stage, of: Range<usize>| {
        let (residual, note) = columns.worst(of.clone());
        let falls = rough
            .as_ref()
            .map_or(0.0, |rough| rough.worst(of).0 - residual);
        judged(stage, (residual, note), ROUNDING + falls.abs())
    };
    located.stages = vec![
        start(&native, &samples).map_or_else(
            || Judged::untold(Stage::Start, "a sample at t = 0 would tell"),
            |start| judged(Stage::Start, start, ROUNDING),
        ),
        judged(Stage::ContactSearch, columns.search(), 0.0),
        column(Stage::Law, columns.forces()),
        column(Stage::Assembly, forces::OUTPUT..forces::OUTPUT + 1),
        column(Stage::Driver, forces::DRIVER..forces::DRIVER + 1),
    ];
    let by_columns = |sure| {
        let [written, base] = [&columns.written, &columns.native].map(|rows| columns.stacked(rows));
        cause::cause(gearbox, [&written, &base], sure, &|model| {
            Some(columns.stacked(&forces::rows(model, &samples)))
        })
    };
    let off = |located: &Located, stages: &[Stage]| {
        let mut of = located.stages.iter();
        of.any(|judged| stages.contains(&judged.stage) && judged.is_off())
    };
    let mut found = None;
    let hides = [Stage::ContactSearch, Stage::Law, Stage::Assembly];
    let is_loaded = load_profile::largest(&gearbox.scene.drive) > 0.0;
    if off(&located, &hides) || !is_loaded {
        let note = match is_loaded {
            true => "hidden by an earlier stage",
            false => "a load would tell: the motion is measured by what it does",
        };
        let stages = [Stage::Equations, Stage::Integration];
        let untold = stages.map(|stage| Judged::untold(stage, note));
        located.stages.extend(untold);
        found = off(&located, &Stage::ALL)
            .then(|| by_columns(EXPLAINED))
            .flatten();
    } else if let Some(fine) = Motion::of(gearbox, &mut native, &states, best, &samples) {
        let rough = runs.finer.and_then(|(_, falls)| {
            let rough = Motion::of(gearbox, &mut native, &states, runs.run, &samples)?;
            Some((rough, falls))
        });
        located.depth.motion = fine.sizes();
        located
            .stages
            .extend(fine.judged(rough.as_ref().map(|(rough, falls)| (rough, *falls))));
        if fine.size() > FLOW && (rough.is_none() || off(&located, &[Stage::Equations])) {
            let [reached, base] = [&fine.reached, &fine.flowed].map(|states| fine.stacked(states));
            let sure = if rough.is_some() { EXPLAINED } else { SURE };
            found = cause::cause(gearbox, [&reached, &base], sure, &|model| {
                Some(fine.stacked(&fine.flows(model)?))
            });
        }
        let alone = found.is_none() && fine.is_alone();
        for judged in &mut located.stages {
            match judged.stage {
                Stage::Equations if found.is_some() => judged.residual = Some(fine.size()),
                // Equations are wrong at all times.
                Stage::Equations if alone && judged.is_off() => judged.stage = Stage::Integration,
                Stage::Integration if alone && judged.residual.is_none() => {
                    judged.stage = Stage::Equations;
                }
                _ => {}
            }
        }
        if found.is_none() && off(&located, &[Stage::Driver]) {
            found = by_columns(EXPLAINED);
        }
    }
    located.stages.sort_by_key(|judged| judged.stage);
    let shown = found.map(|(cause, change)| Cause {
        distance: distance(gearbox, &change, cause.size, &states, best),
        ..cause
    });
    // A native run has to come nearer with it, unless it was there.
    located.cause = shown.filter(|cause| {
        let mut distance = cause.distance.iter();
        distance.all(|[without, with]| *without < NEAR || *with <= 0.5 * without)
    });
    Some(located)
}

/// Largest difference of the first state from the scene's start, as a share of the state or of 1, and its place in words.
/// `None` for a run that does not begin at 0.
fn start(native: &Model<'_>, samples: &[Sample]) -> Option<(f64, String)> {
    let first = samples.first().filter(|first| first.time_s == 0.0)?;
    let known = native.start();
    let off = first
        .y
        .iter()
        .zip(&known)
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0));
    let angles = native.free().len();
    let most = off.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
    most.map(|(k, off)| {
        let kind = if k % (known.len() / 2) < angles {
            "an angle or rate"
        } else {
            "a place"
        };
        (off, format!("{kind} at t = 0"))
    })
}

/// Relative L2 distance of a run's forces from the native flow that starts where it starts, without a change and with it.
fn distance(
    gearbox: &Gearbox,
    change: &Change,
    size: f64,
    states: &states::Columns,
    run: &TimeSeries,
) -> Option<[f64; 2]> {
    let times = run.time_s();
    let none = Change::None;
    let mut both = [(&none, 0.0), (change, size)].map(|(change, size)| {
        let mut model = Model::new(gearbox, change, size)?;
        let mut y = states.at(run, 0);
        let mut samples = Vec::new();
        for number in 0..times.len().min(SHOWN) {
            if let Some(before) = number.checked_sub(1) {
                y = model.flow(times[before], &y, times[number])?;
            }
            samples.push(Sample {
                number,
                time_s: times[number],
                y: y.clone(),
            });
        }
        Some(forces::Columns::of(gearbox, &mut model, run, &samples)?.distance())
    });
    Some([both[0].take()?, both[1].take()?])
}
