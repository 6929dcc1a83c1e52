//! Checks a solver from outside: everything that comparisons rely on, one trial after the other.
//!
//! Each [`Finding`] is a small run or two of the preset `paper`, or of a scene that the solver honours instead. A solver that
//! shares the law is held against the native one on every law and kind of contact it honours, column by column; a solver
//! with contacts of its own is asked for signs and sizes.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pinwheel_compare::quantities::{Quantity, derive};
use pinwheel_contact::laws;
use pinwheel_engines::external::Solver;
use pinwheel_engines::{AccuracySetting, Cancelled, Ending, Engine, Native, Run, SharedModel};
use pinwheel_gearbox::Frequencies;
use pinwheel_scene::{CheckedScene, LoadChange, Override, Scene, Start};
use pinwheel_timeseries::convergence::{self, KINKS, Method, ORDER_MARGIN, Rough, Step};
use pinwheel_timeseries::norms::{View, mean, relative_l2};
use pinwheel_timeseries::{TimeSeries, columns};
use quick_junit::TestSuite;
use serde::Serialize;

use crate::StudyError;
use crate::control::{Control, Progress, compile};
use crate::junit::{self, State};
use crate::output::OutputError;
use crate::provenance::{Provenance, Summary};

/// One trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Its name in tables: `load changes`.
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
        self.count(State::Failed) == 0
    }

    /// How many findings are in a state.
    #[must_use]
    pub fn count(&self, state: State) -> usize {
        self.findings.iter().filter(|f| f.state == state).count()
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
type Seen = Result<String, Miss>;

/// End of a trial that did not pass.
enum Miss {
    /// It failed or was skipped, with the observation.
    Ended(State, String),
    /// The check cannot go on.
    Study(StudyError),
}

impl<E: Into<StudyError>> From<E> for Miss {
    fn from(error: E) -> Self {
        Self::Study(error.into())
    }
}

fn failed<T>(seen: impl ToString) -> Result<T, Miss> {
    Err(Miss::Ended(State::Failed, seen.to_string()))
}

fn skipped<T>(seen: impl ToString) -> Result<T, Miss> {
    Err(Miss::Ended(State::Skipped, seen.to_string()))
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
/// A short run that is not [`RIGHT`], and whose own error may be why, is run at a quarter of the step until there are so many.
const LEVELS: i32 = 4;
/// How long a solver may need to end after it was asked to.
const ENDS_S: f64 = 3.0;
/// Time after which a solver is ended that is tried on a run without end.
const PATIENCE: Duration = Duration::from_millis(300);

struct Trials<'a> {
    solver: &'a Solver,
    /// Without progress.
    control: Control<'a>,
    scene: CheckedScene,
}

/// Name, requirement and runs of a trial.
type Trial = (&'static str, &'static str, fn(&Trials<'_>) -> Seen);

/// The trials in their order. The first must pass for the others to mean anything.
const TRIALS: &[Trial] = &[
    (
        "runs",
        "a run finishes, with all columns, at samples that no step hits",
        runs,
    ),
    (
        "repeats",
        "again the same bits, by steps no longer than asked for",
        repeats,
    ),
    (
        "start",
        "the first row holds the start state's forces, with the documented signs",
        start,
    ),
    (
        ACCURACY,
        "the error falls as [refine] states, down to the native run's",
        accuracy,
    ),
    (
        LAWS,
        "every law that it honours gives what the native solver gives",
        of_laws,
    ),
    (
        "contacts",
        "damping, discs that are cut, and play give what the native solver gives",
        contacts,
    ),
    (
        "friction",
        "friction gives what the native solver gives, driven either way",
        friction,
    ),
    (
        "load changes",
        "a load that jumps gives what the native solver gives",
        load_changes,
    ),
    (
        "bad ends",
        "steps far too long and a broken job end as they must",
        bad_ends,
    ),
    (
        "stop",
        "a run that is stopped, or takes too long, ends at once",
        stop,
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
        let seen = match findings.first() {
            Some(first) if first.state == State::Failed => skipped("it does not run"),
            _ => trial(&trials),
        };
        let (state, seen) = match seen {
            Ok(seen) => (State::Passed, seen),
            Err(Miss::Ended(state, seen)) => (state, seen),
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
    match with(State::Passed).find(|f| [ACCURACY, LAWS].contains(&f.name)) {
        Some(shown) => format!("agrees: {}", shown.seen),
        None => "nothing shown: no law of its own ran".to_owned(),
    }
}

impl Trials<'_> {
    fn changed(&self, change: impl FnOnce(&mut Scene)) -> Result<CheckedScene, Miss> {
        self.scene.changed(change).or_else(failed)
    }

    fn shares_the_law(&self) -> bool {
        self.solver.track() == SharedModel::SharedLaw
    }

    /// A run of the solver or the native one that must finish; a miss of that `state` otherwise.
    fn run(&self, engine: &dyn Engine, scene: &CheckedScene, state: State) -> Result<Run, Miss> {
        let ran = engine.run(scene, &self.control)?.whole();
        ran.map_err(|ending| Miss::Ended(state, format!("{} {ending}", engine.name())))
    }

    fn own(&self, scene: &CheckedScene) -> Result<Run, Miss> {
        self.run(self.solver, scene, State::Failed)
    }

    fn native(&self, engine: Native, scene: &CheckedScene) -> Result<TimeSeries, Miss> {
        Ok(self.run(&engine, scene, State::Skipped)?.time_series)
    }

    /// A run of the solver with another setting of the key of `[refine]`.
    fn at(&self, scene: &Scene, knob: AccuracySetting, setting: f64) -> Result<TimeSeries, Miss> {
        let mut scene = scene.clone();
        knob.set(&mut scene, setting);
        Ok(self.own(&scene.check().or_else(failed)?)?.time_series)
    }

    /// Key of `[refine]`, the factor between two of its settings, which is `by` for steps, and the error's order in it.
    fn refinement(&self, by: f64, rough: Rough) -> Option<(AccuracySetting, f64, Method)> {
        let refinement = self.solver.info().refinement?;
        let (order, rough) = (refinement.order, Some(rough));
        let (ratio, method) = match refinement.knob {
            AccuracySetting::Step => (by, Method::Step { order, rough }),
            AccuracySetting::Tolerance => (10.0, Method::Tolerance { order: KINKS }),
        };
        Some((refinement.knob, ratio, method))
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
        right(off, RIGHT, &fine, &truth)
    }

    /// Holds the solver against the native one on several scenes, which `what` counts. Where it `may_refuse` one, by status 4, that
    /// is no failure.
    fn all_held(&self, what: &str, may_refuse: bool, scenes: &[Case<'_>]) -> Seen {
        let (mut worst, mut off, mut not) = (NATIVE, Vec::new(), Vec::new());
        for (name, change) in scenes {
            match self.held(change) {
                Ok(near) => worst = worst.max(near),
                Err(Miss::Ended(State::Failed, why)) if !(may_refuse && why.contains(CANNOT)) => {
                    off.push(format!("{name}: {why}"));
                }
                Err(Miss::Ended(_, why)) => not.push(format!("{name}: {why}")),
                Err(error) => return Err(error),
            }
        }
        let held = scenes.len() - off.len() - not.len();
        let mut seen = format!("{held} of {} {what}", scenes.len());
        if self.shares_the_law() {
            seen.push_str(&format!(" to {worst:.0e} with native-resolved"));
        }
        if !not.is_empty() {
            seen.push_str(&format!("; not held: {}", not.join("; ")));
        }
        match off.as_slice() {
            [] if held == 0 => skipped(seen),
            [] => Ok(seen),
            [only] => failed(only),
            [first, more @ ..] => failed(format!("{first} ({} more of {what})", more.len())),
        }
    }
}

fn runs(trials: &Trials<'_>) -> Seen {
    let scene = trials.changed(|scene| scene.solver.sample_s = 1.03e-4)?;
    let run = trials.own(&scene)?;
    let rows = run.time_series.len();
    Ok(format!("{rows} rows, {:.2} s CPU", run.stats.cpu_s))
}

fn repeats(trials: &Trials<'_>) -> Seen {
    let (run, again) = (trials.own(&trials.scene)?, trials.own(&trials.scene)?);
    if run.time_series != again.time_series {
        return failed(format!(
            "again {}",
            place(&again.time_series, &run.time_series)
        ));
    }
    let (steps, calls) = (run.stats.steps, run.stats.rhs_calls);
    let (duration_s, step_s) = (trials.scene.solver.duration_s, trials.scene.solver.step_s);
    let refinement = trials.solver.info().refinement;
    let is_stepped = refinement.is_some_and(|refine| refine.knob == AccuracySetting::Step);
    let least = duration_s / step_s * (1.0 - 1e-6);
    if is_stepped && (1..least as u64).contains(&steps) {
        return failed(format!(
            "{steps} steps over {duration_s} s are longer than solver.step_s = {step_s} s"
        ));
    }
    let seen = format!("the same bits, {calls} evaluations of the forces, {steps} steps");
    if trials.shares_the_law() && calls < steps.max(1) {
        return failed(format!(
            "{seen}: close the handle (pinwheel_law_close), or write right_hand_sides into result.json"
        ));
    }
    Ok(seen)
}

/// At rest under load, the balances of power and torque say what must come.
fn start(trials: &Trials<'_>) -> Seen {
    let scene = trials.changed(|scene| scene.drive.start = Start::Equilibrium)?;
    let time_series = trials.own(&scene)?.time_series;
    let native = trials.native(Native::REDUCED, &scene)?;
    let first = |run: &TimeSeries| run.channel(columns::OUTPUT_ANGLE).map(|angle| angle[0]);
    let [angle, known] = [&time_series, &native].map(|run| first(run).unwrap_or(f64::NAN));
    if !((angle - known).abs() < 1e-12) {
        return failed(format!(
            "output_angle_rad is {angle:e} at t = 0, not {known:e}"
        ));
    }
    let rows = [&time_series, &native].map(|run| run.select(&[0]));
    if trials.shares_the_law() && !(apart(&rows[0], &rows[1]) <= FIRST) {
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

fn accuracy(trials: &Trials<'_>) -> Seen {
    let (Some((knob, ratio, method)), Some(stated)) = (
        trials.refinement(2.0, Rough::Kinks),
        trials.solver.info().refinement,
    ) else {
        return skipped("its manifest has no [refine]");
    };
    // The examples show 2.71 (RK4), 2.01 (implicit midpoint) and 1.93 (Heun).
    let (finest, least) = match knob {
        AccuracySetting::Step => (5e-6, method.allowed_order() - ORDER_MARGIN),
        AccuracySetting::Tolerance => (1e-7, TOLERANCE_SHARE * stated.order),
    };
    let run = |coarser: i32| trials.at(&trials.scene, knob, finest * ratio.powi(coarser));
    let (coarsest, middle, finest) = (run(2)?, run(1)?, run(0)?);
    let [fine, coarse] = [(&middle, &finest), (&coarsest, &middle)].map(|(coarse, fine)| Step {
        ratio,
        difference: apart(coarse, fine),
    });
    if fine.difference == 0.0 && coarse.difference == 0.0 {
        return failed("three settings give the same bits: it does not read the key of [refine]");
    }
    let seen = convergence::observed_order(fine, coarse).unwrap_or(f64::NAN);
    let order = format!(
        "order {seen:.2} of {}, differences {:.1e} and {:.1e}",
        stated.order, coarse.difference, fine.difference
    );
    // At rounding there is no order left to see.
    let falls = fine.difference < 1e-10 || seen >= least;
    if !trials.shares_the_law() {
        return if falls { Ok(order) } else { failed(order) };
    }
    let truth = trials.native(Native::RESOLVED, &trials.scene)?;
    let known = convergence::estimate(&[fine, coarse], None, method, 0.0);
    let own = known.map_or(f64::NAN, |known| known.u) + NATIVE;
    if !falls || !(apart(&finest, &truth) <= own) {
        return failed(format!("{}; {order}", place(&finest, &truth)));
    }
    Ok(format!("to {own:.1e} with native-resolved; {order}"))
}

/// A scene by its name, and what makes it.
type Case<'a> = (&'a str, &'a dyn Fn(&mut Scene));

fn of_laws(trials: &Trials<'_>) -> Seen {
    let honoured = laws::LAWS.iter().map(|law| law.name);
    let honoured = honoured.filter(|law| trials.solver.manifest().honours_law(law));
    let by = |law: &'static str| move |scene: &mut Scene| law.clone_into(&mut scene.contact.law);
    let changes: Vec<_> = honoured.map(|law| (law, by(law))).collect();
    let scenes = changes.iter().map(|(law, change)| (*law, change as _));
    trials.all_held("laws", false, &scenes.collect::<Vec<Case<'_>>>())
}

fn contacts(trials: &Trials<'_>) -> Seen {
    let scenes: &[Case<'_>] = &[
        ("damping", &|scene| scene.contact.damping_n_s_m *= 10.0),
        ("cut", &|scene| scene.gear.modification.equidistant_m = 2e-5),
        ("play", &|scene| scene.gear.backlash_m = 2e-5),
    ];
    trials.all_held("kinds", true, scenes)
}

fn friction(trials: &Trials<'_>) -> Seen {
    if !trials.solver.manifest().honours.friction {
        return skipped("refused before it starts: honours.friction is not set");
    }
    let driven = |sense: f64| {
        move |scene: &mut Scene| {
            // A ramp that explicit steps follow (hard-friction-wide).
            let contact = &mut scene.contact;
            (contact.friction_coefficient, contact.friction_ramp_m_s) = (0.1, 5e-3);
            scene.drive.input_speed_rad_s *= sense;
        }
    };
    let scenes: [Case<'_>; 2] = [("forwards", &driven(1.0)), ("backwards", &driven(-1.0))];
    trials.all_held("directions", false, &scenes)
}

fn load_changes(trials: &Trials<'_>) -> Seen {
    if !trials.solver.manifest().honours.load_changes {
        return skipped("refused before it starts: honours.load_changes is not set");
    }
    let jump = |scene: &mut Scene| {
        scene.drive.load_changes = vec![LoadChange {
            time_s: 0.37 * SHORT_RAD / Frequencies::of(scene).contact_rad_s,
            output_torque_n_m: 30.0,
            ramp_s: 0.0,
        }];
    };
    trials.all_held("jumps", false, &[("jump", &jump)])
}

fn bad_ends(trials: &Trials<'_>) -> Seen {
    let gearbox = compile(&trials.scene)?;
    let broken = trials.solver.run_broken_job(&gearbox, &trials.control)?;
    let broken = match broken.ending {
        Ending::Failed { reason } | Ending::Unsupported { reason } => reason,
        Ending::Finished => return failed("broken job: it said that it finished"),
        ending => return failed(format!("broken job: it {ending}")),
    };
    let refinement = trials.solver.info().refinement;
    if refinement.is_none_or(|refinement| refinement.knob != AccuracySetting::Step) {
        return Ok(format!("broken job: {broken}"));
    }
    let scene = trials.changed(|scene| {
        (scene.solver.step_s, scene.solver.sample_s) = (1e-3, 1e-3);
        scene.solver.duration_s = 0.1;
        // Ten times as stiff, so that any explicit step of a millisecond fails.
        scene.contact.stiffness_multiplier = 0.1;
    })?;
    match trials.solver.run(&scene, &trials.control)?.ending {
        ending @ (Ending::Finished | Ending::Diverged { .. }) => {
            Ok(format!("long steps: it {ending}; broken job: {broken}"))
        }
        ending => failed(format!("long steps: it {ending}")),
    }
}

/// Stops a run without end, a second at the shortest of steps, by hand and by a limit.
fn stop(trials: &Trials<'_>) -> Seen {
    let scene = trials.changed(|scene| {
        (scene.solver.step_s, scene.solver.tolerance) = (1e-9, 1e-13);
        (scene.solver.duration_s, scene.solver.sample_s) = (1.0, 1e-3);
    })?;
    let gearbox = compile(&scene)?;
    let (by_hand, begun) = (AtomicBool::new(false), Instant::now());
    let wait = |_: Progress<'_>| {
        let enough = begun.elapsed() > PATIENCE;
        by_hand.fetch_or(enough || trials.control.is_cancelled(), Ordering::Relaxed);
    };
    let stopped = Control::new(&by_hand, &wait);
    let hasty = trials.solver.clone().within(PATIENCE);
    let mut seen = Vec::new();
    for (by, solver, control) in [
        ("Ctrl-C", trials.solver, &stopped),
        ("timeout", &hasty, &trials.control),
    ] {
        let asked = Instant::now() + PATIENCE;
        let ended = solver.run_compiled(&gearbox, control);
        trials.control.check()?;
        let late_s = asked.elapsed().as_secs_f64();
        match ended {
            Err(Cancelled) => {}
            Ok(run) if matches!(run.ending, Ending::TimedOut { .. }) => {}
            Ok(run) => return failed(run.ending),
        }
        if late_s > ENDS_S {
            return failed(format!("{by}: ended within {late_s:.1} s"));
        }
        seen.push(format!("{by}: ended within {late_s:.1} s"));
    }
    Ok(seen.join("; "))
}

/// First words of the refusal of a scene ([`Ending::Unsupported`]).
const CANNOT: &str = "cannot run this scene";

/// Passes a run that is no more than `most` off, and names its largest difference otherwise.
fn right(off: f64, most: f64, run: &TimeSeries, truth: &TimeSeries) -> Result<f64, Miss> {
    if off <= most {
        Ok(off)
    } else {
        failed(place(run, truth))
    }
}

/// Relative L2 distance of each quantity of `a` from `b`, all its columns together, the largest first; the output's angle is left
/// out, as it grows.
fn distances(a: &TimeSeries, b: &TimeSeries) -> Vec<(f64, Quantity)> {
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
    found
}

/// Distance of the quantity that is farthest off.
fn apart(a: &TimeSeries, b: &TimeSeries) -> f64 {
    distances(a, b).first().map_or(f64::NAN, |(off, _)| *off)
}

/// Column and time of the largest difference, in words: of the quantity that is farthest off, and of the pins' where that is another.
fn place(a: &TimeSeries, b: &TimeSeries) -> String {
    let found = distances(a, b);
    let of_pins = found.iter().position(|(_, quantity)| quantity.is_force());
    let places = [Some(0), of_pins.filter(|&place| place > 0)];
    let places = places
        .into_iter()
        .flatten()
        .filter_map(|place| found.get(place));
    let places: Vec<String> = places.map(|(_, of)| farthest(&of.channels, a, b)).collect();
    places.join(", ")
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
