//! Runs that verify themselves: what a run's numbers are uncertain by, refined until that is small enough.
//!
//! The error of the finest of two or three runs is [`convergence::estimate`], and never below a third of the distance
//! to the run before: impacts make errors fall unevenly. A run is resolved when its uncertainty **and** that distance
//! are within the target; the distance may be four times that where the two runs before lay within a hundredth of each
//! other, so that errors fall as they should. Two runs that are wrong alike, as when both pass over an impact, are what
//! no estimate shows; so no step is longer than a contact
//! ([`Frequencies::longest_step_s`](crate::Frequencies::longest_step_s)), and the finer run is clearly finer.
//!
//! Where steps end at samples, the coarsest run has only every other one: otherwise both runs might take the same steps.
//!
//! Costs are counted in evaluations of the forces, not in seconds, so that every machine takes the same levels.

mod remedy;
mod uncertainty;

pub use remedy::remedy;
pub use uncertainty::{Level, Uncertainty, Verdict};

use std::rc::Rc;

use pinwheel_contact::laws::law_info;
use pinwheel_mbs::integrators::{Family, MethodInfo, method};
use pinwheel_scene::bearings::BearingLaw;
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::convergence::{
    self, KINKS, KINKS_EXPLICIT, Method, Rough, SAFETY_UNCONFIRMED, SCATTER, Step,
};

use crate::auto::{self, COARSER_ROSENBROCK, Plan};
use crate::native::{self, NativeError, NativeRun};
use crate::run_limits::Limits;
use crate::scene::{Detection, Scene};
use crate::{Distance, Gearbox};

/// The least error as a share of the distance to the coarser run.
const LEAST_SHARE: f64 = 1.0 / 3.0;
/// How much of the target two runs may lie apart where the two before were within [`CALM`] of each other.
const CONFIRMED: f64 = 4.0;
/// Distance below which no impact is on the wrong side of another any more.
const CALM: f64 = 1e-2;
/// Levels of one method at most.
const MOST_LEVELS: usize = 12;
/// Levels in a row that may fail before the next method is tried.
const MOST_FAILURES: usize = 3;

/// Usual limit of the cost of a verified run, evaluations of the forces over all levels. It is half a minute for the
/// paper's gear, which takes 8e4 of them over 0.6 s.
pub const BUDGET: u64 = 30_000_000;

/// Runs the scene until its time series are within `target` (relative L2 of the forces and of the driver's torque), within
/// the budget; returns the finest run and what is known of its error, or a diverged one if every method of ours diverges. The integrator, step and tolerance of the scene are
/// not used. `watch` as in [`native::run`]; time starts anew with every level.
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

/// The finest pair so far.
struct Best {
    run: Rc<NativeRun>,
    /// How it was run, if it holds no more than half of the samples.
    sparse: Option<Plan>,
    /// Index of its level.
    level: usize,
    /// Known error of the run.
    error: Option<Distance>,
    holds: bool,
}

struct Search<'a> {
    gearbox: &'a Gearbox,
    target: f64,
    left: u64,
    levels: Vec<Level>,
    best: Option<Best>,
    /// Why the refinement ended before the target was reached.
    stopped: Option<String>,
    /// The last run that did not come to its end.
    diverged: Option<NativeRun>,
}

impl Search<'_> {
    /// Refines one method; true when there is nothing left to do.
    fn refine(
        &mut self,
        plan: &Plan,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<bool, NativeError> {
        let Some(refinement) = Refinement::of(plan, &self.gearbox.scene) else {
            return Ok(false);
        };
        let shared_error = method(plan.integrator).map_or(0.0, |method| method.shared_error);
        let mut plan = plan.finer(1.0 / refinement.first);
        let mut factor = refinement.first;
        let mut before: Option<Rc<NativeRun>> = None;
        let mut last: Option<(Distance, f64)> = None;
        let mut failures = 0;
        for _ in 0..MOST_LEVELS {
            let cost = before.as_ref().map_or(0.0, |run| {
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
            // What only shows how far the next one moves.
            let sparse = before.is_none();
            match self.level(&plan, sparse, watch)? {
                None => {
                    failures += 1;
                    if failures >= MOST_FAILURES || self.left == 0 {
                        self.stopped = Some(if self.left == 0 {
                            format!("{} took all evaluations of the budget", plan.integrator)
                        } else {
                            format!("{} does not get through it", plan.integrator)
                        });
                        return Ok(self.left == 0);
                    }
                    (before, last) = (None, None);
                    factor = refinement.first;
                }
                Some(run) => {
                    let run = Rc::new(run);
                    let mut found = Best {
                        run: Rc::clone(&run),
                        sparse: sparse.then(|| plan.clone()),
                        level: self.levels.len() - 1,
                        error: None,
                        holds: false,
                    };
                    if let Some(coarser) = &before {
                        let (coarser, finer) = (&coarser.time_series, &run.time_series);
                        let moved = self.gearbox.distance(coarser, finer);
                        let error = refinement.error(moved, factor, last);
                        let error = error.at_least(shared_error * plan.tolerance);
                        self.levels[found.level].moved = Some(moved);
                        found.error = Some(error);
                        found.holds = holds(self.target, error, moved, last.map(|(d, _)| d));
                        last = Some((moved, factor));
                        factor = refinement.next(error, self.target);
                    } else {
                        factor = refinement.first;
                    }
                    let done = found.holds;
                    self.keep(found);
                    if done {
                        return Ok(true);
                    }
                    before = Some(run);
                }
            }
            let finer = plan.finer(factor);
            if finer == plan {
                // What moves still at the level of rounding is the scene's own: no other method would tell it.
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

    /// One run; `None` if it diverged.
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

    /// Keeps the run if it is known better than the best.
    fn keep(&mut self, found: Best) {
        let worst = |error: Option<Distance>| error.map_or(f64::INFINITY, |e| e.worst());
        let best = self.best.as_ref();
        if best.is_none_or(|best| worst(found.error) <= worst(best.error)) {
            self.best = Some(found);
        }
    }

    fn finish(
        self,
        budget: u64,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(NativeRun, Uncertainty), NativeError> {
        let unresolved = |error| Verdict::NotResolved {
            reason: self
                .stopped
                .clone()
                .unwrap_or_else(|| "no second run to judge it by".to_owned()),
            remedy: uncertainty::remedy(self.target, error, budget),
        };
        let Some(best) = self.best else {
            let run = self.diverged.ok_or(NativeError::Stopped)?;
            let known = Uncertainty {
                target: self.target,
                error: None,
                verdict: unresolved(None),
                chosen: self.levels.len().saturating_sub(1),
                levels: self.levels,
            };
            return Ok((run, known));
        };
        let verdict = if best.holds {
            Verdict::Resolved
        } else {
            unresolved(best.error)
        };
        let uncertainty = Uncertainty {
            target: self.target,
            error: best.error,
            verdict,
            chosen: best.level,
            levels: self.levels,
        };
        let run = match best.sparse {
            None => Rc::unwrap_or_clone(best.run),
            // The refinement ended at its beginning: whoever asked wants all samples.
            Some(plan) => native::run_within(&plan.applied(self.gearbox)?, plan.limits(), watch)?,
        };
        Ok((run, uncertainty))
    }
}

/// True if a target is reached: `moved` is the distance to the coarser run, `before` that of one refinement earlier.
fn holds(target: f64, error: Distance, moved: Distance, before: Option<Distance>) -> bool {
    let calm = before.is_some_and(|before| before.worst() <= CALM);
    let most = if calm { CONFIRMED } else { 1.0 };
    error.worst() <= target && moved.worst() <= most * target
}

/// Non-smooth feature of a scene that bounds the order of fixed steps.
#[must_use]
pub fn roughness(scene: &Scene) -> Rough {
    let contact = &scene.contact;
    // Laws of hysteresis have another damping, which grows with the penetration.
    let law = law_info(&contact.law);
    let viscous = law.is_none_or(|law| law.keys.contains(&"contact.damping_n_s_m"));
    let bearing = BearingLaw::of(scene).filter(|law| law.clearance_m > 0.0);
    let damped = viscous && contact.damping_n_s_m > 0.0
        || bearing.is_some_and(|law| law.damping_n_s_m > 0.0);
    if contact.friction_coefficient > 0.0 {
        Rough::Friction
    } else if contact.detection == Detection::Points {
        Rough::Points
    } else if damped {
        Rough::Jumps
    } else {
        Rough::Kinks
    }
}

/// How errors of a native method fall on a scene: in the step, or in the tolerance.
#[must_use]
pub fn convergence_of(method: &MethodInfo, scene: &Scene) -> Method {
    match method.adaptive {
        true => by_tolerance(scene, method.family == Family::Explicit),
        false => by_step(f64::from(method.order), scene),
    }
}

/// How errors of fixed steps of a method of this order fall on a scene.
#[must_use]
pub fn by_step(order: f64, scene: &Scene) -> Method {
    let rough = Some(roughness(scene));
    Method::Step { order, rough }
}

/// How errors fall with the tolerance on a scene; `explicit`: with the steps of an explicit Runge-Kutta method.
#[must_use]
pub fn by_tolerance(scene: &Scene, explicit: bool) -> Method {
    let contact = &scene.contact;
    // Where friction sets the explicit steps, tolerances change them little, and the error no more: measured on
    // `paper-friction` between 1e-7 and 1e-9, 5 times the distance in the driver's torque.
    let scatters =
        contact.detection == Detection::Points || explicit && contact.friction_coefficient > 0.0;
    let order = match explicit {
        _ if scatters => SCATTER,
        true => KINKS_EXPLICIT,
        false => KINKS,
    };
    Method::Tolerance { order }
}

/// How a method is refined and what that gains.
struct Refinement {
    /// Kind of setting, with its order, by which runs at two settings show their errors.
    method: Method,
    /// Factor from the coarser to the finer of the first two runs.
    first: f64,
    /// Usual order of the error in the setting.
    order: f64,
    /// How the cost grows with the factor.
    cost: f64,
    /// Least and most of a refinement.
    factors: (f64, f64),
}

impl Refinement {
    fn of(plan: &Plan, scene: &Scene) -> Option<Self> {
        let has_friction = scene.contact.friction_coefficient > 0.0;
        let info = method(plan.integrator)?;
        let by_tolerance = |first, order, cost| Self {
            method: convergence_of(info, scene),
            first,
            order,
            cost,
            factors: (10.0, 100.0),
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
            // Kinks leave two orders, friction's switches one and a half, points one.
            (false, _) => Self {
                factors: (2.0, 8.0),
                ..by_tolerance(2.0, 1.0, 1.0)
            },
        })
    }

    /// Bound of the finer run's error; `before` is the distance one refinement earlier and its factor. Directions are not
    /// looked at, so that no order counts as confirmed.
    fn error(&self, moved: Distance, factor: f64, before: Option<(Distance, f64)>) -> Distance {
        Distance::of_each(|of| {
            let step = |(distance, ratio): (Distance, f64)| Step {
                ratio,
                difference: of(&distance),
            };
            let steps: Vec<Step> = [Some((moved, factor)), before]
                .into_iter()
                .flatten()
                .map(step)
                .collect();
            let known = convergence::estimate(&steps, Some(0.0), self.method, 0.0);
            let apart: f64 = steps.iter().map(|step| step.difference).sum();
            known
                .map_or(SAFETY_UNCONFIRMED * apart, |known| known.u)
                .max(LEAST_SHARE * of(&moved))
        })
        .torque_as_forces()
    }

    /// The next refinement: to a third of the target.
    fn next(&self, error: Distance, target: f64) -> f64 {
        let wanted = (3.0 * error.worst() / target).powf(1.0 / self.order);
        if wanted.is_finite() {
            wanted.clamp(self.factors.0, self.factors.1)
        } else {
            self.factors.1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::auto::EXPONENTIAL;

    fn of(forces: f64, driver_torque: f64) -> Distance {
        Distance {
            forces,
            driver_torque,
            ..Distance::default()
        }
    }

    fn refinement(order: f64) -> Refinement {
        Refinement {
            method: Method::Tolerance { order: 0.5 },
            first: 10.0,
            order,
            cost: 0.2,
            factors: (10.0, 100.0),
        }
    }

    fn near(found: f64, wanted: f64) -> bool {
        (found / wanted - 1.0).abs() < 1e-12
    }

    /// Both the error and the distance keep to the target; the distance may be four times that after a calm one.
    #[test]
    fn a_target_is_reached_by_error_and_distance() {
        let (small, large) = (of(1e-4, 1e-4), of(1e-4, 2e-3));
        assert!(holds(1e-3, small, small, None));
        assert!(!holds(1e-3, large, small, None));
        assert!(!holds(1e-3, small, large, None));
        assert!(!holds(1e-3, small, large, Some(of(0.02, 0.0))), "not calm");
        assert!(holds(1e-3, small, large, Some(of(0.009, 0.0))));
        assert!(!holds(1e-3, small, of(5e-3, 0.0), Some(small)));
        assert!(!holds(1e-3, of(f64::NAN, 0.0), small, None));
    }

    /// Each of the two series by its own distances.
    #[test]
    fn errors_are_estimated_from_distances() {
        // 10^0.5 - 1 = 2.16.
        let first = refinement(1.0).error(of(1e-3, 2e-3), 10.0, None);
        let share = 1.25 / (10_f64.sqrt() - 1.0);
        assert!(near(first.forces, share * 1e-3) && near(first.driver_torque, share * 2e-3));
        // Distances that hardly fall show no order: three times their sum; those that rise too.
        let before = Some((of(3e-3, 1.0), 10.0));
        let seen = refinement(1.0).error(of(2e-3, 4.0), 10.0, before);
        assert!(near(seen.forces, 3.0 * 5e-3), "{seen:?}");
        assert!(near(seen.driver_torque, 3.0 * 5.0), "{seen:?}");
        // Runs that are equal by accident hide no distance before: 1 over 100^(2/3) - 10^(2/3), three times.
        let equal = refinement(1.0).error(of(0.0, 0.0), 10.0, before);
        let loose = 3.0 / (100_f64.powf(2.0 / 3.0) - 10_f64.powf(2.0 / 3.0));
        assert!(near(equal.driver_torque, loose), "{equal:?}");
        // Two runs of the torque that are near by accident know it no better than the forces.
        let close = refinement(1.0).error(of(1e-3, 1e-7), 10.0, None);
        assert_eq!(close.driver_torque, close.forces);
        // Never below a third of the distance.
        let steep = refinement(1.0).error(of(3e-3, 3e-3), 100.0, None);
        assert!(near(steep.forces, 1e-3));
    }

    /// The next refinement aims at a third of the target.
    #[test]
    fn refinements_aim_below_the_target() {
        let next = |error: f64| refinement(0.5).next(of(0.0, error), 1e-3);
        assert!(near(next(2e-3), 36.0));
        assert_eq!((next(1e-3), next(1.0)), (10.0, 100.0), "bounds");
        assert_eq!(next(f64::NAN), 100.0);
    }

    /// Friction slows what a tolerance gains for explicit methods alone.
    #[test]
    fn refinements_know_friction() {
        let mut scene = Scene::paper();
        scene.contact.friction_coefficient = 0.1;
        let plans = auto::chain(&scene, auto::TARGET);
        let orders = |scene: &Scene| -> Vec<f64> {
            let of = |plan| Refinement::of(plan, scene).unwrap().order;
            plans.iter().map(of).collect()
        };
        // rodas5p, imex2-adaptive, dopri5, rk4, imex2.
        assert_eq!(orders(&scene), [0.9, 1.0, 0.45, 1.0, 1.0]);
        assert_eq!(orders(&Scene::paper()), [0.9, 1.0, 0.9, 1.0, 1.0]);
    }

    fn gearbox(changes: impl FnOnce(&mut Scene)) -> Gearbox {
        let mut scene = Scene::paper();
        (scene.solver.duration_s, scene.solver.sample_s) = (2e-3, 1e-4);
        changes(&mut scene);
        Gearbox::new(&scene.check().unwrap()).unwrap()
    }

    fn search(gearbox: &Gearbox, target: f64, left: u64) -> Search<'_> {
        Search {
            gearbox,
            target,
            left,
            levels: Vec::new(),
            best: None,
            stopped: None,
            diverged: None,
        }
    }

    /// Refines `name`: whether that was the end, the reason, and the search.
    fn refine<'a>(gearbox: &'a Gearbox, target: f64, left: u64, name: &str) -> (bool, Search<'a>) {
        let plans = auto::chain(&gearbox.scene, target);
        let plan = plans.iter().find(|plan| plan.integrator == name).unwrap();
        let mut search = search(gearbox, target, left);
        let end = search.refine(plan, &mut |_| false).unwrap();
        (end, search)
    }

    /// More load than the teeth carry: three refinements diverge, then it is the next method's turn.
    #[test]
    fn a_method_that_fails_gives_way() {
        let overload = gearbox(|scene| {
            scene.drive.output_torque_n_m = 1e6;
            scene.drive.load_ramp_s = 0.0;
        });
        let (end, found) = refine(&overload, 1e-3, u64::MAX, "rk4");
        assert!(!end && found.best.is_none() && found.diverged.is_some());
        let stopped = found.stopped.unwrap();
        assert!(stopped.contains("rk4 does not get through"), "{stopped}");
        let settings: Vec<&str> = found.levels.iter().map(|r| r.setting.as_str()).collect();
        assert_eq!(settings.len(), 3, "{settings:?}");
        assert!(settings[0] != settings[1] && settings[1] != settings[2]);
        // A budget that ends within the first run ends all.
        let long = gearbox(|scene| scene.solver.duration_s = 0.05);
        let (end, found) = refine(&long, 1e-3, 10, "rk4");
        assert!(end && found.left == 0);
        let stopped = found.stopped.unwrap();
        assert!(stopped.contains("took all evaluations"), "{stopped}");
    }

    /// A second run that would not fit the budget is not begun; the first one had half of the samples.
    #[test]
    fn what_does_not_fit_the_budget_is_not_begun() {
        let light = gearbox(|_| {});
        let all = refine(&light, 1e-3, u64::MAX, EXPONENTIAL).1;
        let one = all.levels[0].evaluations;
        assert!(all.levels[1].evaluations > one, "{:?}", all.levels);
        let (end, found) = refine(&light, 1e-3, 2 * one, EXPONENTIAL);
        let stopped = found.stopped.unwrap();
        assert!(end && stopped.contains("would take more"), "{stopped}");
        assert_eq!((found.levels.len(), found.left), (1, one));
        let samples = light.scene.solver.sample_times_s().len();
        let best = found.best.unwrap();
        assert_eq!(best.run.time_series.len(), samples / 2 + 1);
        let best = all.best.unwrap();
        assert!(best.holds && best.level == all.levels.len() - 1);
        assert_eq!(best.run.time_series.len(), samples);
    }

    /// Refinement ends where tolerances do, and says that it was not the method.
    #[test]
    fn the_finest_tolerance_ends_a_refinement() {
        let light =
            gearbox(|scene| (scene.solver.duration_s, scene.solver.sample_s) = (1e-4, 1e-5));
        let (end, found) = refine(&light, 1e-17, u64::MAX, "dopri5");
        let stopped = found.stopped.unwrap();
        assert!(end && stopped.contains("amplifies roundings"), "{stopped}");
        assert!(!found.best.unwrap().holds);
    }

    /// The run that is known best is kept, not the last one.
    #[test]
    fn the_best_run_is_kept() {
        let light = gearbox(|scene| scene.solver.duration_s = 1e-4);
        let run = Rc::new(
            native::run(&light, &mut |_| false)
                .unwrap()
                .whole()
                .unwrap(),
        );
        let mut search = search(&light, 1e-3, 0);
        for (level, error) in [
            None,
            Some(of(2e-3, 0.0)),
            Some(of(1e-3, 0.0)),
            Some(of(3e-3, 0.0)),
        ]
        .into_iter()
        .enumerate()
        {
            search.keep(Best {
                run: Rc::clone(&run),
                sparse: None,
                level,
                error,
                holds: false,
            });
        }
        assert_eq!(search.best.unwrap().level, 2);
    }
}
