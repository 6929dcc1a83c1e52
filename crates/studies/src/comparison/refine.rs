//! The refinement study of every engine: what its numbers are uncertain by, refined while time allows.
//!
//! The finest run is the one that is shown and compared; two coarser ones (2 and 4 times the step, 10 and 100 times the
//! tolerance; less for RODAS5P) say how far it may be off. Where a setting is free, and not stated by whoever asks, an engine whose
//! uncertainty is too large is run finer: the finest run so far becomes a level, so each refinement costs one run.

use std::time::Duration;

use pinwheel_compare::uncertainty::{Basis, Final, Method, Source, Unresolved};
use pinwheel_compare::{
    Context, Evidence, Level, Participant, RESOLUTION, RefinementStudy, Rules, SharedModel, Status,
    Uncertainty, compare,
};
use pinwheel_engines::{AccuracySetting, Engine, Form, Native, Refinement};
use pinwheel_gearbox::auto::{self, Plan};
use pinwheel_gearbox::resolve::{by_step, by_tolerance};
use pinwheel_gearbox::{Gearbox, unfollowed};
use pinwheel_mbs::integrators::{Family, UNSEEN, method};
use pinwheel_scene::{CheckedScene, Override, preset};
use pinwheel_timeseries::TimeSeries;

use super::take_part;
use crate::StudyError;
use crate::control::{Control, Progress, WITHIN};

/// How much is done for sharp statements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// CPU time that one engine's runs may take before it is refined no further.
    pub longest: Duration,
    /// True if step, tolerance and integrator of the scene are obeyed as they stand. DefaultValue they are where
    /// refinement begins.
    pub obey: bool,
    /// The largest U of a pair that still counts as resolved, relative.
    pub resolution: f64,
}

impl Effort {
    /// Half a minute an engine.
    pub const LONGEST: Duration = Duration::from_secs(30);

    /// Effort that suits a scene: settings that its file states are obeyed, those that follow from formulas or come
    /// with a base are a beginning.
    #[must_use]
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

    /// As [`of`](Self::of) for the scene that the user calls `spec` and changes by `sets`: what these state is obeyed, what a
    /// preset says is a beginning.
    ///
    /// # Errors
    /// A time below 0, or a resolution that is no share.
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

/// Time that one run may take however little there is. Nobody minds a second.
const LEAST: Duration = Duration::from_millis(500);
/// Share of the resolution that one engine's uncertainty may take: it leaves room for the other's.
const TARGET: f64 = 0.45;
/// Most that one refinement makes finer.
const MOST: f64 = 8.0;
/// How much dearer a run at a tenth of the tolerance is.
const DECADE: f64 = 1.8;

/// An engine, and how its error is set.
pub struct Refiner<'a> {
    /// For the finest run as the scene has it.
    own: &'a dyn Engine,
    /// For all runs at settings given here, where the engine itself does not take them.
    levels: Option<Box<dyn Engine>>,
    /// The gearbox with a named method.
    gearbox: Gearbox,
    /// Setting that determines the engine's error.
    knob: AccuracySetting,
    /// Order of the engine's error in a step.
    order: f64,
    /// Step (s) or tolerance of the finest run.
    pub value: f64,
    /// True if the engine's friction is not ours or explicit: at a prescribed step more may not be asked of the engine.
    explicit_friction: bool,
    /// Error that the engine's iterations leave, whatever its step.
    floor: f64,
    /// Common error of all runs that they do not show, as a share of the tolerance.
    common_error: f64,
    /// Time that one run may take.
    most: Option<Duration>,
}

/// Tolerance of RODAS5P where a comparison begins: ten times looser is as loose as it may be.
const ROSENBROCK: f64 = 1e-6;

const EXPLICIT: &str = "its friction is not ours or explicit, and takes steps of about 2e-7 s";

impl<'a> Refiner<'a> {
    /// From what the scene says on.
    fn new(own: &'a dyn Engine, gearbox: Gearbox, by: Refinement) -> Self {
        Self {
            own,
            levels: None,
            knob: by.knob,
            order: by.order,
            value: by.knob.get(&gearbox.scene),
            gearbox,
            explicit_friction: false,
            floor: 0.0,
            common_error: UNSEEN,
            most: None,
        }
    }

    /// `None` where no setting of the scene is the engine's.
    fn of(own: &'a dyn Engine, gearbox: &Gearbox) -> Option<Self> {
        let info = own.info();
        let refinement = match info.form {
            Some(Form::Resolved) => return Self::resolved(own, gearbox),
            Some(_) => return Self::native(own, gearbox.clone()),
            None => info.refinement?,
        };
        let foreign = Self::new(own, gearbox.clone(), refinement);
        Some(match refinement.knob {
            AccuracySetting::Step => Self {
                explicit_friction: foreign.has_friction(),
                floor: info.floor,
                ..foreign
            },
            // Error control follows the friction.
            AccuracySetting::Tolerance => Self {
                common_error: info.shared_error,
                ..foreign
            },
        })
    }

    /// A native engine with the method that the scene names.
    pub fn native(own: &'a dyn Engine, gearbox: Gearbox) -> Option<Self> {
        let method = method(&gearbox.scene.solver.integrator)?;
        let (knob, order) = (AccuracySetting::of(method.name), f64::from(method.order));
        Some(Self {
            common_error: method.shared_error,
            ..Self::new(own, gearbox, Refinement { knob, order })
        })
    }

    /// The resolved form plans and refines by itself: its levels are runs of the reduced form by the method that its plan
    /// begins with, at coarser settings than the plan's.
    fn resolved(own: &'a dyn Engine, gearbox: &Gearbox) -> Option<Self> {
        let plan = auto::plan(&gearbox.scene, Native::resolved_target(&gearbox.scene));
        let (knob, order) = (AccuracySetting::of(plan.integrator), 2.0);
        Some(Self {
            levels: Some(Box::new(Native::REDUCED)),
            value: match knob {
                AccuracySetting::Step => plan.step_s,
                AccuracySetting::Tolerance => plan.tolerance,
            },
            common_error: method(plan.integrator).map_or(0.0, |method| method.shared_error),
            ..Self::new(own, plan.applied(gearbox).ok()?, Refinement { knob, order })
        })
    }

    /// The candidates to run a scene, the best first: one, but for native engines whose method is left to us.
    fn candidates(own: &'a dyn Engine, gearbox: &Gearbox) -> Vec<Self> {
        let automatic = gearbox.scene.solver.integrator == auto::AUTO;
        if !automatic || !matches!(own.info().form, Some(Form::Reduced | Form::Lagrange)) {
            return Self::of(own, gearbox).into_iter().collect();
        }
        let mut plans = auto::chain(&gearbox.scene, auto::TARGET);
        if let Some((_, others)) = plans.split_first_mut() {
            // Where friction was too stiff for one method, explicit steps get through and chatter.
            others.sort_by_key(|plan| plan.family() == Some(Family::Explicit));
        }
        let way = |plan: &Plan| {
            let mut way = Self::native(own, plan.applied(gearbox).ok()?)?;
            if plan.family() == Some(Family::Rosenbrock) {
                way.value = way.value.min(ROSENBROCK);
            }
            Some(way)
        };
        plans.iter().filter_map(way).collect()
    }

    /// Factor by which its steps must be shorter than `value` to follow explicit friction; `None` if they do.
    fn chatters(&self, value: f64) -> Option<f64> {
        let explicit = self.is_runge_kutta() || self.own.info().explicit_friction;
        let shorter = unfollowed(&self.gearbox.scene, value);
        shorter.filter(|_| explicit && self.knob == AccuracySetting::Step)
    }

    fn has_friction(&self) -> bool {
        self.gearbox.scene.contact.friction_coefficient > 0.0
    }

    /// True if the engine is a native form with steps of Dormand-Prince: `etd-adams` takes these where there is no
    /// Jacobian.
    fn is_runge_kutta(&self) -> bool {
        let family = method(&self.gearbox.scene.solver.integrator).map(|method| method.family);
        match self.own.info().form {
            Some(Form::Lagrange) => {
                matches!(family, Some(Family::Explicit | Family::Exponential))
            }
            form => form.is_some() && family == Some(Family::Explicit),
        }
    }

    fn method(&self) -> Method {
        let scene = &self.gearbox.scene;
        match self.knob {
            AccuracySetting::Step => by_step(self.order, scene),
            AccuracySetting::Tolerance => by_tolerance(scene, self.is_runge_kutta()),
        }
    }

    /// Begins where two coarser runs are possible.
    pub fn leave_room(&mut self) {
        if self.knob == AccuracySetting::Step {
            self.value = self.value.min(self.gearbox.scene.solver.sample_s / 4.0);
        }
    }

    /// Two coarser settings than `value`; fewer where a step would be longer than the samples are apart.
    pub fn coarser(&self, value: f64) -> Vec<f64> {
        let solver = &self.gearbox.scene.solver;
        if self.knob == AccuracySetting::Tolerance {
            // The resolved form is dear, and its error small: its levels are further apart.
            let family = method(&solver.integrator).map(|method| method.family);
            let factor = match family {
                // Looser than 1e-5 it does not land on the friction's ramp.
                Some(Family::Rosenbrock) => 10_f64.sqrt(),
                Some(Family::Explicit | Family::Exponential) if self.levels.is_some() => 100.0,
                _ => 10.0,
            };
            return vec![value * factor, value * factor * factor];
        }
        // No step is longer than the samples are apart: engines end one at each, so a longer one would show nothing.
        let sample_s = solver.sample_s;
        let steps = sample_s / value;
        let whole = (steps - steps.round()).abs() < 1e-6;
        let mut found: Vec<f64> = [2.0, 4.0]
            .iter()
            .map(|times| {
                if whole {
                    // Samples stay on steps.
                    sample_s / (steps.round() / times).ceil()
                } else {
                    times * value
                }
            })
            .filter(|longer| *longer > 1.001 * value && *longer < 1.001 * sample_s)
            .collect();
        found.dedup();
        found
    }

    /// Runs at one setting.
    fn run(
        &self,
        value: f64,
        at: Progress<'_>,
        control: &Control<'_>,
    ) -> Result<Participant, StudyError> {
        let engine = match &self.levels {
            Some(_) if value == self.value => self.own,
            Some(levels) => levels.as_ref(),
            None => self.own,
        };
        let set = self.gearbox.with_solver(|solver| match self.knob {
            AccuracySetting::Step => solver.step_s = value.min(solver.duration_s),
            AccuracySetting::Tolerance => solver.tolerance = value.min(1e-2),
        });
        // The resolved form takes its settings from the scene as it is.
        let gearbox = match set {
            Ok(gearbox) if self.levels.is_none() || value != self.value => gearbox,
            _ => self.gearbox.clone(),
        };
        take_part(engine, &gearbox, self.most, at, control)
    }

    /// Error that no run of the refinement study shows, as a share of a quantity, where the finest has this setting.
    fn left(&self, value: f64) -> f64 {
        match self.knob {
            AccuracySetting::Step => self.floor,
            AccuracySetting::Tolerance => self.floor.max(self.common_error * value),
        }
    }

    /// Returns the CPU time of the refinement study besides its coarsest run, s; that run had this setting and took `cpu_s`.
    fn rest(&self, coarsest: f64, cpu_s: f64) -> f64 {
        let finer = [self.value].into_iter().chain(self.coarser(self.value));
        finer
            .filter(|value| *value < coarsest)
            .map(|value| cpu_s * self.dearer(coarsest / value))
            .sum()
    }

    /// How much dearer a run is whose setting is `factor` times finer.
    fn dearer(&self, factor: f64) -> f64 {
        match self.knob {
            AccuracySetting::Step => factor,
            AccuracySetting::Tolerance => DECADE.powf(factor.log10()),
        }
    }
}

/// A run at one setting.
struct At {
    value: f64,
    run: Result<TimeSeries, String>,
    wall_s: f64,
}

impl At {
    fn of(value: f64, ran: Participant) -> Self {
        Self {
            value,
            wall_s: ran.cost.wall_s,
            run: match ran.status.reason() {
                None => Ok(ran.time_series),
                Some(reason) => Err(reason),
            },
        }
    }
}

/// Returns the CPU time of a run and its children, s: unlike wall time it hardly depends on what else the machine does, so that
/// a verdict repeats.
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
    // What its user states is run, and so is the native engine.
    let limited = !effort.obey && engine.track() != SharedModel::Native;
    let most = limited.then(|| effort.longest.max(LEAST).saturating_mul(WITHIN));
    let Some(mut engines) = candidates.next() else {
        let participant = take_part(engine, gearbox, most, at, control)?;
        let evidence = if participant.cost.recorded.is_some() {
            recorded(&participant)
        } else if engine.info().brought {
            Evidence::unknown(
                name,
                "it does not say which setting refines it, so its numerical uncertainty is not known",
                "state `[refine]` in its manifest (of an engine in Python `order`)",
            )
        } else {
            unknown(
                name,
                "engines with a step of their own",
                "its step and its contacts are its own",
            )
        };
        return Ok((participant, evidence));
    };
    let longest = effort.longest.as_secs_f64();
    let free = !effort.obey && engines.levels.is_none();
    engines.most = most;
    if free {
        engines.leave_room();
    }
    // A foreign engine is asked for its coarsest run first: what that takes tells whether the others fit the time.
    let (mut coarsest, mut spent, mut rest) = (None, 0.0, 0.0);
    if limited
        && free
        && let Some(&value) = engines.coarser(engines.value).last()
    {
        let run = engines.run(value, at, control)?;
        if run.status.is_finished() && run.cost.recorded.is_none() {
            spent = cpu_s(&run);
            rest = engines.rest(value, spent);
            coarsest = Some((value, run));
        }
    }
    let (mut value, mut finest) = match coarsest.take_if(|_| spent + rest > longest) {
        // It becomes the finest level of a study that fits.
        Some(coarsest) => coarsest,
        None => {
            let run = engines.run(engines.value, at, control)?;
            spent += cpu_s(&run);
            (engines.value, run)
        }
    };
    while matches!(finest.status, Status::Diverged { .. }) {
        let Some(next) = candidates.next() else { break };
        engines = next;
        value = engines.value;
        finest = engines.run(value, at, control)?;
        spent += cpu_s(&finest);
    }
    if finest.cost.recorded.is_some() {
        let evidence = recorded(&finest);
        return Ok((finest, evidence));
    }
    // A derived setting may be too coarse to get through at all.
    for _ in 0..3 {
        let diverged = matches!(finest.status, Status::Diverged { .. });
        if !(diverged && free) || spent > longest {
            break;
        }
        value /= 4.0;
        finest = engines.run(value, at, control)?;
        spent += cpu_s(&finest);
    }
    if !finest.status.is_finished() {
        let nothing = Evidence::unknown(name, "its run did not finish", "see its reason");
        return Ok((finest, nothing));
    }
    let mut levels = Vec::new();
    for value in engines.coarser(value) {
        levels.push(match coarsest.take_if(|run| run.0 == value) {
            Some((_, run)) => At::of(value, run),
            None => {
                let run = engines.run(value, at, control)?;
                spent += cpu_s(&run);
                At::of(value, run)
            }
        });
    }
    if engines.levels.is_some() && levels.iter().any(|level| level.run.is_err()) {
        // The resolved form got through by refining, or by another method: coarser runs of the first one do not.
        let own = Evidence::unknown(
            name,
            "coarser runs of its method do not get through",
            "see its notes for what it verified itself",
        );
        let group = "runs that verified themselves";
        let evidence = own.finally(group, "it verified itself, see its notes");
        return Ok((finest, evidence));
    }
    let mut is_final = (engines.explicit_friction && effort.obey).then(|| Final {
        group: "engines with explicit friction at a prescribed step",
        reason: EXPLICIT.to_owned(),
    });
    loop {
        let evidence = evidence(&engines, value, &levels);
        let mut found = refinement(context, &finest, &evidence, TARGET * effort.resolution)?;
        if let Some(shorter) = engines.chatters(value) {
            found.factor = Some(found.factor.map_or(shorter, |factor| factor.max(shorter)));
            found.stuck = Some(blunt());
        }
        let Some(needed) = found.factor.filter(|_| free) else {
            return Ok((finest, settled(evidence, &engines, is_final, found)));
        };
        let (mut factor, least) = match engines.knob {
            AccuracySetting::Step => (2_f64.powf(needed.log2().ceil()).clamp(2.0, MOST), 2.0),
            AccuracySetting::Tolerance => {
                (10_f64.powf(needed.log10().ceil()).clamp(10.0, 100.0), 10.0)
            }
        };
        let next = |factor: f64| cpu_s(&finest) * engines.dearer(factor);
        // What would take too long at once may go in smaller steps.
        while spent + next(factor) > longest && factor > least {
            factor /= least;
        }
        let next = next(factor);
        let mut finer = None;
        if spent + next <= longest && value / factor >= 1e-13 {
            let ran = engines.run(value / factor, at, control)?;
            spent += cpu_s(&ran);
            finer = ran.status.is_finished().then_some(ran);
        }
        let Some(finer) = finer else {
            // Foreign engines do what they can in the time they have; ours must do.
            if finest.track != SharedModel::Native {
                let enough = spent + 1.2 * cpu_s(&finest) * engines.dearer(needed);
                is_final = Some(Final {
                    group: "engines refined as far as --longest allows",
                    reason: format!(
                        "refined as far as {longest} s of CPU allow; give it more: --longest {:.0}",
                        enough.max(spent + next).ceil()
                    ),
                });
            }
            return Ok((finest, settled(evidence, &engines, is_final, found)));
        };
        let before = std::mem::replace(&mut finest, finer);
        levels.insert(0, At::of(value, before));
        levels.truncate(2);
        value /= factor;
    }
}

fn unknown(name: &str, group: &'static str, reason: &str) -> Evidence {
    Evidence::unknown(name, reason, "compare it by its means")
        .finally(group, "its numerical uncertainty cannot be had by refining")
}

fn recorded(participant: &Participant) -> Evidence {
    let nothing = unknown(
        &participant.name,
        "recordings",
        "a recording cannot be run again at other settings",
    );
    match participant.cost.recorded_uncertainty.as_slice() {
        [] => nothing,
        list => Evidence {
            source: Source::Recorded(list.to_vec()),
            ..nothing
        },
    }
}

fn evidence(engines: &Refiner<'_>, value: f64, levels: &[At]) -> Evidence {
    if levels.is_empty() {
        return Evidence::unknown(
            engines.own.name(),
            "its step is as long as its samples are apart, so no coarser run shows its error",
            "take a step of a quarter of solver.sample_s or less",
        );
    }
    let coarser = levels.iter().map(|at| Level {
        refinement: at.value / value,
        run: at.run.clone(),
        wall_s: at.wall_s,
    });
    let study = RefinementStudy {
        method: engines.method(),
        finest: value,
        coarser: coarser.collect(),
    };
    Evidence::refinement(engines.own.name(), study).with_floor(engines.left(value))
}

fn blunt() -> Unresolved {
    Unresolved::new(
        "its steps do not follow the friction: they do not resolve every quantity",
        "give it more time (--longest) or a smaller solver.step_s",
    )
}

/// The evidence, and why it is final. An engine with friction, or at its best, that does not converge in one quantity is outside
/// of the range in which refinement shows errors: then it shows none. So is an engine at its best whose friction is
/// still above the resolution anywhere: what it cannot follow shows in every quantity sooner or later.
fn settled(
    evidence: Evidence,
    engines: &Refiner<'_>,
    is_final: Option<Final>,
    found: Needed,
) -> Evidence {
    let has_friction = engines.has_friction();
    let stuck = found
        .stuck
        .filter(|_| has_friction || is_final.is_some())
        .or_else(|| (has_friction && is_final.is_some() && found.factor.is_some()).then(blunt));
    let source = match stuck {
        Some(stuck) => Evidence::unknown("", stuck.reason, stuck.remedy).source,
        None => evidence.source,
    };
    Evidence {
        source,
        is_final,
        ..evidence
    }
}

/// Work that remains for an engine.
struct Needed {
    /// How many times finer it must run to be resolved; `None` where it is.
    factor: Option<f64>,
    /// Why a quantity does not converge.
    stuck: Option<Unresolved>,
}

fn refinement(
    context: &Context,
    participant: &Participant,
    evidence: &Evidence,
    target: f64,
) -> Result<Needed, StudyError> {
    let rules = Rules {
        evidence: std::slice::from_ref(evidence),
        ..Rules::default()
    };
    let found = compare(context, std::slice::from_ref(participant), &rules)?;
    let pointwise = |kind| {
        let mut windows = found.windows.iter();
        windows.any(|w| w.kind == kind && context.is_pointwise(w.to_s))
    };
    let (mut most, mut stuck) = (1.0_f64, None);
    let all = found.engines.iter().flat_map(|e| &e.uncertainty);
    for one in all.filter(|u| pointwise(u.window)) {
        match (&one.l2, one.relative_l2) {
            (Uncertainty::Known(estimate), Some(share)) if share > target => {
                // Runs that show no order may do so when they are finer; what is rounding stays.
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
    Ok(Needed {
        factor: (most > 1.0).then_some(most),
        stuck,
    })
}
