//! Whether a solver from outside is one that comparisons can rely on: what every engine must survive, tried one by one.
//!
//! Each [`Finding`] is a small run or two of the preset `paper`, or of what the solver honours instead. A solver that shares
//! the law is also held against the native one; a solver with contacts of its own is asked for signs and sizes.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pinwheel_compare::quantities::derive;
use pinwheel_contact::laws::LAWS;
use pinwheel_engines::external::Solver;
use pinwheel_engines::{Cancelled, Ending, Engine, Knob, Native, Run, Track};
use pinwheel_gearbox::Gearbox;
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

/// What came of one trial.
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
    /// What must be.
    pub must: &'static str,
    /// What came of it.
    #[serde(flatten)]
    pub state: State,
    /// What was seen, with figures.
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
    pub track: Track,
    /// One a trial, in their order.
    pub findings: Vec<Finding>,
}

impl Outcome {
    /// Whether nothing failed.
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
        junit::suite(&name, self.findings.iter().map(case))
    }
}

/// What a trial says: passed, failed or skipped, and what was seen.
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
/// What the native run may be off by itself.
const NATIVE: f64 = 1e-6;
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
    ("zero pose", "the first row is the start state's", |t| {
        t.zero_pose()
    }),
    (
        "signs",
        "torques, angle and forces have the documented signs",
        |t| t.signs(),
    ),
    (
        "time grid",
        "rows at samples that no step hits, the last interval shorter",
        |t| t.grid(),
    ),
    ("determinism", "two runs are equal to the last bit", |t| {
        t.determinism()
    }),
    (
        "order",
        "the error falls with the key of [refine] as stated",
        |t| t.order(),
    ),
    (
        "agreement",
        "refined, it gives what the native solver gives",
        |t| t.agreement(),
    ),
    (
        "forces",
        "contact forces are evaluated at least once a step",
        |t| t.forces(),
    ),
    ("laws", "every contact law it honours runs", |t| t.laws()),
    (
        "friction",
        "friction runs, or is refused before it starts",
        |t| t.friction(),
    ),
    (
        "load changes",
        "changes of the load run, or are refused",
        |t| t.load_changes(),
    ),
    (
        "divergence",
        "steps far too long end in status 3 or in good numbers",
        |t| t.divergence(),
    ),
    (
        "broken job",
        "a job that cannot be read ends in a status other than 0",
        |t| t.broken(),
    ),
    ("Ctrl-C", "a run that is stopped ends at once", |t| {
        t.stopped()
    }),
    ("timeout", "a run that takes too long is ended", |t| {
        t.timeout()
    }),
];

/// Tries a solver.
///
/// # Errors
/// Stopped; a scene of the suite that cannot be modelled.
pub fn check(solver: &Solver, control: &Control<'_>) -> Result<Outcome, StudyError> {
    let mut laws = LAWS.iter().map(|law| law.name);
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
    Ok(Outcome {
        solver: solver.name().to_owned(),
        version: solver.version(),
        track: solver.track(),
        findings,
    })
}

impl Trials<'_> {
    fn changed(&self, change: impl FnOnce(&mut Scene)) -> Result<CheckedScene, Miss> {
        let changed = self.scene.changed(change);
        changed.map_err(|fault| Miss::Failed(fault.to_string()))
    }

    fn shares_the_law(&self) -> Result<(), Miss> {
        match self.solver.track() {
            Track::SharedLaw => Ok(()),
            _ => skipped("its contact model is its own"),
        }
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

    fn zero_pose(&self) -> Seen {
        let time_series = self.run(&self.scene)?.time_series;
        let angle = time_series
            .channel(columns::OUTPUT_ANGLE)
            .unwrap_or_default();
        let first = angle.first().copied().unwrap_or(f64::NAN);
        if !(first.abs() < 1e-12) {
            return failed(format!("output_angle_rad is {first:e} at t = 0, not 0"));
        }
        if self.solver.track() != Track::SharedLaw {
            return Ok("the output angle is 0".to_owned());
        }
        let native = self.native(Native::REDUCED, &self.scene)?;
        let mut worst = (0.0, "");
        for channel in native.channels() {
            let (Some(own), Some(&wanted)) =
                (time_series.channel(&channel.name), channel.values.first())
            else {
                continue;
            };
            let largest = channel.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let off = (own[0] - wanted).abs() / largest.max(f64::MIN_POSITIVE);
            if off > worst.0 || off.is_nan() {
                worst = (off, &channel.name);
            }
        }
        let (off, name) = worst;
        if !(off <= FIRST) {
            return failed(format!(
                "{name} is {off:.1e} off at t = 0, relative to its peak"
            ));
        }
        Ok(format!("within {off:.0e} of the native solver"))
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

    fn determinism(&self) -> Seen {
        let (one, two) = (self.run(&self.scene)?, self.run(&self.scene)?);
        if one.time_series == two.time_series {
            return Ok("equal".to_owned());
        }
        let apart = distance(&one.time_series, &two.time_series);
        failed(format!("they differ by {apart:.1e}"))
    }

    /// The finest of three runs, and what parts them.
    fn refined(&self) -> Result<(Run, [Step; 2], Method), Miss> {
        let Some(refinement) = self.solver.info().refinement else {
            return skipped("its manifest has no [refine]");
        };
        let knob = refinement.knob;
        let (finest, ratio, method): (f64, f64, _) = match knob {
            Knob::Step => {
                let (order, rough) = (refinement.order, Some(Rough::Kinks));
                (5e-6, 2.0, Method::Step { order, rough })
            }
            Knob::Tolerance => (1e-7, 10.0, Method::Tolerance { order: KINKS }),
        };
        let run = |coarser: i32| {
            let setting = finest * ratio.powi(coarser);
            self.run(&self.changed(|scene| knob.set(scene, setting))?)
        };
        let (coarsest, middle, finest) = (run(2)?, run(1)?, run(0)?);
        let apart = |coarse: &Run, fine: &Run| Step {
            ratio,
            difference: distance(&coarse.time_series, &fine.time_series),
        };
        let steps = [apart(&middle, &finest), apart(&coarsest, &middle)];
        Ok((finest, steps, method))
    }

    fn order(&self) -> Seen {
        let (_, [fine, coarse], method) = self.refined()?;
        if fine.difference == 0.0 && coarse.difference == 0.0 {
            return failed(
                "three settings give the same bits: it does not read the key of [refine]",
            );
        }
        // Nothing left to see.
        if fine.difference < 1e-10 {
            return Ok(format!("at rounding already: {:.0e}", fine.difference));
        }
        let seen = convergence::observed_order(fine, coarse).unwrap_or(f64::NAN);
        // The examples show 2.71 (RK4), 2.01 (implicit midpoint) and 1.93 (Heun).
        let refinement = self.solver.info().refinement;
        let stated = refinement.map_or(0.0, |refinement| refinement.order);
        let least = match method {
            Method::Step { .. } => method.allowed_order() - ORDER_MARGIN,
            Method::Tolerance { .. } => TOLERANCE_SHARE * stated,
        };
        let told = format!(
            "order {seen:.2} of {stated}, differences {:.1e} and {:.1e}",
            coarse.difference, fine.difference
        );
        judged(seen >= least, told)
    }

    fn agreement(&self) -> Seen {
        self.shares_the_law()?;
        let (finest, steps, method) = self.refined()?;
        let truth = self.native(Native::RESOLVED, &self.scene)?;
        let off = distance(&finest.time_series, &truth);
        let known = convergence::estimate(&steps, None, method, 0.0);
        let own = known.map_err(|missing| Miss::Failed(missing.reason))?.u;
        let told = format!("{off:.1e} from native-resolved, its own runs leave {own:.1e}");
        judged(off <= own + NATIVE, told)
    }

    fn forces(&self) -> Seen {
        self.shares_the_law()?;
        let run = self.run(&self.scene)?;
        let (calls, steps) = (run.stats.rhs_calls, run.stats.steps);
        if calls == 0 {
            return failed(
                "no calls were counted: close the handle (pinwheel_law_close), or write right_hand_sides into result.json",
            );
        }
        let (least, of) = match steps {
            0 => (run.time_series.len() as u64, "samples"),
            _ => (steps, "steps"),
        };
        judged(calls >= least, format!("{calls} calls, {least} {of}"))
    }

    fn laws(&self) -> Seen {
        let (manifest, mut honoured) = (self.solver.manifest(), 0);
        for law in LAWS.iter().filter(|law| manifest.honours_law(law.name)) {
            let scene = self.changed(|scene| {
                law.name.clone_into(&mut scene.contact.law);
                scene.solver.duration_s = 0.001;
            })?;
            if let Err(ending) = self.try_run(&scene)?.ending.whole() {
                return failed(format!("{}: it {ending}", law.name));
            }
            honoured += 1;
        }
        Ok(format!("{honoured} of {}", LAWS.len()))
    }

    /// A scene that the manifest honours must run, and one that it does not must be refused.
    fn honoured(&self, scene: &CheckedScene, honours: bool, key: &str) -> Seen {
        match (self.try_run(scene)?.ending, honours) {
            (Ending::Finished, true) => Ok("runs".to_owned()),
            (Ending::Unsupported { .. }, false) => Ok(format!("refused: {key} is not set")),
            (ending, true) => failed(format!("{key} is set, but it {ending}")),
            (Ending::Finished, false) => failed(format!("it ran although {key} is not set")),
            (ending, false) => failed(ending.to_string()),
        }
    }

    fn friction(&self) -> Seen {
        let scene = self.changed(|scene| {
            scene.contact.friction_coefficient = 0.1;
            (scene.solver.step_s, scene.solver.duration_s) = (1e-6, 0.001);
        })?;
        let honours = &self.solver.manifest().honours;
        self.honoured(&scene, honours.friction, "honours.friction")
    }

    fn load_changes(&self) -> Seen {
        let scene = self.changed(|scene| {
            scene.drive.load_changes = vec![pinwheel_scene::LoadChange {
                time_s: 0.005,
                output_torque_n_m: 30.0,
                ramp_s: 0.0,
            }];
            scene.solver.duration_s = 0.01;
        })?;
        let honours = &self.solver.manifest().honours;
        self.honoured(&scene, honours.load_changes, "honours.load_changes")
    }

    fn divergence(&self) -> Seen {
        let refinement = self.solver.info().refinement;
        if refinement.is_none_or(|refinement| refinement.knob != Knob::Step) {
            return skipped("no step of the scene is its own");
        }
        let scene = self.changed(|scene| {
            (scene.solver.step_s, scene.solver.sample_s) = (1e-3, 1e-3);
            scene.solver.duration_s = 0.1;
            // Ten times as stiff, so that any explicit step of a millisecond fails.
            scene.contact.stiffness_multiplier = 0.1;
        })?;
        match self.try_run(&scene)?.ending {
            Ending::Diverged { time_s, quantity } => {
                Ok(format!("diverged at {time_s:.4} s: {quantity}"))
            }
            Ending::Finished => Ok("finished, and stayed in its mesh".to_owned()),
            ending => failed(ending.to_string()),
        }
    }

    fn broken(&self) -> Seen {
        let gearbox = compile(&self.scene)?;
        let run = self.solver.run_broken_job(&gearbox, &self.control)?;
        match run.ending {
            Ending::Failed { reason } | Ending::Unsupported { reason } => Ok(reason),
            Ending::Finished => failed("it said that it finished"),
            ending => failed(ending.to_string()),
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

    fn stopped(&self) -> Seen {
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
        match ended {
            Ok(run) => failed(run.ending.to_string()),
            Err(Cancelled) => in_time(begun, 0.5 * PATIENCE_S),
        }
    }

    fn timeout(&self) -> Seen {
        let gearbox = self.endless()?;
        let patience = Duration::from_secs_f64(PATIENCE_S);
        let hasty = self.solver.clone().within(patience);
        let begun = Instant::now();
        match hasty.run_compiled(&gearbox, &self.control)?.ending {
            Ending::TimedOut { .. } => in_time(begun, PATIENCE_S),
            ending => failed(ending.to_string()),
        }
    }
}

/// Whether a run that was asked to end after `asked_s` did, within reasonable time.
fn in_time(begun: Instant, asked_s: f64) -> Seen {
    let took = begun.elapsed().as_secs_f64() - asked_s;
    if took > ENDS_S {
        return failed(format!("it took {took:.1} s to end"));
    }
    Ok(format!("ended within {:.1} s", took.max(0.0)))
}

/// Relative L2 of every quantity but the output's angle, the largest of them.
fn distance(a: &TimeSeries, b: &TimeSeries) -> f64 {
    let quantities = derive([a, b]);
    let counted = quantities
        .iter()
        .filter(|quantity| quantity.channels != [columns::OUTPUT_ANGLE]);
    let apart = counted.filter_map(|quantity| {
        let whole = 0..a.len().min(b.len());
        let a = View::of(a, &quantity.channels, whole.clone())?;
        let b = View::of(b, &quantity.channels, whole)?;
        Some(relative_l2(&a, &b, 0.0))
    });
    let worse = |worst, share: f64| {
        if share.is_nan() {
            share
        } else {
            share.max(worst)
        }
    };
    apart.fold(0.0, worse)
}
