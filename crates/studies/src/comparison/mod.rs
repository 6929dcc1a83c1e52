//! Comparison of one scene on several engines, with foreign data.
//!
//! [`run`] returns an [`Outcome`], which is data only; [`Outcome::write`] writes its files.

mod context;
pub mod foreign;
mod inputs;
mod lanes;
pub(crate) mod outlook;
pub(crate) mod refine;
mod twins;

use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use pinwheel_compare::comparison::PairEntry;
use pinwheel_compare::limits::Friction;
use pinwheel_compare::model::{ModelTolerance, Prediction};
use pinwheel_compare::{
    Comparison, Divergence, Ladder, Metric, Participant, Rules, SharedModel, Status, Verdict,
    WindowKind, compare,
};
use pinwheel_engines::{Engine, external, recorded};
use pinwheel_gearbox::{Explanation, Gearbox, Statement};
use pinwheel_scene::{Assumption, Scene, assumptions};
use pinwheel_timeseries::columns;
use serde::Serialize;

use crate::band::{self, Bands};
use crate::control::{Control, Progress, TimeLimit, WITHIN};
use crate::design::limits::Limits;
use crate::motion::Motion;
use crate::output::{self, OutputError};
use crate::provenance::{Provenance, Summary};
use crate::single::{RunRecord, save};
use crate::stages::{self, Located};
use crate::{StudyError, divergence};
pub use context::context;
use foreign::Data;
pub use lanes::{Ahead, Lanes, ahead, store};
pub use refine::Effort;
#[doc(hidden)]
pub use refine::refine;
pub use twins::{MatchedContactRun, TwinFigure};

/// Inputs of a comparison.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Compiled scene; with foreign data as returned by [`foreign::with_channels`].
    pub gearbox: &'a Gearbox,
    /// Engines, see [`crate::choice::engines`].
    pub engines: &'a [Box<dyn Engine>],
    /// Foreign data.
    pub data: &'a [Data],
}

/// Comparison with all its evidence.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Compiled scene of the runs.
    pub gearbox: Gearbox,
    /// Figures, distances, limits and verdicts.
    pub comparison: Comparison,
    /// Runs of the engines in their order, then the foreign data.
    pub participants: Vec<Participant>,
    /// Modelled and omitted parts.
    pub model: Explanation,
    /// Assumed values with their basis.
    pub assumptions: Vec<Assumption>,
    /// Figures with other contact laws and fits; `None` without a comparison.
    pub bands: Option<Bands>,
    /// Loads of the parts against their limits; `None` for a gear without a balance.
    pub limits: Option<Limits>,
    /// Engines with contacts of their own against native runs with the same contacts.
    pub twins: Vec<MatchedContactRun>,
    /// Motion of the gearbox, for a page.
    pub motion: Option<Motion>,
    /// Stages at which engines with the scene's law differ, with the reasons.
    pub stages: Vec<Located>,
}

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Payload<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    modelled: &'a [Statement],
    left_out: &'a [Statement],
    assumptions: &'a [Assumption],
    #[serde(skip_serializing_if = "Option::is_none")]
    by_contact_law: Option<&'a Bands>,
    twins: &'a [MatchedContactRun],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    stages: &'a [Located],
    scene: &'a Scene,
}

/// Runs every engine and compares them with their numerical uncertainties. A failure of an engine is in its [`Status`].
///
/// # Errors
/// Cancelled; a scene that cannot be modelled; data that do not fit it.
pub fn run(input: &Input<'_>, control: &Control<'_>) -> Result<Outcome, StudyError> {
    run_with(input, Effort::of(&input.gearbox.scene), control)
}

/// Runs a comparison like [`run`], with the given effort.
///
/// # Errors
/// Errors of [`run`].
pub fn run_with(
    input: &Input<'_>,
    effort: Effort,
    control: &Control<'_>,
) -> Result<Outcome, StudyError> {
    run_on(input, effort, &Lanes::default(), control)
}

/// Runs a comparison like [`run_with`] on the given threads and processes. Results do not depend on their number.
///
/// # Errors
/// Errors of [`run`].
pub fn run_on(
    input: &Input<'_>,
    effort: Effort,
    lanes: &Lanes<'_>,
    control: &Control<'_>,
) -> Result<Outcome, StudyError> {
    let scene = &input.gearbox.scene;
    let model = pinwheel_gearbox::explain(input.gearbox);
    // The progress of single runs does not indicate the time of the others.
    let pieces = |at: Progress<'_>| {
        if at.simulated_s.is_none() {
            (control.progress)(at);
        }
    };
    let control = &control.limited(control.cancel, &pieces);
    let total = input.engines.len() + 1;
    let at = Progress::new(0, total, "divergence of a rounding");
    (control.progress)(at);
    let several = input.engines.len() + input.data.len() > 1;
    let mut context = context(scene);
    if several {
        context.divergence = divergence(input.gearbox, at, control)?;
    }
    let (mut participants, evidence) = lanes.refine(input, &context, effort, control)?;
    (control.progress)(Progress::new(total, total, "differences"));
    let (mut stated, mut measured) = (Vec::new(), Vec::new());
    let inputs = if input.data.is_empty() {
        Vec::new()
    } else {
        inputs::uncertainty(scene, control)?
    };
    for data in input.data {
        let (participant, limits) = data.take_part(scene, &participants)?;
        measured.extend(data.uncertainties(&participant.time_series, &inputs));
        participants.push(participant);
        stated.extend(limits);
    }
    let infos = input.engines.iter().map(|engine| engine.info());
    let own = infos.flat_map(|info| info.model.iter().map(move |stated| (info.name, *stated)));
    let tolerances: Vec<(&str, ModelTolerance)> = own.chain(of_solvers()).collect();
    let solvers = input.engines.iter().map(|engine| engine.info());
    let solvers = solvers.filter(|info| info.brought).map(|info| info.name);
    let brought: Vec<&str> = solvers.chain(input.data.iter().map(Data::name)).collect();
    let rules = Rules {
        brought: &brought,
        stated: &stated,
        evidence: &evidence,
        tolerances: &tolerances,
        data: &measured,
        resolution: effort.resolution,
    };
    let comparison = compare(&context, &participants, &rules)?;
    let twins = twins::of(input.gearbox, &comparison, &participants, control)?;
    let stages = stages::of_comparison(
        input.gearbox,
        input.engines,
        &comparison,
        &participants,
        control,
    )?;
    let bands = band::of(input.gearbox, control)?;
    let mut outcome = Outcome {
        stages,
        gearbox: input.gearbox.clone(),
        comparison,
        participants,
        model,
        assumptions: assumptions(scene),
        limits: Limits::of_gear(input.gearbox, bands.as_ref(), control.cancel)?,
        bands,
        twins,
        motion: Motion::of(input.gearbox, control)?,
    };
    // Verdicts of pairs include neither twins nor failed runs.
    outcome.comparison.passed = outcome.exit_status() == 0 && outcome.broken(false).is_none();
    Ok(outcome)
}

/// Difference of an engine's peaks from which the comparison passes only with an explanation.
const EXPLAINED: f64 = 0.1;
/// Forces, N, and torques, N m, that count as zero for a gear without load.
const ROUNDING: f64 = 1e-6;

/// Largest difference of a figure between an engine and the native solver, judged or not.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest<'a> {
    /// Engine or measured data.
    pub engine: &'a str,
    /// True if `engine` is measured data.
    pub measured: bool,
    /// Column or group of columns: the largest force, or the mean torque.
    pub quantity: &'static str,
    /// Value of the native solver.
    pub here: f64,
    /// Value of the engine.
    pub there: f64,
    /// Native run with the engine's own contacts, if these are not the scene's law.
    pub twin: Option<&'a MatchedContactRun>,
    /// Verdict on the two values, if they were compared.
    pub verdict: Option<Verdict>,
}

impl Largest<'_> {
    /// Returns the relative difference.
    pub fn share(&self) -> f64 {
        (self.there / self.here - 1.0).abs()
    }

    /// True if both agree, or if the engine agrees with its twin, so that its own contacts explain the difference.
    pub fn is_explained(&self) -> bool {
        let twin = self.twin.map(|twin| twin.verdict);
        [self.verdict, twin].contains(&Some(Verdict::Agree))
    }
}

impl Outcome {
    /// Returns the largest difference between the native solver and another participant in mean torque or largest force, at
    /// their common samples; in the steady window if there is one.
    pub fn largest(&self) -> Option<Largest<'_>> {
        let windows = &self.comparison.windows;
        let steady = windows.iter().find(|w| w.kind != WindowKind::Transient);
        // During the start-up other contacts oscillate differently.
        let window = steady.or(windows.first())?.kind;
        let native = |p: &&Participant| p.track == SharedModel::Native && p.status.is_finished();
        let native = self.participants.iter().rfind(native)?;
        let others = self.participants.iter();
        let others = others.filter(|p| match p.track {
            SharedModel::Native => false,
            SharedModel::OwnContact => steady.is_some(),
            SharedModel::SharedLaw | SharedModel::Measured => true,
        });
        let all = others.flat_map(|other| {
            let mut pairs = self.comparison.pairs.iter();
            let pair = pairs.find(|pair| {
                let both = [&pair.a, &pair.b];
                both.contains(&&native.name) && both.contains(&&other.name)
            });
            let quantities = [
                columns::EXTERNAL_FORCE,
                columns::INTERNAL_FORCE,
                columns::INPUT_TORQUE,
            ];
            quantities.into_iter().filter_map(move |quantity| {
                let mut entries = pair?.entries.iter();
                let entry = entries.find(|e| e.quantity == quantity && e.window == window)?;
                let [here, there] = both(entry, pair?.a == native.name)?;
                Some(Largest {
                    engine: &other.name,
                    measured: other.track == SharedModel::Measured,
                    quantity,
                    here,
                    there,
                    twin: self.twins.iter().find(|twin| twin.engine == other.name),
                    verdict: Some(entry.result.verdict),
                })
            })
        });
        let loaded = |most: &Largest<'_>| most.here.abs().max(most.there.abs()) > ROUNDING;
        all.filter(|most| loaded(most) && most.share().is_finite())
            .max_by(|a, b| a.share().total_cmp(&b.share()))
    }

    /// True if an unexplained difference remains.
    pub fn is_unexplained(&self) -> bool {
        let largest = self.largest();
        largest.is_some_and(|cause| cause.share() > EXPLAINED && !cause.is_explained())
    }

    /// Returns the exit status: also 1 if an engine differs from its twin.
    pub fn exit_status(&self) -> u8 {
        let twins = self.twins.iter();
        match self.comparison.exit_status() {
            _ if twins.clone().any(|twin| twin.verdict == Verdict::Differ) => 1,
            status => status,
        }
    }

    /// Returns the error of the first engine without a result, with a remedy. Engines that do not support the scene count only
    /// if they were `asked` for by name.
    pub fn broken(&self, asked: bool) -> Option<String> {
        let mut each = self.participants.iter();
        each.find_map(|participant| {
            let remedy = match participant.status {
                Status::Finished => return None,
                Status::Unsupported { .. } | Status::Absent { .. } if !asked => return None,
                // A solver added by its manifest counts as asked for.
                Status::TimedOut { .. } if !asked && !has_joined(&participant.name) => return None,
                Status::Diverged { .. } => {
                    "try a smaller solver.step_s or another solver.integrator"
                }
                _ => "leave it out with --engines, or change the scene",
            };
            let reason = participant.status.reason().unwrap_or_default();
            Some(format!("{} {reason}; {remedy}", participant.name))
        })
    }

    /// Writes `summary.json` into the folder `dir`, and for each participant a folder with `courses.csv` and `run.json`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, origin: &Provenance) -> Result<(), OutputError> {
        for participant in &self.participants {
            let (status, cost) = (&participant.status, &participant.cost);
            if !matches!(status, Status::Finished | Status::Diverged { .. }) {
                continue;
            }
            let place = output::folder(dir, &participant.name)?;
            if participant.track == SharedModel::Measured {
                // Time series as compared.
                save(&participant.time_series, &place.join("courses.csv"))?;
                continue;
            }
            let engine = (&*participant.name, &*participant.version, participant.track);
            RunRecord::new(engine, &self.gearbox.scene, status, cost, origin)
                .write(&place, &participant.time_series)?;
        }
        let results = Payload {
            comparison: &self.comparison,
            modelled: &self.model.modelled,
            left_out: &self.model.left_out,
            assumptions: &self.assumptions,
            by_contact_law: self.bands.as_ref(),
            twins: &self.twins,
            stages: &self.stages,
            scene: &self.gearbox.scene,
        };
        Summary::new(origin, results).write(dir)
    }
}

/// Returns the figure of both sides of a pair, the first side's first if `in_order`: the mean of a torque, the peak of a force.
fn both(entry: &PairEntry, in_order: bool) -> Option<[f64; 2]> {
    let metrics = entry.metrics.as_ref()?;
    let (ratio, larger) = match entry.quantity.as_str() {
        columns::INPUT_TORQUE => (metrics.mean_ratio?, metrics.larger_mean?),
        _ => (metrics.peak_ratio?, metrics.larger_peak?),
    };
    let [a, b] = match ratio.abs() >= 1.0 {
        true => [larger, larger / ratio],
        false => [larger * ratio, larger],
    };
    Some(if in_order { [a, b] } else { [b, a] })
}

fn has_joined(engine: &str) -> bool {
    let joined = external::joined();
    joined.iter().any(|solver| solver.name() == engine)
}

/// Returns the tolerances that authors of added solvers state for their own contact models, in the steady window: mean driver
/// torque, and time series of all other quantities.
fn of_solvers<'a>() -> impl Iterator<Item = (&'a str, ModelTolerance)> {
    let joined = external::joined().into_iter();
    joined.flat_map(|solver| {
        let manifest = solver.manifest();
        let model = manifest.model.iter();
        model.map(move |(quantity, stated)| {
            let stated = ModelTolerance {
                friction: Friction::Any,
                window: Some(WindowKind::Steady),
                quantity,
                metric: match quantity.as_str() {
                    columns::INPUT_TORQUE => Metric::Mean,
                    _ => Metric::RelativeL2,
                },
                predicted: Prediction::Same,
                tolerance: stated.tolerance,
                reason: &stated.reason,
            };
            (manifest.name.as_str(), stated)
        })
    })
}

/// Function of the CPU time of a run, see [`take_part`].
type After<'a> = dyn Fn(f64) -> f64 + Sync + 'a;
/// Share of a run from which on it indicates its duration: error control takes short steps through the start-up.
const FORETELLS: f64 = 0.15;

/// Runs one engine, within `most` if stated, and returns it as a participant with any ending, and the coarser runs of its own
/// verification. `after`: cost of the runs that follow over that of this one, if this one takes so much CPU time, s; for the
/// remaining time.
fn take_part(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    most: Option<Duration>,
    after: &After<'_>,
    at: Progress<'_>,
    control: &Control<'_>,
) -> Result<(Participant, Option<Ladder>), StudyError> {
    // Time counts from the first sample, which the start of a program may precede.
    let first = OnceLock::new();
    let tell = |at: Progress<'_>| {
        let left_s = at.simulated_s.and_then(|[reached, of]| {
            let (begun, from) = first.get_or_init(|| (Instant::now(), reached));
            let share = (reached - from) / of;
            let took_s = begun.elapsed().as_secs_f64() / share;
            let cpu_s = at
                .cpu
                .map_or(took_s, |cpu| cpu.as_secs_f64() * of / reached);
            (share > FORETELLS).then(|| took_s * (1.0 - reached / of + after(cpu_s)))
        });
        (control.progress)(Progress {
            left_s: left_s.or(at.left_s),
            ..at
        });
    };
    let control = control.piece(at).limited(control.cancel, &tell);
    let live = || {
        let run = match most {
            Some(most) => TimeLimit {
                most,
                suggested_limit_s: 1.0 / f64::from(WITHIN),
                outside: false,
            }
            .run(engine, gearbox, &control)?,
            None => engine.run_compiled(gearbox, &control)?,
        };
        engine.keep(gearbox, &run, most);
        Ok::<_, StudyError>(run)
    };
    let run = engine.kept(gearbox, most).map_or_else(live, Ok)?;
    // A recording may replace a live engine that is missing here (no Python, no network).
    if let Status::Absent { reason } | Status::Failed { reason } = &run.ending
        && let Some(recorded) = recorded::instead(engine.name(), &gearbox.scene, reason)
    {
        return take_part(recorded.as_ref(), gearbox, most, after, at, &control);
    }
    let info = engine.info();
    let participant = Participant {
        name: info.name.to_owned(),
        track: info.track,
        version: engine.version(),
        summary: info.summary.to_owned(),
        differences: info.differences.to_owned(),
        time_series: run.time_series,
        cost: run.stats,
        status: run.ending,
    };
    Ok((participant, run.uncertainty.and_then(|own| own.ladder)))
}

/// Longest step of the two runs that differ by a rounding, in radians of the contacts' oscillation: 5e-6 s for the paper's
/// gear.
const DIVERGENCE_STEP: f64 = 0.05;

/// Measures the effect of a rounding on the scene; `None` without a comparison, or if it cannot be measured.
#[doc(hidden)]
pub fn divergence(
    gearbox: &Gearbox,
    at: Progress<'_>,
    control: &Control<'_>,
) -> Result<Option<Divergence>, StudyError> {
    control.check()?;
    let control = control.piece(at);
    let control = control.lasting(gearbox.scene.solver.duration_s);
    let watch = &mut |t| control.reached(t);
    match divergence::horizon(gearbox, DIVERGENCE_STEP, watch) {
        Ok(measured) => Ok(Some(measured)),
        Err(StudyError::Cancelled) => Err(StudyError::Cancelled),
        // Another engine may support a scene that the native one refuses.
        Err(_) => Ok(None),
    }
}
