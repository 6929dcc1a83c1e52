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

use pinwheel_mbs::integrators::method;

use crate::auto::{self, COARSER_ROSENBROCK, EXPONENTIAL, Plan};
use crate::native::{self, NativeError, NativeRun};
use crate::pace::Limits;
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

/// Runs the scene until its courses are within `promise` (relative L2 of the forces and of the driver's torque), within
/// the budget; returns the finest run and what is known of its error. The integrator, step and tolerance of the scene are
/// not used. `watch` as in [`native::run`]; time starts anew with every rung.
///
/// # Errors
/// See [`NativeError`]; diverged only if every method of ours does.
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
        error: None,
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
    error: Option<NativeError>,
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
                        let moved = Distance::between(self.gearbox, &coarser.courses, &run.courses);
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
                        let calm = last.is_some_and(|(d, _)| d.worst() <= CALM);
                        let most = if calm { CONFIRMED } else { 1.0 };
                        let holds =
                            error.worst() <= self.promise && moved.worst() <= most * self.promise;
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
                        next = ladder.next(error.worst() / self.promise);
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
        let (run, failure) = match native::run_within(&gearbox, limits, watch) {
            Ok(run) => (Ok(run), None),
            Err(NativeError::Diverged {
                time_s,
                quantity,
                partial,
            }) => {
                let told = format!("t = {time_s:.6} s: {quantity}");
                let error = NativeError::Diverged {
                    time_s,
                    quantity,
                    partial,
                };
                (Err(error), Some(told))
            }
            Err(error) => return Err(error),
        };
        let counts = match &run {
            Ok(run) => run.counts,
            Err(NativeError::Diverged { partial, .. }) => partial.counts,
            Err(_) => Default::default(),
        };
        self.left = self.left.saturating_sub(counts.evaluations);
        self.rungs.push(Rung {
            integrator: plan.integrator.to_owned(),
            setting: plan.setting(),
            evaluations: counts.evaluations,
            moved: None,
            failure,
        });
        match run {
            Ok(run) => Ok(Some(run)),
            Err(error) => {
                self.error = Some(error);
                Ok(None)
            }
        }
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
        let Some(best) = self.best else {
            return Err(self.error.unwrap_or(NativeError::Stopped));
        };
        let verdict = if best.holds {
            Verdict::Resolved
        } else {
            Verdict::NotResolved {
                reason: self
                    .stopped
                    .unwrap_or_else(|| "no second run to judge it by".to_owned()),
                remedy: uncertainty::remedy(self.promise, best.error, budget),
            }
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
    fn of(plan: &Plan, rubs: bool) -> Self {
        match (plan.adaptive(), plan.integrator) {
            // Second order: the error of the run is proportional to the tolerance, its cost to the inverse root.
            (true, "imex2-adaptive") => Self {
                first: 4.0,
                order: 1.0,
                cost: 0.5,
                factors: (4.0, 64.0),
            },
            (true, "rodas5p") => Self {
                first: COARSER_ROSENBROCK,
                order: 0.9,
                cost: 0.2,
                factors: (10.0, 100.0),
            },
            (true, EXPONENTIAL) => Self {
                first: 10.0,
                order: 0.9,
                cost: 0.3,
                factors: (10.0, 100.0),
            },
            // Where friction sets the steps, tolerances change them little, and the error no more: measured on
            // `paper-friction` between 1e-7 and 1e-9, 5 in the driver's torque.
            (true, _) if rubs => Self {
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

    /// The next refinement where the error is `excess` times the promise: to a third of it.
    fn next(&self, excess: f64) -> f64 {
        let wanted = (3.0 * excess).powf(1.0 / self.order);
        if wanted.is_finite() {
            wanted.clamp(self.factors.0, self.factors.1)
        } else {
            self.factors.1
        }
    }
}
