//! Runs that verify themselves: what a run's numbers are uncertain by, refined until that is what was promised.
//!
//! A method of order p whose error falls as f^p when its setting is refined by f is off by about
//!
//! ```text
//! u = S D/(f^p - 1),    D = |coarser run - this run|,  S = 1.25
//! ```
//! which is the grid convergence index [Roache 1998, ch. 5]. Half of the usual order stands in for p, or less where a third
//! run shows less, and u is never below a third of D: impacts make errors fall unevenly. A run is resolved when u **and** D
//! are within the promise; D may be four times that where the two rungs before lay within a hundredth of each other, so that
//! errors fall as they should. Two runs that are wrong alike, as when both pass over an impact, are what no
//! estimate shows; so no step is longer than a contact
//! ([`Frequencies::longest_step_s`](crate::Frequencies::longest_step_s)), and the finer rung is clearly finer.
//!
//! Where steps end at samples, the coarsest run has only every other one: otherwise both runs might take the same steps.
//!
//! Costs are counted in evaluations of the forces, not in seconds, so that every machine takes the same rungs.

mod remedy;
mod uncertainty;

pub use remedy::{Remedy, remedy};
pub use uncertainty::{Rung, Uncertainty, Verdict};

use std::rc::Rc;

use pinwheel_mbs::integrators::{Family, method};
use pinwheel_timeseries::Ending;

use crate::auto::{self, COARSER_ROSENBROCK, Plan};
use crate::native::{self, NativeError, NativeRun};
use crate::run_limits::Limits;
use crate::{Distance, Gearbox};

/// Safety of an estimate.
const SAFETY: f64 = 1.25;
/// The least error as a share of the distance to the coarser run.
const LEAST_SHARE: f64 = 1.0 / 3.0;
/// How much of the promise two runs may lie apart where the two before were within [`CALM`] of each other.
const CONFIRMED: f64 = 4.0;
/// Distance below which no impact is on the wrong side of another any more.
const CALM: f64 = 1e-2;
/// Rungs of one method at most.
const MOST_RUNGS: usize = 12;
/// Rungs in a row that may fail before the next method is tried.
const MOST_FAILURES: usize = 3;

/// What a verified run may cost in all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    /// Evaluations of the forces, over all rungs.
    pub evaluations: u64,
}

impl Default for Budget {
    /// Half a minute for the paper's gear, which takes 8e4 of them over 0.6 s.
    fn default() -> Self {
        Self {
            evaluations: 30_000_000,
        }
    }
}

/// Runs the scene until its time series are within `promise` (relative L2 of the forces and of the driver's torque), within
/// the budget; returns the finest run and what is known of its error, or a diverged one if every method of ours diverges. The integrator, step and tolerance of the scene are
/// not used. `watch` as in [`native::run`]; time starts anew with every rung.
///
/// # Errors
/// See [`NativeError`].
pub fn run_resolved(
    gearbox: &Gearbox,
    promise: f64,
    budget: Budget,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<(NativeRun, Uncertainty), NativeError> {
    let mut search = Search {
        gearbox,
        promise,
        left: budget.evaluations,
        rungs: Vec::new(),
        best: None,
        stopped: None,
        diverged: None,
    };
    for plan in auto::chain(&gearbox.scene, promise) {
        if search.climb(&plan, watch)? {
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
    /// Index of its rung.
    rung: usize,
    /// What is known of its error.
    error: Option<Distance>,
    holds: bool,
}

struct Search<'a> {
    gearbox: &'a Gearbox,
    promise: f64,
    left: u64,
    rungs: Vec<Rung>,
    best: Option<Best>,
    /// Why the ladder ended before the promise was met.
    stopped: Option<String>,
    /// The last run that did not come to its end.
    diverged: Option<NativeRun>,
}

impl Search<'_> {
    /// Climbs the ladder of one method; true when there is nothing left to do.
    fn climb(
        &mut self,
        plan: &Plan,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<bool, NativeError> {
        let ladder = Ladder::of(plan, self.gearbox.has_friction());
        let unseen = method(plan.integrator).map_or(0.0, |method| method.unseen);
        let mut plan = plan.finer(1.0 / ladder.first);
        let mut factor = ladder.first;
        let mut before: Option<Rc<NativeRun>> = None;
        let mut last: Option<(Distance, f64)> = None;
        let mut failures = 0;
        for _ in 0..MOST_RUNGS {
            let cost = before.as_ref().map_or(0.0, |run| {
                run.counts.evaluations as f64 * factor.powf(ladder.cost)
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
            match self.rung(&plan, sparse, watch)? {
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
                    factor = ladder.first;
                }
                Some(run) => {
                    let run = Rc::new(run);
                    let estimate = before.as_ref().map(|coarser| {
                        let moved = self
                            .gearbox
                            .distance(&coarser.time_series, &run.time_series);
                        (
                            moved,
                            ladder
                                .error(moved, factor, last)
                                .at_least(unseen * plan.tolerance),
                        )
                    });
                    let index = self.rungs.len() - 1;
                    let mut next = ladder.first;
                    if let Some((moved, error)) = estimate {
                        self.rungs[index].moved = Some(moved);
                        let holds = holds(self.promise, error, moved, last.map(|(d, _)| d));
                        self.keep(Best {
                            run: Rc::clone(&run),
                            sparse: None,
                            rung: index,
                            error: Some(error),
                            holds,
                        });
                        if holds {
                            return Ok(true);
                        }
                        next = ladder.next(error, self.promise);
                        last = Some((moved, factor));
                    } else {
                        self.keep(Best {
                            run: Rc::clone(&run),
                            sparse: Some(plan.clone()),
                            rung: index,
                            error: None,
                            holds: false,
                        });
                    }
                    factor = next;
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
    fn rung(
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
        self.rungs.push(Rung {
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
        budget: Budget,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(NativeRun, Uncertainty), NativeError> {
        let unresolved = |error| Verdict::NotResolved {
            reason: self
                .stopped
                .clone()
                .unwrap_or_else(|| "no second run to judge it by".to_owned()),
            remedy: uncertainty::remedy(self.promise, error, budget),
        };
        let Some(best) = self.best else {
            let run = self.diverged.ok_or(NativeError::Stopped)?;
            let known = Uncertainty {
                promise: self.promise,
                error: None,
                verdict: unresolved(None),
                chosen: self.rungs.len().saturating_sub(1),
                rungs: self.rungs,
            };
            return Ok((run, known));
        };
        let verdict = if best.holds {
            Verdict::Resolved
        } else {
            unresolved(best.error)
        };
        let uncertainty = Uncertainty {
            promise: self.promise,
            error: best.error,
            verdict,
            chosen: best.rung,
            rungs: self.rungs,
        };
        let run = match best.sparse {
            None => Rc::unwrap_or_clone(best.run),
            // The ladder ended at its foot: whoever asked wants all samples.
            Some(plan) => native::run_within(&plan.applied(self.gearbox)?, plan.limits(), watch)?,
        };
        Ok((run, uncertainty))
    }
}

/// Whether a promise is kept: `moved` is the distance to the coarser run, `before` that of one refinement earlier.
fn holds(promise: f64, error: Distance, moved: Distance, before: Option<Distance>) -> bool {
    let calm = before.is_some_and(|before| before.worst() <= CALM);
    let most = if calm { CONFIRMED } else { 1.0 };
    error.worst() <= promise && moved.worst() <= most * promise
}

/// How a method is refined and what that gains.
struct Ladder {
    /// Factor from the coarser to the finer of the first two rungs.
    first: f64,
    /// Usual order of the error in the setting.
    order: f64,
    /// How the cost grows with the factor.
    cost: f64,
    /// Least and most of a refinement.
    factors: (f64, f64),
}

impl Ladder {
    fn of(plan: &Plan, has_friction: bool) -> Self {
        match (plan.adaptive(), plan.family()) {
            // Second order: the error of the run is proportional to the tolerance, its cost to the inverse root.
            (true, Some(Family::SplitImplicit)) => Self {
                first: 4.0,
                order: 1.0,
                cost: 0.5,
                factors: (4.0, 64.0),
            },
            (true, Some(Family::Rosenbrock)) => Self {
                first: COARSER_ROSENBROCK,
                order: 0.9,
                cost: 0.2,
                factors: (10.0, 100.0),
            },
            (true, Some(Family::Exponential)) => Self {
                first: 10.0,
                order: 0.9,
                cost: 0.3,
                factors: (10.0, 100.0),
            },
            // Where friction sets the steps, tolerances change them little, and the error no more: measured on
            // `paper-friction` between 1e-7 and 1e-9, 5 in the driver's torque.
            (true, _) if has_friction => Self {
                first: 10.0,
                order: 0.45,
                cost: 0.2,
                factors: (10.0, 100.0),
            },
            (true, _) => Self {
                first: 10.0,
                order: 0.9,
                cost: 0.2,
                factors: (10.0, 100.0),
            },
            // Kinks leave two orders, friction's switches one and a half, points one.
            (false, _) => Self {
                first: 2.0,
                order: 1.0,
                cost: 1.0,
                factors: (2.0, 8.0),
            },
        }
    }

    /// Estimate of the finer run's error; `before` is the distance one refinement earlier and its factor.
    fn error(&self, moved: Distance, factor: f64, before: Option<(Distance, f64)>) -> Distance {
        let estimate = |moved: f64, before: Option<(f64, f64)>| {
            let usual = 0.5 * self.order;
            let order = match before {
                // Distances fall as errors do: by the factor before to the observed order.
                Some((earlier, by)) if moved > 0.0 => {
                    ((earlier / moved).ln() / by.ln()).clamp(0.5 * usual, usual)
                }
                _ => usual,
            };
            moved * (SAFETY / (factor.powf(order) - 1.0)).max(LEAST_SHARE)
        };
        Distance {
            forces: estimate(moved.forces, before.map(|(d, by)| (d.forces, by))),
            driver_torque: estimate(
                moved.driver_torque,
                before.map(|(d, by)| (d.driver_torque, by)),
            ),
        }
    }

    /// The next refinement: to a third of the promise.
    fn next(&self, error: Distance, promise: f64) -> f64 {
        let wanted = (3.0 * error.worst() / promise).powf(1.0 / self.order);
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
    use crate::scene::Scene;

    fn of(forces: f64, driver_torque: f64) -> Distance {
        Distance {
            forces,
            driver_torque,
        }
    }

    fn ladder(order: f64) -> Ladder {
        Ladder {
            first: 10.0,
            order,
            cost: 0.2,
            factors: (10.0, 100.0),
        }
    }

    fn near(found: f64, wanted: f64) -> bool {
        (found / wanted - 1.0).abs() < 1e-12
    }

    /// Both the error and the distance keep to the promise; the distance may be four times that after a calm one.
    #[test]
    fn a_promise_is_kept_by_error_and_distance() {
        let (small, large) = (of(1e-4, 1e-4), of(1e-4, 2e-3));
        assert!(holds(1e-3, small, small, None));
        assert!(!holds(1e-3, large, small, None));
        assert!(!holds(1e-3, small, large, None));
        assert!(!holds(1e-3, small, large, Some(of(0.02, 0.0))), "not calm");
        assert!(holds(1e-3, small, large, Some(of(0.009, 0.0))));
        assert!(!holds(1e-3, small, of(5e-3, 0.0), Some(small)));
        assert!(!holds(1e-3, of(f64::NAN, 0.0), small, None));
    }

    /// u = S D/(f^p - 1) by hand, for each of the two series by its own distances.
    #[test]
    fn errors_are_estimated_from_distances() {
        // Half of the usual order where nothing else is known: 10^0.5 - 1 = 2.16.
        let first = ladder(1.0).error(of(1e-3, 2e-3), 10.0, None);
        let share = 1.25 / (10_f64.sqrt() - 1.0);
        assert!(near(first.forces, share * 1e-3) && near(first.driver_torque, share * 2e-3));
        // Distances that fell from 4e-3 to 2e-3 show an order of 0.3; from a hundredfold no more than half the usual one counts,
        // from a smaller one no less than half of that.
        let before = Some((of(4e-3, 0.2), 10.0));
        let seen = ladder(1.0).error(of(2e-3, 2e-3), 10.0, before);
        assert!(near(seen.forces, 1.25 / (2.0 - 1.0) * 2e-3), "{seen:?}");
        assert!(near(seen.driver_torque, share * 2e-3));
        let rises = ladder(1.0).error(of(4e-3, 0.0), 10.0, Some((of(2e-3, 1.0), 10.0)));
        assert!(near(rises.forces, 1.25 / (10_f64.powf(0.25) - 1.0) * 4e-3));
        assert_eq!(rises.driver_torque, 0.0);
        // Never below a third of the distance.
        let steep = ladder(4.0).error(of(3e-3, 3e-3), 10.0, None);
        assert!(near(steep.forces, 1e-3));
    }

    /// The next refinement aims at a third of the promise.
    #[test]
    fn refinements_aim_below_the_promise() {
        let next = |error: f64| ladder(0.5).next(of(0.0, error), 1e-3);
        assert!(near(next(2e-3), 36.0));
        assert_eq!((next(1e-3), next(1.0)), (10.0, 100.0), "bounds");
        assert_eq!(next(f64::NAN), 100.0);
    }

    /// Friction slows what a tolerance gains for explicit methods alone.
    #[test]
    fn ladders_know_friction() {
        let mut scene = Scene::paper();
        scene.contact.friction_coefficient = 0.1;
        let orders = |has_friction: bool| -> Vec<f64> {
            let plans = auto::chain(&scene, auto::PROMISE);
            let orders = plans
                .iter()
                .map(|plan| Ladder::of(plan, has_friction).order);
            orders.collect()
        };
        // rodas5p, imex2-adaptive, dopri5, rk4, imex2.
        assert_eq!(orders(true), [0.9, 1.0, 0.45, 1.0, 1.0]);
        assert_eq!(orders(false), [0.9, 1.0, 0.9, 1.0, 1.0]);
    }

    fn gearbox(changes: impl FnOnce(&mut Scene)) -> Gearbox {
        let mut scene = Scene::paper();
        (scene.solver.duration_s, scene.solver.sample_s) = (2e-3, 1e-4);
        changes(&mut scene);
        Gearbox::new(&scene.check().unwrap()).unwrap()
    }

    fn search(gearbox: &Gearbox, promise: f64, left: u64) -> Search<'_> {
        Search {
            gearbox,
            promise,
            left,
            rungs: Vec::new(),
            best: None,
            stopped: None,
            diverged: None,
        }
    }

    /// Climbs the ladder of `name`: whether that was the end, the reason, and the search.
    fn climb<'a>(gearbox: &'a Gearbox, promise: f64, left: u64, name: &str) -> (bool, Search<'a>) {
        let plans = auto::chain(&gearbox.scene, promise);
        let plan = plans.iter().find(|plan| plan.integrator == name).unwrap();
        let mut search = search(gearbox, promise, left);
        let end = search.climb(plan, &mut |_| false).unwrap();
        (end, search)
    }

    /// More load than the teeth carry: three refinements diverge, then it is the next method's turn.
    #[test]
    fn a_method_that_fails_gives_way() {
        let overload = gearbox(|scene| {
            scene.drive.output_torque_n_m = 1e6;
            scene.drive.load_ramp_s = 0.0;
        });
        let (end, found) = climb(&overload, 1e-3, u64::MAX, "rk4");
        assert!(!end && found.best.is_none() && found.diverged.is_some());
        let stopped = found.stopped.unwrap();
        assert!(stopped.contains("rk4 does not get through"), "{stopped}");
        let settings: Vec<&str> = found.rungs.iter().map(|r| r.setting.as_str()).collect();
        assert_eq!(settings.len(), 3, "{settings:?}");
        assert!(settings[0] != settings[1] && settings[1] != settings[2]);
        // A budget that ends within the first run ends all.
        let long = gearbox(|scene| scene.solver.duration_s = 0.05);
        let (end, found) = climb(&long, 1e-3, 10, "rk4");
        assert!(end && found.left == 0);
        let stopped = found.stopped.unwrap();
        assert!(stopped.contains("took all evaluations"), "{stopped}");
    }

    /// A second run that would not fit the budget is not begun; the first one had half of the samples.
    #[test]
    fn what_does_not_fit_the_budget_is_not_begun() {
        let light = gearbox(|_| {});
        let all = climb(&light, 1e-3, u64::MAX, EXPONENTIAL).1;
        let one = all.rungs[0].evaluations;
        assert!(all.rungs[1].evaluations > one, "{:?}", all.rungs);
        let (end, found) = climb(&light, 1e-3, 2 * one, EXPONENTIAL);
        let stopped = found.stopped.unwrap();
        assert!(end && stopped.contains("would take more"), "{stopped}");
        assert_eq!((found.rungs.len(), found.left), (1, one));
        let samples = light.scene.solver.sample_times_s().len();
        let best = found.best.unwrap();
        assert_eq!(best.run.time_series.len(), samples / 2 + 1);
        let best = all.best.unwrap();
        assert!(best.holds && best.rung == all.rungs.len() - 1);
        assert_eq!(best.run.time_series.len(), samples);
    }

    /// Refinement ends where tolerances do, and says that it was not the method.
    #[test]
    fn the_finest_tolerance_ends_a_ladder() {
        let light =
            gearbox(|scene| (scene.solver.duration_s, scene.solver.sample_s) = (1e-4, 1e-5));
        let (end, found) = climb(&light, 1e-17, u64::MAX, "dopri5");
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
        for (rung, error) in [
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
                rung,
                error,
                holds: false,
            });
        }
        assert_eq!(search.best.unwrap().rung, 2);
    }
}
