//! Checks a solver from outside: everything that comparisons rely on, one trial after the other.
//!
//! Each [`Finding`] is a small run or two of the preset `paper`, or of a scene that the solver honours instead. A solver that
//! shares the law is held against the native one on every law and kind of contact it honours, column by column; a solver
//! with contacts of its own is asked for signs and sizes.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pinwheel_compare::quantities::derive;
use pinwheel_contact::laws;
use pinwheel_engines::external::Solver;
use pinwheel_engines::{AccuracySetting, Cancelled, Ending, Engine, Native, Run, SharedModel};
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_scene::{CheckedScene, Override, Scene};
use pinwheel_timeseries::convergence::{self, KINKS, Method, ORDER_MARGIN, Rough, Step};
use pinwheel_timeseries::norms::{View, relative_l2};
use pinwheel_timeseries::{TimeSeries, columns};
use quick_junit::TestSuite;
use serde::Serialize;

use crate::StudyError;
use crate::control::{Control, Progress, compile};
use crate::junit::{self, Ended};
use crate::output::OutputError;
use crate::provenance::{Provenance, Summary};

/// Outcome of one trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum State {
    /// As it must be.
    Passed,
    /// Not as it must be.
    Failed,
    /// It does not apply, or there was nothing to try it on.
    Skipped,
}

/// One trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Its name in tables: `time grid`.
    pub name: &'static str,
    /// Requirement of the trial.
    pub must: &'static str,
    /// Outcome of the trial.
    #[serde(flatten)]
    pub state: State,
    /// Observation in the trial, with figures.
    pub seen: String,
}

/// All trials of one solver.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Its name.
    pub solver: String,
    /// Its version.
    pub version: String,
    /// Its track.
    pub track: SharedModel,
    /// One line on the solver: agrees, or differs and where.
    pub answer: String,
    /// One a trial, in their order.
    pub findings: Vec<Finding>,
}

impl Outcome {
    /// True if no trial failed.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.count(&State::Failed) == 0
    }

    /// How many findings are in a state.
    #[must_use]
    pub fn count(&self, state: &State) -> usize {
        self.findings.iter().filter(|f| f.state == *state).count()
    }

    /// Writes `summary.json` into the folder `dir`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, dir: &Path, made: &Provenance) -> Result<(), OutputError> {
        Summary::new(made, self).write(dir)
    }

    /// For CI systems.
    #[must_use]
    pub fn suite(&self) -> TestSuite {
        let case = |finding: &Finding| {
            let ended = match finding.state {
                State::Passed => Ended::Passed,
                State::Failed => Ended::Failed(finding.seen.clone()),
                State::Skipped => Ended::Skipped(finding.seen.clone()),
            };
            junit::case(format!("{}: {}", finding.name, finding.must), ended)
        };
        let name = format!("solver check {}", self.solver);
        let answer = match self.passed() {
            true => Ended::Passed,
            false => Ended::Failed(self.answer.clone()),
        };
        let answer = junit::case(&self.answer, answer);
        junit::suite(
            &name,
            [answer].into_iter().chain(self.findings.iter().map(case)),
        )
    }
}

/// Result of a trial: passed, failed or skipped, with the observation.
type Seen = Result<String, Miss>;

enum Miss {
    Failed(String),
    Skipped(String),
    Study(StudyError),
}

impl<E: Into<StudyError>> From<E> for Miss {
    fn from(error: E) -> Self {
        Self::Study(error.into())
    }
}

fn failed<T>(seen: impl Into<String>) -> Result<T, Miss> {
    Err(Miss::Failed(seen.into()))
}

fn skipped<T>(seen: impl Into<String>) -> Result<T, Miss> {
    Err(Miss::Skipped(seen.into()))
}

fn judged(passed: bool, seen: String) -> Seen {
    if passed { Ok(seen) } else { failed(seen) }
}

/// A solver that shares the law may differ from the native one by this in its first sample, relative: rounding.
const FIRST: f64 = 1e-8;
/// A tolerance bounds the error of a step and not of a run, and steps change by leaps: of the order stated for it, this share
/// must be seen.
const TOLERANCE_SHARE: f64 = 0.3;
/// Bound of the native run's own error.
const NATIVE: f64 = 1e-6;
/// Length of a run that is held against numbers, radians of the contacts' vibration: two and a half of its periods.
const SHORT_RAD: f64 = 16.0;
/// Step of such a run, in the same radians: Heun's error is then a thousandth.
const STEP_RAD: f64 = 0.02;
/// A short run that is this near to the native one, relative L2 of a quantity, is right. Heun's method comes within 8e-5; of the faults
/// tried the smallest (damping without its ramp) makes 2e-3.
const RIGHT: f64 = 5e-4;
/// As [`RIGHT`] where no `[refine]` says how to see the solver's own error.
const UNREFINED: f64 = 2e-2;
/// A short run that is not [`RIGHT`], and whose own error may be why, is run at a quarter of the step so many times.
const LEVELS: i32 = 4;
/// How long a solver may need to end after it was asked to.
const ENDS_S: f64 = 3.0;
/// Time after which a solver is ended that is tried on a run without end, s.
const PATIENCE_S: f64 = 0.6;

struct Trials<'a> {
    solver: &'a Solver,
    /// Without progress.
    control: Control<'a>,
    scene: CheckedScene,
}

type Trial = (&'static str, &'static str, fn(&Trials<'_>) -> Seen);

/// The trials in their order. The first must pass for the others to mean anything.
const TRIALS: &[Trial] = &[
    ("runs", "a run of 0.02 s finishes, with all columns", |t| {
        t.runs()
    }),
    (
        "repeats",
        "again the same bits, by steps no longer than asked for, with an evaluation of the forces for each",
        |t| t.repeats(),
    ),
    (
        "start",
        "the first row is the start state's; torques and angle have the documented signs",
        |t| t.start(),
    ),
    (
        "time grid",
        "rows at samples that no step hits, the last interval shorter",
        |t| t.grid(),
    ),
    (
        ACCURACY,
        "the error falls with the key of [refine] as stated, down to what the native solver gives",
        |t| t.accuracy(),
    ),
    (
        LAWS,
        "every contact law it honours gives what the native solver gives",
        |t| t.laws(),
    ),
    (
        "contacts",
        "damping, discs that are cut, and play give what the native solver gives",
        |t| t.contacts(),
    ),
    (
        "friction",
        "friction gives what the native solver gives, driven either way",
        |t| t.friction(),
    ),
    (
        "load changes",
        "a load that jumps gives what the native solver gives",
        |t| t.load_changes(),
    ),
    (
        "bad ends",
        "steps far too long end in status 3 or in good numbers, a broken job in a status other than 0",
        |t| t.bad_ends(),
    ),
    (
        "stop",
        "a run that is stopped (Ctrl-C), or takes too long, ends at once",
        |t| t.stop(),
    ),
];
/// Name of the trial on the paper's gear.
const ACCURACY: &str = "accuracy";
/// Name of the trial of every law.
const LAWS: &str = "laws";

/// Tries a solver.
///
/// # Errors
/// Stopped; a scene of the suite that cannot be modelled.
pub fn check(solver: &Solver, control: &Control<'_>) -> Result<Outcome, StudyError> {
    let mut laws = laws::LAWS.iter().map(|law| law.name);
    let law = laws.find(|law| solver.manifest().honours_law(law));
    let sets = [
        Override::new("contact.law", law.unwrap_or("paper")),
        Override::new("solver.duration_s", "0.02"),
    ];
    let solver = &solver.clone().with_spaces();
    let trials = Trials {
        solver,
        control: Control::silent(control.cancel),
        scene: Scene::load("paper", &sets)?,
    };
    let mut findings: Vec<Finding> = Vec::new();
    for (done, (name, must, trial)) in TRIALS.iter().enumerate() {
        control.check()?;
        (control.progress)(Progress::new(done, TRIALS.len(), name));
        let dead = findings
            .first()
            .is_some_and(|first| first.state == State::Failed);
        let seen = if dead {
            skipped("it does not run")
        } else {
            trial(&trials)
        };
        let (state, seen) = match seen {
            Ok(seen) => (State::Passed, seen),
            Err(Miss::Failed(seen)) => (State::Failed, seen),
            Err(Miss::Skipped(seen)) => (State::Skipped, seen),
            Err(Miss::Study(error)) => return Err(error),
        };
        findings.push(Finding {
            name,
            must,
            state,
            seen,
        });
    }
    let track = solver.track();
    Ok(Outcome {
        answer: format!("{}: {}", solver.name(), answer(&findings, track)),
        solver: solver.name().to_owned(),
        version: solver.version(),
        track,
        findings,
    })
}

/// Says in a line what the findings come to.
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
    let shown = with(State::Passed).find(|f| [ACCURACY, LAWS].contains(&f.name));
    shown.map_or_else(
        || "nothing shown: no law of its own ran".to_owned(),
        |shown| format!("agrees: {}", shown.seen),
    )
}

impl Trials<'_> {
    fn changed(&self, change: impl FnOnce(&mut Scene)) -> Result<CheckedScene, Miss> {
        let changed = self.scene.changed(change);
        changed.map_err(|fault| Miss::Failed(fault.to_string()))
    }

    fn shares_the_law(&self) -> bool {
        self.solver.track() == SharedModel::SharedLaw
    }

    /// A run that must finish.
    fn run(&self, scene: &CheckedScene) -> Result<Run, Miss> {
        let ran = self.try_run(scene)?.whole();
        ran.map_err(|ending| Miss::Failed(format!("{} {ending}", self.solver.name())))
    }

    fn try_run(&self, scene: &CheckedScene) -> Result<Run, Miss> {
        Ok(self.solver.run(scene, &self.control)?)
    }

    fn native(&self, engine: Native, scene: &CheckedScene) -> Result<TimeSeries, Miss> {
        match engine.run(scene, &self.control)?.whole() {
            Ok(run) => Ok(run.time_series),
            Err(ending) => skipped(format!("{} {ending}", engine.name())),
        }
    }

    fn runs(&self) -> Seen {
        let run = self.run(&self.scene)?;
        let rows = run.time_series.len();
        Ok(format!("{rows} rows, {:.2} s CPU", run.stats.cpu_s))
    }

    fn repeats(&self) -> Seen {
        let (run, again) = (self.run(&self.scene)?, self.run(&self.scene)?);
        if run.time_series != again.time_series {
            let apart = Apart::of(&again.time_series, &run.time_series);
            return failed(format!("again {}", apart.place));
        }
        let (steps, calls) = (run.stats.steps, run.stats.rhs_calls);
        let solver = &self.scene.solver;
        let refinement = self.solver.info().refinement;
        let least = solver.duration_s / solver.step_s * (1.0 - 1e-6);
        if refinement.is_some_and(|refine| refine.knob == AccuracySetting::Step)
            && (1..least as u64).contains(&steps)
        {
            return failed(format!(
                "{steps} steps over {} s are longer than solver.step_s = {} s",
                solver.duration_s, solver.step_s
            ));
        }
        let seen = format!("the same bits, {calls} evaluations of the forces, {steps} steps");
        if self.shares_the_law() && calls < steps.max(1) {
            return failed(format!(
                "{seen}: close the handle (pinwheel_law_close), or write right_hand_sides into result.json"
            ));
        }
        Ok(seen)
    }

    fn start(&self) -> Seen {
        let short = self.changed(|scene| scene.solver.duration_s = scene.solver.sample_s)?;
        let time_series = self.run(&short)?.time_series;
        let angle = time_series.channel(columns::OUTPUT_ANGLE);
        let first = angle.map_or(f64::NAN, |angle| angle[0]);
        if !(first.abs() < 1e-12) {
            return failed(format!("output_angle_rad is {first:e} at t = 0, not 0"));
        }
        if self.shares_the_law() {
            let native = self.native(Native::REDUCED, &self.scene)?;
            let off = native.channels().iter().map(|channel| {
                let largest = channel.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                let own = time_series.channel(&channel.name);
                let own = own.map_or(f64::NAN, |own| own[0]);
                let off = (own - channel.values[0]).abs() / largest.max(f64::MIN_POSITIVE);
                (off, channel.name.as_str())
            });
            let (off, name) = off
                .max_by(|(a, _), (b, _)| a.total_cmp(b))
                .unwrap_or_default();
            if !(off <= FIRST) {
                return failed(off_at(name, off, 0.0));
            }
        }
        self.signs()
    }

    /// At rest under load, the balances of power and torque say what must come.
    fn signs(&self) -> Seen {
        let scene = self.changed(|scene| scene.drive.start = pinwheel_scene::Start::Equilibrium)?;
        let time_series = self.run(&scene)?.time_series;
        let half = time_series.len() / 2;
        let mean = |name: &str| {
            let values = &time_series.channel(name).unwrap_or_default()[half..];
            values.iter().sum::<f64>() / values.len().max(1) as f64
        };
        let load = scene.drive.output_torque_n_m;
        let (driver, output) = (mean(columns::INPUT_TORQUE), mean(columns::OUTPUT_TORQUE));
        let ideal = load / scene.gear.lobes() as f64;
        let angle = time_series
            .channel(columns::OUTPUT_ANGLE)
            .unwrap_or_default();
        let turned = angle.last().copied().unwrap_or(f64::NAN);
        let wanted =
            -scene.drive.input_speed_rad_s * scene.solver.duration_s / scene.gear.lobes() as f64;
        for (name, is, should) in [
            (columns::OUTPUT_TORQUE, output, -load),
            (columns::INPUT_TORQUE, driver, ideal),
            (columns::OUTPUT_ANGLE, turned, wanted),
        ] {
            if !((is / should - 1.0).abs() < 0.25) {
                return failed(format!(
                    "{name} is {is:.4}, but balance asks for about {should:.4}"
                ));
            }
        }
        Ok(format!(
            "torques {driver:.3} and {output:.2} N m, output at {turned:.4} rad"
        ))
    }

    fn grid(&self) -> Seen {
        let scene = self.changed(|scene| {
            (scene.solver.sample_s, scene.solver.duration_s) = (1.03e-4, 0.01);
        })?;
        let run = self.run(&scene)?;
        Ok(format!(
            "{} rows, the last at {} s",
            run.time_series.len(),
            scene.solver.duration_s
        ))
    }

    fn accuracy(&self) -> Seen {
        let Some(refinement) = self.solver.info().refinement else {
            return skipped("its manifest has no [refine]");
        };
        let (knob, stated) = (refinement.knob, refinement.order);
        let (finest, ratio, method): (f64, f64, _) = match knob {
            AccuracySetting::Step => {
                let (order, rough) = (stated, Some(Rough::Kinks));
                (5e-6, 2.0, Method::Step { order, rough })
            }
            AccuracySetting::Tolerance => (1e-7, 10.0, Method::Tolerance { order: KINKS }),
        };
        let run = |coarser: i32| {
            let setting = finest * ratio.powi(coarser);
            let run = self.run(&self.changed(|scene| knob.set(scene, setting))?)?;
            Ok::<_, Miss>(run.time_series)
        };
        let (coarsest, middle, finest) = (run(2)?, run(1)?, run(0)?);
        let step = |coarse: &TimeSeries, fine: &TimeSeries| Step {
            ratio,
            difference: Apart::of(coarse, fine).off,
        };
        let [fine, coarse] = [step(&middle, &finest), step(&coarsest, &middle)];
        if fine.difference == 0.0 && coarse.difference == 0.0 {
            return failed(
                "three settings give the same bits: it does not read the key of [refine]",
            );
        }
        let seen = convergence::observed_order(fine, coarse).unwrap_or(f64::NAN);
        // The examples show 2.71 (RK4), 2.01 (implicit midpoint) and 1.93 (Heun).
        let least = match method {
            Method::Step { .. } => method.allowed_order() - ORDER_MARGIN,
            Method::Tolerance { .. } => TOLERANCE_SHARE * stated,
        };
        let order = format!(
            "order {seen:.2} of {stated}, differences {:.1e} and {:.1e}",
            coarse.difference, fine.difference
        );
        // At rounding there is no order left to see.
        let falls = fine.difference < 1e-10 || seen >= least;
        if !self.shares_the_law() {
            return judged(falls, order);
        }
        let apart = Apart::of(&finest, &self.native(Native::RESOLVED, &self.scene)?);
        let known = convergence::estimate(&[fine, coarse], None, method, 0.0);
        let own = known.map_or(f64::NAN, |known| known.u);
        if !falls || !(apart.off <= own + NATIVE) {
            return failed(format!("{}; {order}", apart.place));
        }
        Ok(format!(
            "to {:.1e} with native-resolved; {order}",
            own + NATIVE
        ))
    }

    /// Holds the solver against the native one on a short scene, as long as its vibration asks for; the relative L2 of the
    /// quantity that is farthest off. What the solver's own step explains is made smaller until it is [`RIGHT`].
    fn held(&self, change: &dyn Fn(&mut Scene)) -> Result<f64, Miss> {
        let scene = self.changed(|scene| {
            change(scene);
            let rad_s = Frequencies::of(scene).contact_rad_s;
            let solver = &mut scene.solver;
            (solver.duration_s, solver.sample_s) = (SHORT_RAD / rad_s, 0.01 * SHORT_RAD / rad_s);
            (solver.step_s, solver.tolerance) = (STEP_RAD / rad_s, 1e-7);
        })?;
        let (mut fine, refinement) = (self.run(&scene)?.time_series, self.solver.info().refinement);
        if !self.shares_the_law() {
            return Ok(0.0);
        }
        let truth = self.native(Native::RESOLVED, &scene)?;
        let mut apart = Apart::of(&fine, &truth);
        let Some(refinement) = refinement else {
            return if apart.off <= UNREFINED {
                Ok(apart.off)
            } else {
                failed(apart.place)
            };
        };
        let knob = refinement.knob;
        let (ratio, method): (f64, _) = match knob {
            AccuracySetting::Step => (
                4.0,
                Method::Step {
                    order: refinement.order,
                    rough: Some(Rough::Jumps),
                },
            ),
            AccuracySetting::Tolerance => (10.0, Method::Tolerance { order: KINKS }),
        };
        for level in 1..LEVELS {
            if apart.off <= RIGHT {
                return Ok(apart.off);
            }
            let setting = knob.get(&scene) / ratio.powi(level);
            let finer = scene.changed(|scene| knob.set(scene, setting));
            let finer = finer.map_err(|fault| Miss::Failed(fault.to_string()))?;
            let coarse = std::mem::replace(&mut fine, self.run(&finer)?.time_series);
            apart = Apart::of(&fine, &truth);
            let difference = Apart::of(&coarse, &fine).off;
            let own = convergence::estimate(&[Step { ratio, difference }], None, method, 0.0);
            if apart.off > RIGHT && !own.is_ok_and(|own| apart.off <= own.u) {
                break;
            }
        }
        if apart.off <= RIGHT {
            Ok(apart.off)
        } else {
            failed(apart.place)
        }
    }

    /// Holds the solver against the native one on several scenes, which `what` counts. Where it `may_refuse` one, by status 4, that
    /// is no failure.
    fn all_held(&self, what: &str, may_refuse: bool, scenes: &[Case<'_>]) -> Seen {
        let (mut worst, mut off, mut not) = (0.0_f64, Vec::new(), Vec::new());
        for (name, change) in scenes {
            match self.held(change) {
                Ok(near) => worst = worst.max(near),
                Err(Miss::Failed(why)) if !(may_refuse && why.contains(CANNOT)) => {
                    off.push(format!("{name}: {why}"));
                }
                Err(Miss::Failed(why) | Miss::Skipped(why)) => not.push(format!("{name}: {why}")),
                Err(Miss::Study(error)) => return Err(error.into()),
            }
        }
        let held = scenes.len() - off.len() - not.len();
        let mut seen = format!("{held} of {} {what}", scenes.len());
        if self.shares_the_law() {
            seen.push_str(&format!(
                " to {:.0e} with native-resolved",
                worst.max(NATIVE)
            ));
        }
        if !not.is_empty() {
            seen.push_str(&format!("; not held: {}", not.join("; ")));
        }
        match off.len() {
            0 if held == 0 => skipped(seen),
            0 => Ok(seen),
            1 => failed(off.remove(0)),
            more => failed(format!("{} ({} more of {what})", off.remove(0), more - 1)),
        }
    }

    fn laws(&self) -> Seen {
        let honoured = laws::LAWS.iter().map(|law| law.name);
        let honoured = honoured.filter(|law| self.solver.manifest().honours_law(law));
        let change =
            |law: &'static str| move |scene: &mut Scene| law.clone_into(&mut scene.contact.law);
        let changes: Vec<_> = honoured.map(|law| (law, change(law))).collect();
        let scenes: Vec<Case<'_>> = changes
            .iter()
            .map(|(law, change)| (*law, change as _))
            .collect();
        self.all_held("laws", false, &scenes)
    }

    fn contacts(&self) -> Seen {
        let damped = |scene: &mut Scene| scene.contact.damping_n_s_m *= 10.0;
        let cut = |scene: &mut Scene| scene.gear.modification.equidistant_m = 2e-5;
        let play = |scene: &mut Scene| scene.gear.backlash_m = 2e-5;
        self.all_held(
            "kinds",
            true,
            &[("damping", &damped), ("cut", &cut), ("play", &play)],
        )
    }

    fn friction(&self) -> Seen {
        if !self.solver.manifest().honours.friction {
            return skipped("refused before it starts: honours.friction is not set");
        }
        let forwards = |scene: &mut Scene| {
            // A ramp that explicit steps follow (hard-friction-wide).
            (
                scene.contact.friction_coefficient,
                scene.contact.friction_ramp_m_s,
            ) = (0.1, 5e-3);
        };
        let backwards = |scene: &mut Scene| {
            forwards(scene);
            scene.drive.input_speed_rad_s *= -1.0;
        };
        self.all_held(
            "directions",
            false,
            &[("forwards", &forwards), ("backwards", &backwards)],
        )
    }

    fn load_changes(&self) -> Seen {
        if !self.solver.manifest().honours.load_changes {
            return skipped("refused before it starts: honours.load_changes is not set");
        }
        let jump = |scene: &mut Scene| {
            scene.drive.load_changes = vec![pinwheel_scene::LoadChange {
                time_s: 0.37 * SHORT_RAD / Frequencies::of(scene).contact_rad_s,
                output_torque_n_m: 30.0,
                ramp_s: 0.0,
            }];
        };
        self.all_held("jumps", false, &[("jump", &jump)])
    }

    fn bad_ends(&self) -> Seen {
        let gearbox = compile(&self.scene)?;
        let broken = match self.solver.run_broken_job(&gearbox, &self.control)?.ending {
            Ending::Failed { reason } | Ending::Unsupported { reason } => reason,
            Ending::Finished => return failed("broken job: it said that it finished"),
            ending => return failed(format!("broken job: it {ending}")),
        };
        let refinement = self.solver.info().refinement;
        if refinement.is_none_or(|refinement| refinement.knob != AccuracySetting::Step) {
            return Ok(format!("broken job: {broken}"));
        }
        let scene = self.changed(|scene| {
            (scene.solver.step_s, scene.solver.sample_s) = (1e-3, 1e-3);
            scene.solver.duration_s = 0.1;
            // Ten times as stiff, so that any explicit step of a millisecond fails.
            scene.contact.stiffness_multiplier = 0.1;
        })?;
        match self.try_run(&scene)?.ending {
            ending @ (Ending::Finished | Ending::Diverged { .. }) => {
                Ok(format!("long steps: it {ending}; broken job: {broken}"))
            }
            ending => failed(format!("long steps: it {ending}")),
        }
    }

    /// A run without end: a year at the shortest of steps.
    fn endless(&self) -> Result<Gearbox, Miss> {
        let scene = self.changed(|scene| {
            (scene.solver.step_s, scene.solver.tolerance) = (1e-9, 1e-13);
            (scene.solver.duration_s, scene.solver.sample_s) = (1.0, 1e-3);
        })?;
        Ok(compile(&scene)?)
    }

    fn stop(&self) -> Seen {
        let gearbox = self.endless()?;
        let (stop, begun) = (AtomicBool::new(false), Instant::now());
        let wait = |_: Progress<'_>| {
            let enough = begun.elapsed().as_secs_f64() > 0.5 * PATIENCE_S;
            if enough || self.control.is_cancelled() {
                stop.store(true, Ordering::Relaxed);
            }
        };
        let control = Control::new(&stop, &wait);
        let ended = self.solver.run_compiled(&gearbox, &control);
        self.control.check()?;
        let stopped = match ended {
            Ok(run) => return failed(run.ending.to_string()),
            Err(Cancelled) => in_time("Ctrl-C", begun, 0.5 * PATIENCE_S)?,
        };
        let patience = Duration::from_secs_f64(PATIENCE_S);
        let hasty = self.solver.clone().within(patience);
        let begun = Instant::now();
        match hasty.run_compiled(&gearbox, &self.control)?.ending {
            Ending::TimedOut { .. } => {
                let late = in_time("timeout", begun, PATIENCE_S)?;
                Ok(format!("{stopped}; {late}"))
            }
            ending => failed(ending.to_string()),
        }
    }
}

/// Returns how long after `asked_s` a run ended that was asked to end then, within reasonable time.
fn in_time(by: &str, begun: Instant, asked_s: f64) -> Seen {
    let took = begun.elapsed().as_secs_f64() - asked_s;
    judged(
        took <= ENDS_S,
        format!("{by}: ended within {:.1} s", took.max(0.0)),
    )
}

/// A scene by its name, and what makes it.
type Case<'a> = (&'a str, &'a dyn Fn(&mut Scene));

/// First words of the refusal of a scene ([`Ending::Unsupported`]).
const CANNOT: &str = "cannot run this scene";

/// Distance of a run from another.
struct Apart {
    /// Relative L2 of the quantity that is farthest off, all its columns together; the output's angle is left out, as it grows.
    off: f64,
    /// Column and time of that quantity's largest difference, in words; and of the pins', where it is another.
    place: String,
}

impl Apart {
    fn of(a: &TimeSeries, b: &TimeSeries) -> Self {
        let mut found = Vec::new();
        for quantity in derive([a, b]) {
            let names = &quantity.channels;
            let views = [a, b].map(|run| View::of(run, names, 0..a.len().min(b.len())));
            if let [Some(own), Some(other)] = views
                && *names != [columns::OUTPUT_ANGLE]
            {
                found.push((relative_l2(&own, &other, 0.0), quantity));
            }
        }
        // What is not a number is farther off than any.
        found.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let sleeves = found.iter().position(|(_, quantity)| quantity.is_force());
        let mut places = vec![0];
        places.extend(sleeves.filter(|&place| place > 0));
        let places = places.into_iter().filter_map(|place| found.get(place));
        let places: Vec<String> = places.map(|(_, of)| farthest(&of.channels, a, b)).collect();
        Self {
            off: found.first().map_or(f64::NAN, |(off, _)| *off),
            place: places.join(", "),
        }
    }
}

/// The largest difference of these columns of `a` from those of `b`, in words.
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

/// `external_sleeve_force_n_3 is 12 % off at t = 0.0031 s`: a share of the quantity's peak.
fn off_at(column: &str, share: f64, time_s: f64) -> String {
    let percent = 100.0 * share;
    // Two digits, whole where there are more.
    let decimals = (1.0 - percent.log10().floor()).clamp(0.0, 12.0) as usize;
    let time = match time_s {
        0.0 => "0".to_owned(),
        time_s => format!("{time_s:.3e} s"),
    };
    format!("{column} is {percent:.decimals$} % off at t = {time}")
}
