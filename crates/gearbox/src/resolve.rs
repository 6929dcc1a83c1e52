//! Self-verifying runs: the numerical uncertainty of a run is estimated, and the run refined until it is small enough.
//!
//! The error of the finest of two or three runs is [`pinwheel_timeseries::convergence::estimate`], and never below a third of
//! the distance to the previous run, because impacts make errors fall unevenly. A run is resolved when its uncertainty **and**
//! that distance are within the target. The distance may be four times the target if the two previous runs were within a
//! hundredth of each other, so that errors fall regularly. No estimate detects two runs with equal errors, as when both miss an
//! impact. Therefore no step is longer than a contact ([`Frequencies::longest_step_s`](crate::Frequencies::longest_step_s)),
//! and the refinement is substantial.
//!
//! If steps end at samples, the coarsest run has only every other sample: otherwise both runs might take equal steps.
//!
//! Costs are counted in evaluations of the forces, not in seconds, so that the levels do not depend on the machine.

mod remedy;
pub(crate) mod uncertainty;

pub use remedy::remedy;
pub use uncertainty::{Level, Uncertainty, Verdict};

use std::rc::Rc;

use pinwheel_contact::laws::law_info;
use pinwheel_mbs::integrators::{Family, MethodInfo, method};
use pinwheel_scene::bearings::BearingLaw;
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::convergence::{
    KINKS, KINKS_EXPLICIT, Method, Rough, SAFETY_UNCONFIRMED, SCATTER,
};
use pinwheel_timeseries::ladder::{self, Ladder};

use crate::auto::{self, COARSER_ROSENBROCK, Plan};
use crate::native::{self, NativeError, NativeRun};
use crate::run_limits::Limits;
use crate::scene::{Detection, Scene};
use crate::{Distance, Gearbox, unfollowed};

/// Least error, relative to the distance to the coarser run.
const LEAST_SHARE: f64 = 1.0 / 3.0;
/// Largest distance of two runs, in targets, if the two previous runs were within [`CALM`] of each other.
const CONFIRMED: f64 = 4.0;
/// Distance below which impacts of two runs occur in equal order.
const CALM: f64 = 1e-2;
/// Largest number of levels of one method.
const MOST_LEVELS: usize = 12;
/// Number of successive failed levels after which the next method is tried.
const MOST_FAILURES: usize = 3;

/// Default limit of the cost of a verified run, evaluations of the forces over all levels: half a minute for the paper's gear,
/// which takes 8e4 evaluations over 0.6 s.
pub const BUDGET: u64 = 30_000_000;

/// Runs the scene until its time series are within `target` (relative L2 of the forces and of the driver's torque), within the
/// budget. Returns the finest run with its estimated error, or a diverged run if every native method diverges. The scene's
/// integrator, step and tolerance are not used. `watch` works as in [`native::run`]; its time restarts with every level.
///
/// # Errors
/// See [`NativeError`].
pub fn run_resolved(
    gearbox: &Gearbox,
    target: f64,
    budget: u64,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<(NativeRun, Uncertainty), NativeError> {
    let mut search = Search {
        gearbox,
        target,
        left: budget,
        levels: Vec::new(),
        best: None,
        stopped: None,
        diverged: None,
    };
    for plan in auto::chain(&gearbox.scene, target) {
        if search.refine(&plan, watch)? {
            break;
        }
    }
    search.finish(budget, watch)
}

/// Best run so far, with its error.
#[doc(hidden)]
pub struct Best {
    pub run: Rc<NativeRun>,
    /// Plan of the run, if it has at most half of the samples.
    pub sparse: Option<Plan>,
    /// Index of the run's level.
    pub level: usize,
    /// Estimated error of the run.
    pub error: Option<Distance>,
    /// Coarser runs by the run's method.
    pub ladder: Option<Ladder>,
    pub holds: bool,
}

/// Search for a resolved run of a scene, with its runs so far.
#[doc(hidden)]
pub struct Search<'a> {
    pub gearbox: &'a Gearbox,
    pub target: f64,
    pub left: u64,
    pub levels: Vec<Level>,
    pub best: Option<Best>,
    /// Reason why the refinement ended before the target was reached.
    pub stopped: Option<String>,
    /// Last run that did not finish.
    pub diverged: Option<NativeRun>,
}

impl Search<'_> {
    /// Refines one method; returns true when the search is complete.
    pub fn refine(
        &mut self,
        plan: &Plan,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<bool, NativeError> {
        let Some(refinement) = Refinement::of(plan, &self.gearbox.scene) else {
            return Ok(false);
        };
        let mut plan = plan.finer(1.0 / refinement.first);
        let mut factor = refinement.first;
        // Settings and runs of this method, the finest first.
        let mut runs: Vec<(f64, Rc<NativeRun>)> = Vec::new();
        let mut last: Option<(Distance, f64)> = None;
        let mut failures = 0;
        for _ in 0..MOST_LEVELS {
            let cost = runs.first().map_or(0.0, |(_, run)| {
                run.counts.evaluations as f64 * factor.powf(refinement.cost)
            });
            if cost > self.left as f64 || self.left == 0 {
                self.stopped = Some(format!(
                    "{} at {} would take more evaluations than are left of the budget",
                    plan.integrator,
                    plan.setting()
                ));
                return Ok(true);
            }
            // The first run only measures the distance of the next one.
            let sparse = runs.is_empty();
            match self.level(&plan, sparse, watch)? {
                None => {
                    failures += 1;
                    if failures >= MOST_FAILURES || self.left == 0 {
                        self.stopped = Some(if self.left == 0 {
                            format!("{} took all evaluations of the budget", plan.integrator)
                        } else {
                            format!("{} fails on it", plan.integrator)
                        });
                        return Ok(self.left == 0);
                    }
                    runs.clear();
                    last = None;
                    factor = refinement.first;
                }
                Some(run) => {
                    let run = Rc::new(run);
                    runs.insert(0, (plan.value(), Rc::clone(&run)));
                    runs.truncate(3);
                    let mut trial = Best {
                        ladder: refinement.ladder(&plan, &self.gearbox.scene, &runs),
                        run: Rc::clone(&run),
                        sparse: sparse.then(|| plan.clone()),
                        level: self.levels.len() - 1,
                        error: None,
                        holds: false,
                    };
                    if let Some((_, coarser)) = runs.get(1) {
                        let (coarser, finer) = (&coarser.time_series, &run.time_series);
                        let moved = self.gearbox.distance(coarser, finer);
                        let error = refinement.error(moved, factor, last);
                        let error = error.at_least(refinement.shared_error * plan.tolerance);
                        self.levels[trial.level].moved = Some(moved);
                        trial.error = Some(error);
                        trial.holds = holds(self.target, error, moved, last.map(|(d, _)| d));
                        last = Some((moved, factor));
                        factor = refinement.next(error, self.target);
                    } else {
                        factor = refinement.first;
                    }
                    let done = trial.holds;
                    self.keep(trial);
                    if done {
                        return Ok(true);
                    }
                }
            }
            let finer = plan.finer(factor);
            if finer == plan {
                // Distances at the level of rounding that do not shrink are a property of the scene: no other method would
                // help.
                self.stopped = Some(format!(
                    "at {} {} still moves: the scene amplifies roundings",
                    plan.setting(),
                    plan.integrator
                ));
                return Ok(true);
            }
            plan = finer;
        }
        self.stopped = Some(format!(
            "{} was refined to {} and still moves",
            plan.integrator,
            plan.setting()
        ));
        Ok(false)
    }

    /// Runs one level; `None` if it diverged.
    fn level(
        &mut self,
        plan: &Plan,
        sparse: bool,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<NativeRun>, NativeError> {
        let limits = Limits {
            evaluations: self.left,
            ..plan.limits()
        };
        let gearbox = if sparse {
            plan.applied_sparsely(self.gearbox)?
        } else {
            plan.applied(self.gearbox)?
        };
        let run = native::run_within(&gearbox, limits, watch)?;
        let evaluations = run.counts.evaluations;
        self.left = self.left.saturating_sub(evaluations);
        self.levels.push(Level {
            integrator: plan.integrator.to_owned(),
            setting: plan.setting(),
            evaluations,
            moved: None,
            failure: match &run.ending {
                Ending::Diverged { time_s, quantity } => {
                    Some(format!("t = {time_s:.6} s: {quantity}"))
                }
                _ => None,
            },
        });
        if run.ending.is_finished() {
            return Ok(Some(run));
        }
        self.diverged = Some(run);
        Ok(None)
    }

    /// Keeps the run if its estimated error is smaller than that of the best.
    pub fn keep(&mut self, trial: Best) {
        let worst = |error: Option<Distance>| error.map_or(f64::INFINITY, |e| e.worst());
        let best = self.best.as_ref();
        if best.is_none_or(|best| worst(trial.error) <= worst(best.error)) {
            self.best = Some(trial);
        }
    }

    fn finish(
        self,
        budget: u64,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(NativeRun, Uncertainty), NativeError> {
        let error = self.best.as_ref().and_then(|best| best.error);
        let verdict = match &self.best {
            Some(best) if best.holds => Verdict::Resolved,
            _ => Verdict::NotResolved {
                reason: self
                    .stopped
                    .unwrap_or_else(|| "no second run to judge it by".to_owned()),
                remedy: uncertainty::remedy(self.target, error, budget),
            },
        };
        let (run, chosen, ladder) = match self.best {
            None => {
                let run = self.diverged.ok_or(NativeError::Stopped)?;
                (run, self.levels.len().saturating_sub(1), None)
            }
            Some(best) => {
                let run = match best.sparse {
                    None => Rc::unwrap_or_clone(best.run),
                    // The refinement ended at its first run, but the caller needs all samples.
                    Some(plan) => {
                        native::run_within(&plan.applied(self.gearbox)?, plan.limits(), watch)?
                    }
                };
                (run, best.level, best.ladder)
            }
        };
        let uncertainty = Uncertainty {
            target: self.target,
            error,
            verdict,
            chosen,
            levels: self.levels,
            ladder,
        };
        Ok((run, uncertainty))
    }
}

/// True if a target is reached. `moved` is the distance to the coarser run, `before` that of the previous refinement.
#[doc(hidden)]
pub fn holds(target: f64, error: Distance, moved: Distance, before: Option<Distance>) -> bool {
    let calm = before.is_some_and(|before| before.worst() <= CALM);
    let most = if calm { CONFIRMED } else { 1.0 };
    error.worst() <= target && moved.worst() <= most * target
}

/// Returns the non-smooth feature of a scene that bounds the order of fixed steps.
pub fn roughness(scene: &Scene) -> Rough {
    let contact = &scene.contact;
    // Damping of hysteresis laws does not ramp: it grows with the penetration.
    let law = law_info(&contact.law);
    let viscous = law.is_none_or(|law| law.keys.contains(&"contact.damping_n_s_m"));
    let bearing = BearingLaw::of(scene).filter(|law| law.clearance_m > 0.0);
    let damped = viscous && contact.damping_n_s_m > 0.0
        || bearing.is_some_and(|law| law.damping_n_s_m > 0.0);
    if scene.slides() {
        Rough::Friction
    } else if contact.detection == Detection::Points {
        Rough::Points
    } else if damped {
        Rough::Jumps
    } else {
        Rough::Kinks
    }
}

/// Returns the convergence of a native method on a scene: in the step, or in the tolerance.
pub fn convergence_of(method: &MethodInfo, scene: &Scene) -> Method {
    match method.adaptive {
        true => by_tolerance(scene, method.family == Family::Explicit),
        false => by_step(f64::from(method.order), scene),
    }
}

/// Returns the convergence in the step of a method of this order with fixed steps.
pub fn by_step(order: f64, scene: &Scene) -> Method {
    let rough = Some(roughness(scene));
    Method::Step { order, rough }
}

/// Returns the convergence in the tolerance on a scene; `explicit`: for an explicit Runge-Kutta method.
pub fn by_tolerance(scene: &Scene, explicit: bool) -> Method {
    let contact = &scene.contact;
    // If friction limits the explicit steps, tolerances hardly change steps and error. On `paper-friction` between 1e-7 and
    // 1e-9 the error was 5 times the distance in the driver's torque.
    let scatters = contact.detection == Detection::Points || explicit && scene.slides();
    let order = match explicit {
        _ if scatters => SCATTER,
        true => KINKS_EXPLICIT,
        false => KINKS,
    };
    Method::Tolerance { order }
}

/// Refinement of a method, with its gain and cost.
#[doc(hidden)]
pub struct Refinement {
    /// Kind of setting with its order, by which two runs reveal their errors.
    pub method: Method,
    /// Refinement factor from the coarser to the finer of the first two runs.
    pub first: f64,
    /// Usual order of the error in the setting.
    pub order: f64,
    /// Exponent of the cost in the factor.
    pub cost: f64,
    /// Least and largest factor of a refinement.
    pub factors: (f64, f64),
    /// Error common to all runs, relative to the tolerance.
    pub shared_error: f64,
}

impl Refinement {
    pub fn of(plan: &Plan, scene: &Scene) -> Option<Self> {
        let has_friction = scene.slides();
        let info = method(plan.integrator)?;
        let by_tolerance = |first, order, cost| Self {
            method: convergence_of(info, scene),
            first,
            order,
            cost,
            factors: (10.0, 100.0),
            shared_error: info.shared_error,
        };
        Some(match (info.adaptive, info.family) {
            // Second order: the error of the run is proportional to the tolerance, its cost to the inverse root.
            (true, Family::SplitImplicit) => Self {
                factors: (4.0, 64.0),
                ..by_tolerance(4.0, 1.0, 0.5)
            },
            (true, Family::Rosenbrock) => by_tolerance(COARSER_ROSENBROCK, 0.9, 0.2),
            (true, Family::Exponential) => by_tolerance(10.0, 0.9, 0.3),
            (true, _) if has_friction => by_tolerance(10.0, 0.45, 0.2),
            (true, _) => by_tolerance(10.0, 0.9, 0.2),
            // Kinks reduce the order to two, switches of friction to one and a half, points to one.
            (false, _) => Self {
                factors: (2.0, 8.0),
                ..by_tolerance(2.0, 1.0, 1.0)
            },
        })
    }

    /// Returns a bound of the finer run's error; `before` is the previous refinement's distance and factor. Directions of the
    /// changes are not compared, so no order counts as confirmed.
    pub fn error(&self, moved: Distance, factor: f64, before: Option<(Distance, f64)>) -> Distance {
        let apart: Vec<_> = [Some((moved, factor)), before]
            .into_iter()
            .flatten()
            .collect();
        let known = ladder::error(&apart, Some(0.0), self.method, 0.0);
        let bound = |of: fn(&Distance) -> f64| match of(&known) {
            known if known.is_nan() => {
                SAFETY_UNCONFIRMED * apart.iter().map(|(distance, _)| of(distance)).sum::<f64>()
            }
            known => known,
        };
        Distance::of_each(|of| bound(of).max(LEAST_SHARE * of(&moved))).torque_as_forces()
    }

    /// Returns the coarser of `runs`, the finest of which is the plan's, as evidence of its error; `None` without any, or if
    /// explicit steps do not resolve the friction.
    fn ladder(&self, plan: &Plan, scene: &Scene, runs: &[(f64, Rc<NativeRun>)]) -> Option<Ladder> {
        let is_stepped = plan.family() == Some(Family::Explicit) && !plan.adaptive();
        if runs.len() < 2 || is_stepped && unfollowed(scene, plan.step_s).is_some() {
            return None;
        }
        let level = |(setting, run): &(f64, Rc<NativeRun>)| ladder::Level {
            setting: *setting,
            run: Ok(run.time_series.clone()),
            // Included in the wall time of the run.
            wall_s: 0.0,
        };
        Some(Ladder {
            method: self.method,
            finest: plan.value(),
            floor: self.shared_error * plan.tolerance,
            coarser: runs[1..].iter().map(level).collect(),
        })
    }

    /// Returns the factor of the next refinement, which aims at a third of the target.
    pub fn next(&self, error: Distance, target: f64) -> f64 {
        let wanted = (3.0 * error.worst() / target).powf(1.0 / self.order);
        if wanted.is_finite() {
            wanted.clamp(self.factors.0, self.factors.1)
        } else {
            self.factors.1
        }
    }
}
