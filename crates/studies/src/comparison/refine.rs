//! Refinement study of every engine: its numerical uncertainty, refined while time allows.
//!
//! The finest run is shown and compared; two coarser ones (2 and 4 times the step, 10 and 100 times the tolerance; less for
//! RODAS5P) give its uncertainty. If a setting is free, i.e. not stated by the user, an engine with too large an uncertainty
//! gets a finer run: the previous finest run becomes a level, so each refinement costs one run. An engine that verified its own
//! run provides these levels, and runs once.

use std::cell::Cell;
use std::time::Duration;

use pinwheel_compare::uncertainty::{Basis, Final, Source, Unresolved};
use pinwheel_compare::{
    Context, Evidence, Ladder, Level, Participant, RESOLUTION, SharedModel, Status, Uncertainty,
    uncertainties,
};
use pinwheel_engines::{AccuracySetting, Engine, Form, Refinement};
use pinwheel_gearbox::auto::{self, Plan};
use pinwheel_gearbox::resolve::{by_step, by_tolerance};
use pinwheel_gearbox::{Gearbox, unfollowed};
use pinwheel_mbs::integrators::{Family, method};
use pinwheel_scene::{CheckedScene, Override, preset};

use super::{After, take_part};
use crate::StudyError;
use crate::control::{Control, Progress, WITHIN};

/// Effort for small uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// CPU time of one engine's runs after which it is not refined further.
    pub longest: Duration,
    /// True if step, tolerance and integrator of the scene are binding; otherwise refinement begins with them.
    pub obey: bool,
    /// Largest relative U of a pair that counts as resolved.
    pub resolution: f64,
}

impl Effort {
    /// Default: half a minute for each engine.
    pub const LONGEST: Duration = Duration::from_secs(30);

    /// Returns the effort for a scene: settings stated in its file are binding; those from formulas or a base are a start for
    /// refinement.
    pub fn of(scene: &CheckedScene) -> Self {
        let origins = scene.origins();
        Self {
            longest: Self::LONGEST,
            obey: origins.iter().all(|origin| origin.key != "solver.step_s"),
            resolution: RESOLUTION,
        }
    }

    /// Keys by which a user sets what otherwise follows from the scene.
    const KEYS: [&str; 3] = ["solver.step_s", "solver.tolerance", "solver.integrator"];

    /// Returns the effort like [`of`](Self::of) for the scene `spec` with the overrides `sets`: their settings are binding,
    /// those of a preset are a start.
    ///
    /// # Errors
    /// A time below 0, or a resolution outside of 0 to 1.
    pub fn asked(
        scene: &CheckedScene,
        spec: &str,
        sets: &[Override],
        longest_s: f64,
        resolution: f64,
    ) -> Result<Self, StudyError> {
        let longest = Duration::try_from_secs_f64(longest_s)
            .map_err(|_| StudyError::Input("longest: give seconds, 0 or more".to_owned()))?;
        if !(resolution > 0.0 && resolution <= 1.0) {
            return Err(StudyError::Input(
                "resolution: give a share above 0 and at most 1, e.g. 0.001".to_owned(),
            ));
        }
        let stated = sets.iter().any(|set| Self::KEYS.contains(&set.key()));
        Ok(Self {
            longest,
            obey: stated || preset(spec).is_none() && Self::of(scene).obey,
            resolution,
        })
    }
}

/// Time always permitted for one run, however small the limit.
const LEAST: Duration = Duration::from_millis(500);
/// Cost of a coarser run over that of the finest, about.
const COARSER: f64 = 0.5;
/// Share of the resolution for one engine's uncertainty, which leaves room for the other's.
const TARGET: f64 = 0.45;
/// Largest factor of one refinement.
const MOST: f64 = 8.0;
/// Cost ratio of a run at a tenth of the tolerance.
const DECADE: f64 = 1.8;
/// Least tolerance of a refinement.
const FINEST: f64 = 1e-13;

/// Engine with its accuracy setting.
pub struct Refiner<'a> {
    engine: &'a dyn Engine,
    /// The gearbox with a named method.
    gearbox: Gearbox,
    /// Setting that determines the engine's error, and the order of the error in it.
    by: Refinement,
    /// Step (s) or tolerance of the finest run.
    pub value: f64,
    /// Error common to all runs, which none of them reveals: a share of a quantity, or of quantity and tolerance.
    shared_error: f64,
}

/// Initial tolerance of RODAS5P in a comparison; ten times this is the loosest usable one.
const ROSENBROCK: f64 = 1e-6;

const EXPLICIT: &str = "its friction is its own or explicit, and takes steps of about 2e-7 s";

impl<'a> Refiner<'a> {
    /// Begins at the scene's own setting; `None` if no setting of the scene controls the engine.
    pub fn of(engine: &'a dyn Engine, gearbox: Gearbox) -> Option<Self> {
        let info = engine.info();
        let (by, shared_error) = match info.form {
            Some(Form::Resolved) => return None,
            Some(_) => {
                let method = method(&gearbox.scene.solver.integrator)?;
                let (knob, order) = (AccuracySetting::of(method.name), f64::from(method.order));
                (Refinement { knob, order }, method.shared_error)
            }
            None => (info.refinement?, info.shared_error),
        };
        Some(Self {
            engine,
            value: by.knob.get(&gearbox.scene),
            gearbox,
            by,
            shared_error: match by.knob {
                AccuracySetting::Step => info.floor,
                AccuracySetting::Tolerance => shared_error,
            },
        })
    }

    /// Returns the candidates for a scene, the best first: one, except for native engines with a free choice of method.
    fn candidates(engine: &'a dyn Engine, gearbox: &Gearbox) -> Vec<Self> {
        let automatic = gearbox.scene.solver.integrator == auto::AUTO;
        if !automatic || !matches!(engine.info().form, Some(Form::Reduced | Form::Lagrange)) {
            return Self::of(engine, gearbox.clone()).into_iter().collect();
        }
        let mut plans = auto::chain(&gearbox.scene, auto::TARGET);
        if let Some((_, others)) = plans.split_first_mut() {
            // If friction is too stiff for one method, explicit steps may finish, but chatter.
            others.sort_by_key(|plan| plan.family() == Some(Family::Explicit));
        }
        let way = |plan: &Plan| {
            let mut way = Self::of(engine, plan.applied(gearbox).ok()?)?;
            if plan.family() == Some(Family::Rosenbrock) {
                way.value = way.value.min(ROSENBROCK);
            }
            Some(way)
        };
        plans.iter().filter_map(way).collect()
    }

    /// Returns the factor by which its steps must be shorter than `value` to resolve explicit friction; `None` if they do.
    fn chatters(&self, value: f64) -> Option<f64> {
        let explicit = self.is_runge_kutta() || self.engine.info().explicit_friction;
        let shorter = unfollowed(&self.gearbox.scene, value);
        shorter.filter(|_| explicit && self.by.knob == AccuracySetting::Step)
    }

    /// Returns the final reason of a foreign engine with friction at a prescribed step, which must not be refined. Error
    /// control resolves the friction.
    fn obedient(&self) -> Option<Final> {
        let foreign = self.engine.info().form.is_none();
        let stepped = foreign && self.by.knob == AccuracySetting::Step;
        (stepped && self.gearbox.has_friction()).then(|| Final {
            group: "engines with explicit friction at a prescribed step",
            reason: EXPLICIT.to_owned(),
        })
    }

    /// Returns the family of the scene's method.
    fn family(&self) -> Option<Family> {
        method(&self.gearbox.scene.solver.integrator).map(|method| method.family)
    }

    /// True if the engine is a native form with steps of Dormand-Prince, which `etd-adams` uses without a Jacobian.
    fn is_runge_kutta(&self) -> bool {
        match self.engine.info().form {
            Some(Form::Lagrange) => {
                matches!(self.family(), Some(Family::Explicit | Family::Exponential))
            }
            form => form.is_some() && self.family() == Some(Family::Explicit),
        }
    }

    /// Returns the ladder below a finest run at this setting, without levels.
    fn ladder(&self, finest: f64) -> Ladder {
        let scene = &self.gearbox.scene;
        let (method, floor) = match self.by.knob {
            AccuracySetting::Step => (by_step(self.by.order, scene), self.shared_error),
            AccuracySetting::Tolerance => (
                by_tolerance(scene, self.is_runge_kutta()),
                self.shared_error * finest,
            ),
        };
        Ladder {
            method,
            finest,
            floor,
            coarser: Vec::new(),
        }
    }

    /// Limits the setting so that two coarser runs are possible.
    pub fn leave_room(&mut self) {
        if self.by.knob == AccuracySetting::Step {
            self.value = self.value.min(self.gearbox.scene.solver.sample_s / 4.0);
        }
    }

    /// Returns two coarser settings than `value`; fewer if a step would exceed the distance of samples.
    pub fn coarser(&self, value: f64) -> Vec<f64> {
        if self.by.knob == AccuracySetting::Tolerance {
            let factor = match self.family() {
                // Above 1e-5 its steps do not end on the friction's ramp.
                Some(Family::Rosenbrock) => 10_f64.sqrt(),
                _ => 10.0,
            };
            return vec![value * factor, value * factor * factor];
        }
        // Engines end a step at each sample, so a longer step would change nothing.
        let sample_s = self.gearbox.scene.solver.sample_s;
        let steps = sample_s / value;
        let is_integer = (steps - steps.round()).abs() < 1e-6;
        let longer = [2.0, 4.0].map(|times| match is_integer {
            // Samples stay at ends of steps.
            true => sample_s / (steps.round() / times).ceil(),
            false => times * value,
        });
        let mut values = longer.to_vec();
        values.retain(|longer| *longer > 1.001 * value && *longer < 1.001 * sample_s);
        values.dedup();
        values
    }

    /// Runs at one setting.
    fn run(
        &self,
        value: f64,
        most: Option<Duration>,
        after: &After<'_>,
        at: Progress<'_>,
        control: &Control<'_>,
    ) -> Result<Participant, StudyError> {
        let set = self.gearbox.with_solver(|solver| match self.by.knob {
            AccuracySetting::Step => solver.step_s = value.min(solver.duration_s),
            AccuracySetting::Tolerance => solver.tolerance = value.min(1e-2),
        });
        let gearbox = set.unwrap_or_else(|_| self.gearbox.clone());
        Ok(take_part(self.engine, &gearbox, most, after, at, control)?.0)
    }

    /// Returns the CPU time of the refinement study besides its coarsest run, s; that run had this setting and took `cpu_s`.
    fn rest(&self, coarsest: f64, cpu_s: f64) -> f64 {
        let finer = [self.value].into_iter().chain(self.coarser(self.value));
        finer
            .filter(|value| *value < coarsest)
            .map(|value| cpu_s * self.dearer(coarsest / value))
            .sum()
    }

    /// Returns the cost ratio of a run with a setting `factor` times finer.
    fn dearer(&self, factor: f64) -> f64 {
        match self.by.knob {
            AccuracySetting::Step => factor,
            AccuracySetting::Tolerance => DECADE.powf(factor.log10()),
        }
    }

    /// Returns the factor of the next refinement, in halves or decades up to `needed`, limited by the time `left` for a run
    /// that took `cpu_s`; and the time it takes, which may still exceed `left`.
    fn next(&self, needed: f64, cpu_s: f64, left: f64) -> (f64, f64) {
        let (least, most) = match self.by.knob {
            AccuracySetting::Step => (2.0_f64, MOST),
            AccuracySetting::Tolerance => (10.0, 100.0),
        };
        let steps = (needed.log10() / least.log10()).ceil();
        let mut factor = least.powf(steps).clamp(least, most);
        while cpu_s * self.dearer(factor) > left && factor > least {
            factor /= least;
        }
        (factor, cpu_s * self.dearer(factor))
    }
}

/// Converts a run to a level of a ladder.
fn level(setting: f64, ran: Participant) -> Level {
    Level {
        setting,
        wall_s: ran.cost.wall_s,
        run: match ran.status.reason() {
            None => Ok(ran.time_series),
            Some(reason) => Err(reason),
        },
    }
}

/// Returns the CPU time of a run and its children, s: unlike wall time it hardly depends on other load of the machine, so that
/// verdicts are reproducible.
fn cpu_s(run: &Participant) -> f64 {
    match run.cost.cpu_s {
        known if known > 0.0 => known,
        _ => run.cost.wall_s,
    }
}

/// Runs an engine at several levels.
pub fn refine(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    context: &Context,
    effort: Effort,
    at: Progress<'_>,
    control: &Control<'_>,
) -> Result<(Participant, Evidence), StudyError> {
    let name = engine.name();
    let mut candidates = Refiner::candidates(engine, gearbox).into_iter();
    // A user's binding setting always runs, and so does the native engine.
    let limited = !effort.obey && engine.track() != SharedModel::Native;
    let most = limited.then(|| effort.longest.max(LEAST).saturating_mul(WITHIN));
    let has_friction = gearbox.has_friction();
    let target = TARGET * effort.resolution;
    let Some(mut refiner) = candidates.next() else {
        let (ran, ladder) = take_part(engine, gearbox, most, &|_| 0.0, at, control)?;
        let evidence = match ladder {
            Some(ladder) => {
                let evidence = Evidence::refinement(name, ladder);
                let change = needed(context, &ran, &evidence, target);
                settled(evidence, has_friction, None, change)
            }
            None => unrefined(engine, &ran),
        };
        return Ok((ran, evidence));
    };
    let longest = effort.longest.as_secs_f64();
    let free = !effort.obey;
    if free {
        refiner.leave_room();
    }
    let spent = Cell::new(0.0);
    // `after` as in [`take_part`].
    let run = |refiner: &Refiner<'_>, value: f64, after: &After<'_>| {
        let ran = refiner.run(value, most, after, at, control)?;
        spent.set(spent.get() + cpu_s(&ran));
        Ok::<_, StudyError>(ran)
    };
    // A foreign engine runs its coarsest level first, to predict whether the others fit the time.
    let mut coarsest = None;
    if limited
        && free
        && let Some(&value) = refiner.coarser(refiner.value).last()
    {
        // The coarsest level becomes the finest one if the study does not fit.
        let after = |cpu_s: f64| match refiner.rest(value, cpu_s) {
            rest if cpu_s + rest <= longest => rest / cpu_s,
            _ => 1.0,
        };
        let ran = run(&refiner, value, &after)?;
        if ran.status.is_finished() && ran.cost.recorded.is_none() {
            coarsest = Some((value, ran));
        } else {
            spent.set(0.0);
        }
    }
    let whole_s =
        |(value, ran): &mut (f64, Participant)| spent.get() + refiner.rest(*value, cpu_s(ran));
    let (mut value, mut finest) = match coarsest.take_if(|ran| whole_s(ran) > longest) {
        // The coarsest level becomes the finest one of a study that fits.
        Some(coarsest) => coarsest,
        None => {
            let coarser = refiner.coarser(refiner.value).len();
            let after = COARSER * coarser.saturating_sub(coarsest.iter().len()) as f64;
            (refiner.value, run(&refiner, refiner.value, &|_| after)?)
        }
    };
    let diverged = |run: &Participant| matches!(run.status, Status::Diverged { .. });
    while diverged(&finest)
        && let Some(next) = candidates.next()
    {
        refiner = next;
        (value, finest) = (refiner.value, run(&refiner, refiner.value, &|_| 0.0)?);
    }
    // A derived setting may be too coarse to finish.
    for _ in 0..3 {
        if diverged(&finest) && free && spent.get() <= longest {
            value /= 4.0;
            finest = run(&refiner, value, &|_| 0.0)?;
        }
    }
    if !finest.status.is_finished() || finest.cost.recorded.is_some() {
        let evidence = unrefined(engine, &finest);
        return Ok((finest, evidence));
    }
    let mut ladder = refiner.ladder(value);
    for value in refiner.coarser(value) {
        let ran = match coarsest.take_if(|run| run.0 == value) {
            Some((_, ran)) => ran,
            None => run(&refiner, value, &|_| 0.0)?,
        };
        ladder.coarser.push(level(value, ran));
    }
    let mut is_final = refiner.obedient().filter(|_| effort.obey);
    loop {
        let value = ladder.finest;
        let evidence = match ladder.coarser.is_empty() {
            true => Evidence::unknown(
                name,
                "its step equals its sample interval, so no coarser run shows its error",
                "take a step of a quarter of solver.sample_s or less",
            ),
            false => Evidence::refinement(name, ladder.clone()),
        };
        let mut change = needed(context, &finest, &evidence, target);
        if let Some(shorter) = refiner.chatters(value) {
            change.factor = Some(change.factor.map_or(shorter, |factor| factor.max(shorter)));
            change.stuck = Some(blunt());
        }
        let Some(needed) = change.factor.filter(|_| free) else {
            return Ok((finest, settled(evidence, has_friction, is_final, change)));
        };
        let took = cpu_s(&finest);
        let (factor, next) = refiner.next(needed, took, longest - spent.get());
        let mut finer = None;
        if spent.get() + next <= longest && value / factor >= FINEST {
            let ran = run(&refiner, value / factor, &|_| 0.0)?;
            finer = ran.status.is_finished().then_some(ran);
        }
        let Some(finer) = finer else {
            // Foreign engines use the available time; the native engine must reach the target.
            if finest.track != SharedModel::Native {
                let enough = spent.get() + 1.2 * took * refiner.dearer(needed);
                is_final = Some(Final {
                    group: "engines refined as far as --longest allows",
                    reason: format!(
                        "refined as far as {longest} s of CPU allow; give it more: --longest {:.0}",
                        enough.max(spent.get() + next).ceil()
                    ),
                });
            }
            return Ok((finest, settled(evidence, has_friction, is_final, change)));
        };
        ladder.refine(value / factor, level(value, finest));
        ladder.floor = refiner.ladder(ladder.finest).floor;
        finest = finer;
    }
}

/// Returns the evidence of a run without coarser ones.
fn unrefined(engine: &dyn Engine, ran: &Participant) -> Evidence {
    let (name, info) = (engine.name(), engine.info());
    let unknown = |group: &'static str, reason: &str| {
        Evidence::unknown(name, reason, "compare it by its means")
            .finally(group, "refinement does not give its numerical uncertainty")
    };
    let is_fixed = info.form.is_none() && info.refinement.is_none();
    if ran.cost.recorded.is_some() {
        let reason = "a recording cannot be run again at other settings";
        let mut evidence = unknown("recordings", reason);
        if !ran.cost.recorded_uncertainty.is_empty() {
            evidence.source = Source::Recorded(ran.cost.recorded_uncertainty.clone());
        }
        evidence
    } else if is_fixed && info.brought {
        Evidence::unknown(
            name,
            "it does not say which setting refines it, so its numerical uncertainty is not known",
            "state `[refine]` in its manifest (of an engine in Python `order`)",
        )
    } else if is_fixed {
        let reason = "its step and its contacts are its own";
        unknown("engines with a step of their own", reason)
    } else if !ran.status.is_finished() {
        Evidence::unknown(name, "its run did not finish", "see its reason")
    } else {
        let notes = "see its notes for its own verification";
        Evidence::unknown(name, "coarser runs of its method do not finish", notes).finally(
            "runs that verified themselves",
            "it verified itself, see its notes",
        )
    }
}

fn blunt() -> Unresolved {
    Unresolved::new(
        "its steps do not follow the friction: they do not resolve every quantity",
        "give it more time (--longest) or a smaller solver.step_s",
    )
}

/// Returns the evidence, and why it is final. If an engine with friction, or one at its finest setting, fails to converge in
/// any quantity, it is outside the asymptotic range: its uncertainty is then unknown. So is that of an engine at its finest
/// setting with friction whose uncertainty exceeds the resolution anywhere, because unresolved friction affects every quantity.
fn settled(
    mut evidence: Evidence,
    has_friction: bool,
    is_final: Option<Final>,
    change: Needed,
) -> Evidence {
    let stuck = change
        .stuck
        .filter(|_| has_friction || is_final.is_some())
        .or_else(|| (has_friction && is_final.is_some() && change.factor.is_some()).then(blunt));
    if let Some(stuck) = stuck {
        evidence.source = Source::Unknown(stuck);
    }
    evidence.is_final = is_final;
    evidence
}

/// Required refinement of an engine.
struct Needed {
    /// Refinement factor to be resolved; `None` if resolved.
    factor: Option<f64>,
    /// Reason why a quantity does not converge.
    stuck: Option<Unresolved>,
}

fn needed(context: &Context, run: &Participant, evidence: &Evidence, target: f64) -> Needed {
    let (mut most, mut stuck) = (1.0_f64, None);
    for (window, one) in uncertainties(context, run, evidence) {
        if !context.is_pointwise(window.to_s) {
            continue;
        }
        match (&one.l2, one.relative_l2) {
            (Uncertainty::Known(estimate), Some(share)) if share > target => {
                // Runs without an order may show one when finer; rounding remains.
                let is_spread = estimate.basis == Basis::Spread;
                let factor = estimate.refinement_for(estimate.u * target / share);
                most = most.max(factor.unwrap_or(if is_spread { MOST } else { 1.0 }));
            }
            (Uncertainty::Unknown(missing), _) => {
                most = most.max(MOST);
                stuck.get_or_insert_with(|| {
                    let (quantity, window) = (&one.quantity, one.window.word());
                    Unresolved {
                        reason: format!("{quantity}, {window}: {}", missing.reason),
                        ..missing.clone()
                    }
                });
            }
            _ => {}
        }
    }
    Needed {
        factor: (most > 1.0).then_some(most),
        stuck,
    }
}
