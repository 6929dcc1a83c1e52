//! Conformance check of an external solver: trials of everything that comparisons rely on.
//!
//! A trial takes one or two short runs of the preset `paper`, or of a scene that the solver supports. A solver that uses the
//! scene's contact law is compared with the native solver column by column, on every law and kind of contact it supports. A
//! solver with its own contacts is checked for signs and magnitudes.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{LazyLock, OnceLock};
use std::time::{Duration, Instant};

use pinwheel_compare::quantities::{Quantity, derive};
use pinwheel_contact::laws;
use pinwheel_engines::external::Solver;
use pinwheel_engines::{
    AccuracySetting, Cancelled, Ending, Engine, Halt, Native, Run, SharedModel,
};
use pinwheel_gearbox::Frequencies;
use pinwheel_scene::{CheckedScene, Override, Scene};
use pinwheel_timeseries::convergence::{self, KINKS, Method, ORDER_MARGIN, Rough, Step};
use pinwheel_timeseries::norms::{View, mean, relative_l2};
use pinwheel_timeseries::{TimeSeries, columns};
use quick_junit::TestSuite;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::StudyError;
use crate::control::{Control, Progress, compile};
use crate::junit::{self, State};
use crate::output::OutputError;
use crate::provenance::{Provenance, Summary};
use crate::stages::{Located, of_engine};

/// Outcome of one trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Name in tables: `load changes`.
    pub name: &'static str,
    /// Requirement of the trial.
    pub must: &'static str,
    /// Outcome of the trial.
    pub state: State,
    /// Observation in the trial, with figures.
    pub seen: String,
}

/// All trials of one solver.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the solver.
    pub solver: String,
    /// Version of the solver.
    pub version: String,
    /// Part of the model that the solver shares with the native one.
    pub track: SharedModel,
    /// Verdict in one line: agrees, or differs and where.
    pub answer: String,
    /// Outcomes of the trials, in their order.
    pub findings: Vec<Finding>,
    /// Stages judged at the first failure that allows it.
    pub stages: Option<Located>,
}

impl Outcome {
    /// True if no trial failed.
    pub fn passed(&self) -> bool {
        self.count(State::Failed) == 0
    }

    /// Returns the number of findings in a state.
    pub fn count(&self, state: State) -> usize {
        self.findings.iter().filter(|f| f.state == state).count()
    }

    /// Writes `summary.json` into the folder `dir`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, dir: &Path, origin: &Provenance) -> Result<(), OutputError> {
        Summary::new(origin, self).write(dir)
    }

    /// Returns the findings as a suite for CI systems.
    pub fn suite(&self) -> TestSuite {
        let answer = junit::case(&self.answer, junit::passed(self.passed()), &self.answer);
        let findings = self.findings.iter().map(|finding| {
            let name = format!("{}: {}", finding.name, finding.must);
            junit::case(name, finding.state, &finding.seen)
        });
        let name = format!("solver check {}", self.solver);
        junit::suite(&name, [answer].into_iter().chain(findings))
    }
}

/// Observation of a trial that passed.
type Observation = Result<String, Miss>;

/// End of a trial that did not pass.
enum Miss {
    /// Trial that failed or was skipped, with the observation.
    Ended(State, String),
    /// Error that ends the check.
    Study(StudyError),
}

impl<E: Into<StudyError>> From<E> for Miss {
    fn from(error: E) -> Self {
        Self::Study(error.into())
    }
}

fn failed<T>(message: impl ToString) -> Result<T, Miss> {
    Err(Miss::Ended(State::Failed, message.to_string()))
}

fn skipped<T>(message: impl ToString) -> Result<T, Miss> {
    Err(Miss::Ended(State::Skipped, message.to_string()))
}

/// Largest relative difference from the native run in the first sample of a solver that shares the law: rounding.
const FIRST: f64 = 1e-8;
/// Share of the stated order that a solver with a tolerance must show. A tolerance bounds the error of one step only, and step
/// sizes change abruptly.
const TOLERANCE_SHARE: f64 = 0.3;
/// Bound of the native run's own error.
const NATIVE: f64 = 1e-6;
/// Length of a run that is compared with the native solver, radians of the contacts' vibration: two and a half periods.
const SHORT_RAD: f64 = 16.0;
/// Step of that run, radians of the contacts' vibration. The error of Heun's method is then a thousandth.
const STEP_RAD: f64 = 0.02;
/// Largest relative L2 distance of a quantity in a correct short run. Heun's method reaches 8e-5; the smallest fault tried,
/// damping without its ramp, gives 2e-3.
const RIGHT: f64 = 5e-4;
/// Value of [`RIGHT`] for a solver without `[refine]`, whose own error is unknown.
const UNREFINED: f64 = 2e-2;
/// Largest number of runs, each at a quarter of the step, of a solver whose own error may explain that it misses [`RIGHT`].
const LEVELS: i32 = 4;
/// Longest time that a solver may need to stop after a request, s.
const ENDS_S: f64 = 3.0;
/// Time limit of the endless run that tests stopping.
const PATIENCE: Duration = Duration::from_millis(300);

/// Trial as read from `trials.toml`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Trial {
    name: String,
    must: String,
    /// Keys of the trial's scene.
    pub set: Vec<String>,
    /// Noun for the trial's scenes.
    pub what: String,
    /// True if a refusal of a scene is no failure.
    may_refuse: bool,
    /// Scenes that are compared with the native run.
    pub scenes: Vec<Held>,
}

/// Scene that is compared with the native run, or a case of the law vectors.
#[derive(Debug, Clone, Deserialize)]
pub struct Held {
    name: String,
    /// Preset; `paper` by default.
    #[serde(default)]
    preset: Option<String>,
    /// Keys changed in the preset.
    pub set: Vec<String>,
}

/// All trials, from the embedded `trials.toml`.
pub static TRIALS: LazyLock<Vec<Trial>> = LazyLock::new(|| {
    let table: BTreeMap<String, Vec<Trial>> =
        pinwheel_files::parse(include_str!("trials.toml")).unwrap_or_default();
    table.into_values().flatten().collect()
});

/// States and contact forces of one body of a case: case, body, [x, y, angle, vx, vy, rate], force x, force y, moment.
type Vector = (String, usize, [f64; 6], f64, f64, f64);

/// Cases and bodies of the law vectors.
const VECTORS: [&str; 2] = [
    include_str!(concat!(
        env!("PINWHEEL_SHIPPED"),
        "/reference/law-vectors/cases.csv"
    )),
    include_str!(concat!(
        env!("PINWHEEL_SHIPPED"),
        "/reference/law-vectors/bodies.csv"
    )),
];

fn rows<T: DeserializeOwned>(text: &str) -> Vec<T> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().filter_map(Result::ok).collect()
}

/// Inputs of all trials of a solver.
struct Trials<'a> {
    solver: &'a Solver,
    /// Control without progress reports.
    control: Control<'a>,
    /// Keys set in every scene.
    set: [String; 2],
    /// Stages judged at the first failure that allows it.
    stages: OnceLock<Located>,
}

/// Runs all trials of a solver.
///
/// # Errors
/// Stopped; a scene of the suite that cannot be modelled.
pub fn check(solver: &Solver, control: &Control<'_>) -> Result<Outcome, StudyError> {
    let solver = &solver.clone().with_spaces();
    let law = honoured(solver).next().unwrap_or("paper");
    let trials = Trials {
        solver,
        control: Control::silent(control.cancel),
        set: [
            format!("contact.law={law}"),
            "solver.duration_s=0.02".to_owned(),
        ],
        stages: OnceLock::new(),
    };
    let mut findings: Vec<Finding> = Vec::new();
    for (done, trial) in TRIALS.iter().enumerate() {
        control.check()?;
        (control.progress)(Progress::new(done, TRIALS.len(), &trial.name));
        let outcome = match findings.first() {
            Some(first) if first.state == State::Failed => skipped("it does not run"),
            _ => trials.make(trial),
        };
        let (state, outcome) = match outcome {
            Ok(outcome) => (State::Passed, outcome),
            Err(Miss::Ended(state, outcome)) => (state, outcome),
            Err(Miss::Study(error)) => return Err(error),
        };
        findings.push(Finding {
            name: &trial.name,
            must: &trial.must,
            state,
            seen: outcome,
        });
    }
    let track = solver.track();
    Ok(Outcome {
        answer: format!("{}: {}", solver.name(), answer(&findings, track)),
        solver: solver.name().to_owned(),
        version: solver.version(),
        track,
        findings,
        stages: trials.stages.into_inner(),
    })
}

/// Returns the verdict in one line.
fn answer(findings: &[Finding], track: SharedModel) -> String {
    let with = |state: State| findings.iter().filter(move |f| f.state == state);
    if let Some(first) = with(State::Failed).next() {
        return format!("differs: {}: {}", first.name, first.seen);
    }
    if track != SharedModel::SharedLaw {
        return format!(
            "conforms in {} trials; `pinwheel compare paper --solver` judges the figures of contacts of its own",
            with(State::Passed).count()
        );
    }
    match with(State::Passed).find(|f| ["accuracy", "laws"].contains(&f.name)) {
        Some(shown) => format!("agrees: {}", shown.seen),
        None => "nothing shown: no law of its own ran".to_owned(),
    }
}

/// Returns the laws that a solver supports.
fn honoured(solver: &Solver) -> impl Iterator<Item = &'static str> {
    let laws = laws::LAWS.iter().map(|law| law.name);
    laws.filter(|law| solver.manifest().honours_law(law))
}

impl Trials<'_> {
    fn make(&self, trial: &Trial) -> Observation {
        let scene = self.scene("paper", &trial.set)?;
        match trial.name.as_str() {
            "runs" => self.runs(&scene),
            "repeats" => self.repeats(&scene),
            "start" => self
                .start(&scene)
                .or_else(|miss| self.located(&scene, miss)),
            "accuracy" => self
                .accuracy(&scene)
                .or_else(|miss| self.located(&scene, miss)),
            "bad ends" => self.bad_ends(&scene),
            "stop" => self.stop(&scene),
            "laws" => {
                let law = |name: &str| Held {
                    name: name.to_owned(),
                    preset: None,
                    set: vec![format!("contact.law={name}")],
                };
                let laws: Vec<Held> = honoured(self.solver).map(law).collect();
                self.all_held(trial, &laws, &|_, scene| self.held(scene))
            }
            "law vectors" if !self.shares_the_law() => skipped("contacts of its own"),
            "law vectors" => {
                let case = |(name, preset, set): (String, String, String)| Held {
                    name,
                    preset: Some(preset),
                    set: set.split_whitespace().map(str::to_owned).collect(),
                };
                let mut cases: Vec<Held> = rows(VECTORS[0]).into_iter().map(case).collect();
                cases.retain(|case| {
                    let law = case.name.strip_prefix("law-");
                    law.is_none_or(|law| self.solver.manifest().honours_law(law))
                });
                self.all_held(trial, &cases, &|case, scene| self.vector(case, scene))
            }
            _ => self.all_held(trial, &trial.scenes, &|_, scene| self.held(scene)),
        }
    }

    /// Returns a preset with changed keys.
    fn scene(&self, preset: &str, set: &[String]) -> Result<CheckedScene, Miss> {
        let keys = self.set.iter().chain(set).map(|key| key.parse());
        let keys: Result<Vec<Override>, _> = keys.collect();
        Scene::load(preset, &keys.or_else(failed)?).or_else(failed)
    }

    fn shares_the_law(&self) -> bool {
        self.solver.track() == SharedModel::SharedLaw
    }

    /// Runs an engine on a scene. A run that does not finish ends the trial with `state`.
    fn run(&self, engine: &dyn Engine, scene: &CheckedScene, state: State) -> Result<Run, Miss> {
        let ran = engine.run(scene, &self.control)?.finished();
        ran.map_err(|ending| Miss::Ended(state, format!("{} {ending}", engine.name())))
    }

    fn own(&self, scene: &CheckedScene) -> Result<Run, Miss> {
        self.run(self.solver, scene, State::Failed)
    }

    fn native(&self, engine: Native, scene: &CheckedScene) -> Result<TimeSeries, Miss> {
        Ok(self.run(&engine, scene, State::Skipped)?.time_series)
    }

    /// Runs the solver with another value of its accuracy setting (`[refine]`).
    fn at(&self, scene: &Scene, knob: AccuracySetting, setting: f64) -> Result<TimeSeries, Miss> {
        let mut scene = scene.clone();
        knob.set(&mut scene, setting);
        Ok(self.own(&scene.check().or_else(failed)?)?.time_series)
    }

    /// Returns the accuracy setting, the factor between two of its values (`by` for steps), and the order of the error in it.
    fn refinement(&self, by: f64, rough: Rough) -> Option<(AccuracySetting, f64, Method)> {
        let refinement = self.solver.info().refinement?;
        let (order, rough) = (refinement.order, Some(rough));
        let (ratio, method) = match refinement.knob {
            AccuracySetting::Step => (by, Method::Step { order, rough }),
            AccuracySetting::Tolerance => (10.0, Method::Tolerance { order: KINKS }),
        };
        Some((refinement.knob, ratio, method))
    }

    /// Compares the solver with the native one on a short scene and returns the relative L2 distance of the worst quantity. The
    /// solver's setting is refined while its own error may explain that it misses [`RIGHT`].
    fn held(&self, scene: &CheckedScene) -> Result<f64, Miss> {
        let scene = scene.changed(|scene| {
            let rad_s = Frequencies::of(scene).contact_rad_s;
            for change in &mut scene.drive.load_changes {
                change.time_s *= SHORT_RAD / rad_s;
            }
            let solver = &mut scene.solver;
            (solver.duration_s, solver.sample_s) = (SHORT_RAD / rad_s, 0.01 * SHORT_RAD / rad_s);
            (solver.step_s, solver.tolerance) = (STEP_RAD / rad_s, 1e-7);
        });
        let scene = scene.or_else(failed)?;
        let mut fine = self.own(&scene)?.time_series;
        if !self.shares_the_law() {
            return Ok(0.0);
        }
        let truth = self.native(Native::RESOLVED, &scene)?;
        let mut off = apart(&fine, &truth);
        let Some((knob, ratio, method)) = self.refinement(4.0, Rough::Jumps) else {
            return right(off, UNREFINED, &fine, &truth);
        };
        for level in 1..LEVELS {
            if off <= RIGHT {
                break;
            }
            let setting = knob.get(&scene) / ratio.powi(level);
            let coarse = std::mem::replace(&mut fine, self.at(&scene, knob, setting)?);
            off = apart(&fine, &truth);
            let difference = apart(&coarse, &fine);
            let own = convergence::estimate(&[Step { ratio, difference }], None, method, 0.0);
            if !own.is_ok_and(|own| off <= own.u) {
                break;
            }
        }
        right(off, RIGHT, &fine, &truth).or_else(|miss| self.located(&scene, miss))
    }

    /// Compares the first row of a run from a state of the law vectors with their forces.
    fn vector(&self, case: &str, scene: &CheckedScene) -> Result<f64, Miss> {
        let short = scene.changed(|scene| {
            let solver = &mut scene.solver;
            (solver.duration_s, solver.sample_s, solver.step_s) = (1e-7, 1e-7, 1e-7);
        });
        let short = short.or_else(failed)?;
        let gearbox = compile(&short)?;
        let mut bodies: Vec<Vector> = rows(VECTORS[1]);
        bodies.retain(|body| body.0 == case);
        let job = |mut job: Value| {
            let all = job["bodies"].as_array_mut().into_iter().flatten();
            all.zip(&bodies)
                .for_each(|(body, (_, _, start, ..))| body["start"] = json!(start));
            format!("{job:#}")
        };
        let run = self.solver.run_job(&gearbox, job, &self.control)?;
        let row = run.finished().or_else(failed)?.time_series.select(&[0]);
        let mut truth = TimeSeries::new(vec![0.0]).unwrap_or_default();
        let names = columns::of_gearbox(
            gearbox.layout.external_sleeves,
            gearbox.layout.internal_sleeves,
        );
        let pins = &bodies[gearbox.layout.external_bodies().start..];
        for (name, pin) in names.filter(|name| name.contains("_force_n_")).zip(pins) {
            let _ = truth.push(name, vec![pin.3.hypot(pin.4)]);
        }
        right(apart(&row, &truth), FIRST, &row, &truth).or_else(|miss| self.located(scene, miss))
    }

    /// Adds the first stage that differs to the first failure.
    fn located<T>(&self, scene: &CheckedScene, miss: Miss) -> Result<T, Miss> {
        if let Miss::Ended(State::Failed, why) = &miss
            && self.shares_the_law()
            && self.stages.get().is_none()
            && let Some(stage) = of_engine(self.solver, &compile(scene)?, 0.0, None, &self.control)?
        {
            let stage = self.stages.get_or_init(|| stage);
            return failed(format!("{why}; {}", stage.sentence()));
        }
        Err(miss)
    }

    /// Applies `hold` to several scenes. Scenes that the solver's manifest excludes are skipped.
    fn all_held(
        &self,
        trial: &Trial,
        scenes: &[Held],
        hold: &dyn Fn(&str, &CheckedScene) -> Result<f64, Miss>,
    ) -> Observation {
        let (least, truth) = match trial.name.as_str() {
            "law vectors" => (FIRST, "the vectors"),
            _ => (NATIVE, "native-resolved"),
        };
        let (mut worst, mut off, mut not) = (least, Vec::new(), Vec::new());
        for Held { name, preset, set } in scenes {
            let scene = self.scene(preset.as_deref().unwrap_or("paper"), set)?;
            if let Err(Halt::Ended(ending)) = self.solver.supports(&scene) {
                not.push(format!("{name}: {ending}"));
                continue;
            }
            match hold(name, &scene) {
                Ok(near) => worst = worst.max(near),
                Err(Miss::Ended(State::Failed, why))
                    if !(trial.may_refuse && why.contains(CANNOT)) =>
                {
                    let scene = [std::slice::from_ref(name), set.as_slice()]
                        .concat()
                        .join(" ");
                    off.push(format!("{scene}: {why}"));
                }
                Err(Miss::Ended(_, why)) => not.push(format!("{name}: {why}")),
                Err(error) => return Err(error),
            }
        }
        let what = &trial.what;
        let held = scenes.len() - off.len() - not.len();
        let mut message = format!("{held} of {} {what}", scenes.len());
        if self.shares_the_law() {
            message.push_str(&format!(" to {worst:.0e} with {truth}"));
        }
        if !not.is_empty() {
            message.push_str(&format!("; not held: {}", not.join("; ")));
        }
        match off.as_slice() {
            [] if held == 0 => skipped(not.join("; ")),
            [] => Ok(message),
            [only] => failed(only),
            [first, more @ ..] => failed(format!("{first} ({} more of {what})", more.len())),
        }
    }

    fn runs(&self, scene: &CheckedScene) -> Observation {
        let run = self.own(scene)?;
        let rows = run.time_series.len();
        Ok(format!("{rows} rows, {:.2} s CPU", run.stats.cpu_s))
    }

    fn repeats(&self, scene: &CheckedScene) -> Observation {
        let (run, again) = (self.own(scene)?, self.own(scene)?);
        if run.time_series != again.time_series {
            return failed(format!(
                "again {}",
                place(&again.time_series, &run.time_series)
            ));
        }
        let (steps, calls) = (run.stats.steps, run.stats.rhs_calls);
        let (duration_s, step_s) = (scene.solver.duration_s, scene.solver.step_s);
        let refinement = self.solver.info().refinement;
        let is_stepped = refinement.is_some_and(|refine| refine.knob == AccuracySetting::Step);
        let least = duration_s / step_s * (1.0 - 1e-6);
        if is_stepped && (1..least as u64).contains(&steps) {
            return failed(format!(
                "{steps} steps over {duration_s} s are longer than solver.step_s = {step_s} s"
            ));
        }
        let message = format!("the same bits, {calls} evaluations of the forces, {steps} steps");
        if self.shares_the_law() && calls < steps.max(1) {
            return failed(format!(
                "{message}: close the handle (pinwheel_law_close), or write right_hand_sides into result.json"
            ));
        }
        Ok(message)
    }

    /// Checks the start at rest under load by the balances of power and torque.
    fn start(&self, scene: &CheckedScene) -> Observation {
        let time_series = self.own(scene)?.time_series;
        let native = self.native(Native::REDUCED, scene)?;
        let first = |run: &TimeSeries| run.channel(columns::OUTPUT_ANGLE).map(|angle| angle[0]);
        let [angle, known] = [&time_series, &native].map(|run| first(run).unwrap_or(f64::NAN));
        if !((angle - known).abs() < 1e-12) {
            return failed(format!(
                "output_angle_rad is {angle:e} at t = 0, not {known:e}"
            ));
        }
        let rows = [&time_series, &native].map(|run| run.select(&[0]));
        if self.shares_the_law() && !(apart(&rows[0], &rows[1]) <= FIRST) {
            return failed(place(&rows[0], &rows[1]));
        }
        let values = |name: &str| time_series.channel(name).unwrap_or_default();
        let late = |name: &str| mean(&values(name)[time_series.len() / 2..]);
        let (driver, output) = (late(columns::INPUT_TORQUE), late(columns::OUTPUT_TORQUE));
        let last = values(columns::OUTPUT_ANGLE).last();
        let turned = last.map_or(f64::NAN, |last| last - angle);
        let (load, lobes) = (scene.drive.output_torque_n_m, scene.gear.lobes() as f64);
        let wanted = -scene.drive.input_speed_rad_s * scene.solver.duration_s / lobes;
        for (name, is, should) in [
            (columns::OUTPUT_TORQUE, output, -load),
            (columns::INPUT_TORQUE, driver, load / lobes),
            (columns::OUTPUT_ANGLE, turned, wanted),
        ] {
            if !((is / should - 1.0).abs() < 0.25) {
                return failed(format!(
                    "{name} is {is:.4}, but balance asks for about {should:.4}"
                ));
            }
        }
        Ok(format!(
            "torques {driver:.3} and {output:.2} N m, output turned by {turned:.4} rad"
        ))
    }

    fn accuracy(&self, scene: &CheckedScene) -> Observation {
        let (Some((knob, ratio, method)), Some(stated)) = (
            self.refinement(2.0, Rough::Kinks),
            self.solver.info().refinement,
        ) else {
            return skipped("its manifest has no [refine]");
        };
        // The examples show 2.71 (RK4), 2.01 (implicit midpoint) and 1.93 (Heun).
        let (finest, least) = match knob {
            AccuracySetting::Step => (5e-6, method.allowed_order() - ORDER_MARGIN),
            AccuracySetting::Tolerance => (1e-7, TOLERANCE_SHARE * stated.order),
        };
        let run = |coarser: i32| self.at(scene, knob, finest * ratio.powi(coarser));
        let (coarsest, middle, finest) = (run(2)?, run(1)?, run(0)?);
        let [fine, coarse] =
            [(&middle, &finest), (&coarsest, &middle)].map(|(coarse, fine)| Step {
                ratio,
                difference: apart(coarse, fine),
            });
        if fine.difference == 0.0 && coarse.difference == 0.0 {
            return failed(
                "three settings give the same bits: it does not read the key of [refine]",
            );
        }
        let observed = convergence::observed_order(fine, coarse).unwrap_or(f64::NAN);
        let order = format!(
            "order {observed:.2} of {}, differences {:.1e} and {:.1e}",
            stated.order, coarse.difference, fine.difference
        );
        // At rounding level no order can be measured.
        let falls = fine.difference < 1e-10 || observed >= least;
        if !self.shares_the_law() {
            return if falls { Ok(order) } else { failed(order) };
        }
        let truth = self.native(Native::RESOLVED, scene)?;
        let known = convergence::estimate(&[fine, coarse], None, method, 0.0);
        let own = known.map_or(f64::NAN, |known| known.u) + NATIVE;
        if !falls || !(apart(&finest, &truth) <= own) {
            return failed(format!("{}; {order}", place(&finest, &truth)));
        }
        Ok(format!("to {own:.1e} with native-resolved; {order}"))
    }

    fn bad_ends(&self, scene: &CheckedScene) -> Observation {
        let gearbox = compile(scene)?;
        let job = |_| "{\"protocol\": 1, \"sce".to_owned();
        let broken = self.solver.run_job(&gearbox, job, &self.control)?;
        let broken = match broken.ending {
            Ending::Failed { reason } | Ending::Unsupported { reason } => reason,
            Ending::Finished => return failed("broken job: it said that it finished"),
            ending => return failed(format!("broken job: it {ending}")),
        };
        let refinement = self.solver.info().refinement;
        if refinement.is_none_or(|refinement| refinement.knob != AccuracySetting::Step) {
            return Ok(format!("broken job: {broken}"));
        }
        match self.solver.run(scene, &self.control)?.ending {
            ending @ (Ending::Finished | Ending::Diverged { .. }) => {
                Ok(format!("long steps: it {ending}; broken job: {broken}"))
            }
            ending => failed(format!("long steps: it {ending}")),
        }
    }

    /// Stops an endless run by a request and by a time limit.
    fn stop(&self, scene: &CheckedScene) -> Observation {
        let gearbox = compile(scene)?;
        let (by_hand, begun) = (AtomicBool::new(false), Instant::now());
        let wait = |_: Progress<'_>| {
            let enough = begun.elapsed() > PATIENCE;
            by_hand.fetch_or(enough || self.control.is_cancelled(), Ordering::Relaxed);
        };
        let stopped = Control::new(&by_hand, &wait);
        let hasty = self.solver.clone().within(PATIENCE);
        let mut ends = Vec::new();
        for (by, solver, control) in [
            ("Ctrl-C", self.solver, &stopped),
            ("timeout", &hasty, &self.control),
        ] {
            let asked = Instant::now() + PATIENCE;
            let ended = solver.run_compiled(&gearbox, control);
            self.control.check()?;
            let late_s = asked.elapsed().as_secs_f64();
            match ended {
                Err(Cancelled) => {}
                Ok(run) if matches!(run.ending, Ending::TimedOut { .. }) => {}
                Ok(run) => return failed(run.ending),
            }
            if late_s > ENDS_S {
                return failed(format!("{by}: ended within {late_s:.1} s"));
            }
            ends.push(format!("{by}: ended within {late_s:.1} s"));
        }
        Ok(ends.join("; "))
    }
}

/// First words of the refusal of a scene ([`Ending::Unsupported`]).
const CANNOT: &str = "cannot run this scene";

/// Accepts a run that is at most `most` off; otherwise returns its largest difference as the failure.
fn right(off: f64, most: f64, run: &TimeSeries, truth: &TimeSeries) -> Result<f64, Miss> {
    if off <= most {
        Ok(off)
    } else {
        failed(place(run, truth))
    }
}

/// Returns the relative L2 distance of each quantity of `a` from `b` over all its columns, largest first. The output angle is
/// left out because it grows.
fn distances(a: &TimeSeries, b: &TimeSeries) -> Vec<(f64, Quantity)> {
    let mut errors = Vec::new();
    for quantity in derive([a, b]) {
        let names = &quantity.channels;
        let views = [a, b].map(|run| View::of(run, names, 0..a.len().min(b.len())));
        if let [Some(own), Some(other)] = views
            && *names != [columns::OUTPUT_ANGLE]
        {
            errors.push((relative_l2(&own, &other, 0.0), quantity));
        }
    }
    // NaN counts as the largest error.
    errors.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    errors
}

/// Returns the distance of the worst quantity.
fn apart(a: &TimeSeries, b: &TimeSeries) -> f64 {
    distances(a, b).first().map_or(f64::NAN, |(off, _)| *off)
}

/// Returns column and time of the largest difference in words, for the worst quantity, and for the pin forces if these are not
/// the worst.
fn place(a: &TimeSeries, b: &TimeSeries) -> String {
    let errors = distances(a, b);
    let of_pins = errors.iter().position(|(_, quantity)| quantity.is_force());
    let places = [Some(0), of_pins.filter(|&place| place > 0)];
    let places = places
        .into_iter()
        .flatten()
        .filter_map(|place| errors.get(place));
    let places: Vec<String> = places.map(|(_, of)| farthest(&of.channels, a, b)).collect();
    places.join(", ")
}

/// Returns the largest difference between these columns of `a` and `b`, in words.
fn farthest(names: &[String], a: &TimeSeries, b: &TimeSeries) -> String {
    let (mut peak, mut far, mut at) = (f64::MIN_POSITIVE, 0.0, (names[0].as_str(), 0.0));
    for name in names {
        let [own, other] = [a, b].map(|run| run.channel(name).unwrap_or_default());
        for ((&time_s, own), other) in b.time_s().iter().zip(own).zip(other) {
            peak = other.abs().max(peak);
            let difference = (own - other).abs();
            if difference > far {
                (far, at) = (difference, (name.as_str(), time_s));
            }
        }
    }
    off_at(at.0, far / peak, at.1)
}

/// Returns words such as `external_sleeve_force_n_3 is 12 % off at t = 0.0031 s`. The share is relative to the quantity's peak.
fn off_at(column: &str, share: f64, time_s: f64) -> String {
    let percent = 100.0 * share;
    // Two significant digits; no decimals from 10 % up.
    let decimals = (1.0 - percent.log10().floor()).clamp(0.0, 12.0) as usize;
    let time = match time_s {
        0.0 => "0".to_owned(),
        time_s => format!("{time_s:.3e} s"),
    };
    format!("{column} is {percent:.decimals$} % off at t = {time}")
}
