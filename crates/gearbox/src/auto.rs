//! Choice of method, step and tolerance for `integrator = "auto"` from a scene's forces, with the reason.
//!
//! A plan is a first estimate from [`Frequencies`], which the module [`resolve`](crate::resolve) verifies on the run and
//! refines. If it fails, the next plan of the [`chain`] is tried.

use pinwheel_mbs::integrators::{Family, method};

use crate::energy::EnergyAccount;
use crate::frequencies::Frequencies;
use crate::run_limits::Limits;
use crate::scene::{Detection, Formulation, FrictionLaw, Scene};
use crate::{Gearbox, GearboxError, speed_profile};

pub use pinwheel_scene::names::AUTO;

/// Target of the numerical uncertainty of `auto`: relative L2 of all pin forces over the run, and of the driver's torque. It is
/// a tenth of the accuracy of the least certain inputs of the model (stiffness, friction).
pub const TARGET: f64 = 1e-3;

/// Tolerance of Dormand-Prince, relative to the target. Its error is about 15 times the tolerance on gears whose contacts stay
/// closed, and up to hundreds of times where discs bounce.
const SMOOTH: f64 = 5e-4;
/// Longest step of the exponential method, in steps that resolve every contact: it evaluates the forces once a step, at its
/// end.
const EXPONENTIAL_STEP: f64 = 1.25;
/// Tolerance with friction, where the friction's rate limits steps and more digits cost little: `paper-friction` takes 3 % more
/// evaluations at 1e-7 than at 1e-5, for a torque 500 times as accurate.
const RUBBING: f64 = 1e-4;
/// Tolerance of the adaptive IMEX method, relative to the target: its error is 0.1 to 30 times the tolerance.
const IMPLICIT: f64 = 0.05;
/// Tolerance of RODAS5P, relative to the target: its error is 10 to 16 times the tolerance on `paper-friction`.
const ROSENBROCK: f64 = 0.02;
/// Largest tolerance at which RODAS5P resolves the friction's ramp: looser ones need more evaluations for less accuracy.
/// Plastic with 0.3 mm of play takes nine times the evaluations at 1e-4, and then fails.
const LOOSEST_ROSENBROCK: f64 = 1e-5;
/// Ratio of the tolerance of the run that verifies a RODAS5P run to that of the RODAS5P run.
pub(crate) const COARSER_ROSENBROCK: f64 = 4.0;
/// Relaxations of friction per radian of the contacts' oscillation up to which the explicit method is cheaper. Explicit steps
/// take about ten evaluations per relaxation. Implicit ones take some 80 per radian at a target of [`TARGET`] on the paper's
/// gear, in proportion to the target's inverse root.
const RELAXATIONS_A_RADIAN: f64 = 8.0;
/// Step of fixed-step methods at [`TARGET`], in radians of the contacts' oscillation.
const RADIANS: f64 = 0.1;
/// Steps of the energy account and first steps, in radians of the contacts' oscillation: 1.1e-5 s for the paper's gear.
const FIRST_RADIANS: f64 = 0.125;
/// Range of useful tolerances.
const TOLERANCES: (f64, f64) = (1e-13, 1e-2);

/// Name of the method for gears without friction.
pub(crate) const EXPONENTIAL: &str = "etd-adams";

/// Settings of one run of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Name of the method.
    pub integrator: &'static str,
    /// Step of fixed-step methods, first step of adaptive ones, s; the energy account has an entry every ten steps.
    pub step_s: f64,
    /// Relative error per step of adaptive methods.
    pub tolerance: f64,
    /// Longest step of adaptive methods, s.
    pub longest_step_s: f64,
    /// Reason for the plan, one sentence.
    pub reason: String,
}

impl Plan {
    /// True if the plan's steps follow from a tolerance.
    pub fn adaptive(&self) -> bool {
        method(self.integrator).is_some_and(|method| method.adaptive)
    }

    /// Returns the family of the plan's method: the way in which it uses the equations.
    pub fn family(&self) -> Option<Family> {
        method(self.integrator).map(|method| method.family)
    }

    /// Returns the value of the setting that determines the plan's steps: a tolerance, or a step, s.
    pub fn value(&self) -> f64 {
        if self.adaptive() {
            self.tolerance
        } else {
            self.step_s
        }
    }

    /// Returns the setting that determines the plan's steps, in words.
    pub fn setting(&self) -> String {
        if self.adaptive() {
            format!("a tolerance of {:.1e}", self.tolerance)
        } else {
            format!("a step of {:.2e} s", self.step_s)
        }
    }

    /// Returns the plan with the setting `factor` times finer (below 1: coarser).
    pub fn finer(&self, factor: f64) -> Self {
        let mut plan = self.clone();
        if plan.adaptive() {
            plan.tolerance = (plan.tolerance / factor).clamp(TOLERANCES.0, TOLERANCES.1);
            // Runs in which the longest step limits all steps would otherwise be identical.
            let power = method(plan.integrator).map_or(0.0, |method| method.step_power);
            plan.longest_step_s /= (self.tolerance / plan.tolerance).powf(power);
        } else {
            plan.step_s /= factor;
        }
        plan
    }

    /// Returns the gearbox with the plan's settings.
    ///
    /// # Errors
    /// Setting that no scene may have.
    pub fn applied(&self, gearbox: &Gearbox) -> Result<Gearbox, GearboxError> {
        let applied = gearbox.with_solver(|solver| {
            self.integrator.clone_into(&mut solver.integrator);
            solver.step_s = self.step_s.min(solver.duration_s);
            solver.tolerance = self.tolerance;
        });
        Ok(applied?)
    }

    /// Returns the gearbox with the plan's settings for a run that only verifies another. If steps end at samples, it has half
    /// as many samples.
    ///
    /// # Errors
    /// Errors of [`applied`](Self::applied).
    pub fn applied_sparsely(&self, gearbox: &Gearbox) -> Result<Gearbox, GearboxError> {
        let applied = self.applied(gearbox)?;
        if self.integrator != EXPONENTIAL {
            return Ok(applied);
        }
        let sparse = applied.with_solver(|solver| {
            solver.step_s = (2.0 * solver.step_s).min(solver.duration_s);
            if 4.0 * solver.sample_s <= solver.duration_s {
                solver.sample_s *= 2.0;
            }
        });
        Ok(sparse?)
    }

    /// Returns the limits of the plan's run.
    pub(crate) fn limits(&self) -> Limits {
        Limits {
            longest_step_s: self.longest_step_s,
            ..Limits::NONE
        }
    }
}

/// Returns the name of the integrator for a scene, with the reason.
pub fn integrator(scene: &Scene) -> (String, String) {
    let named = &scene.solver.integrator;
    if named != AUTO {
        return (named.clone(), "named by the scene".to_owned());
    }
    let plan = plan(scene, TARGET);
    (plan.integrator.to_owned(), plan.reason)
}

/// Returns the plan of a run of a scene with an uncertainty of `target`; the scene's own step and tolerance apply to named
/// methods only.
pub fn plan(scene: &Scene, target: f64) -> Plan {
    Planner::new(scene, target).first()
}

/// Returns the plan and its fallbacks, the best first.
pub fn chain(scene: &Scene, target: f64) -> Vec<Plan> {
    let planner = Planner::new(scene, target);
    let first = planner.first();
    let mut plans = vec![first.clone()];
    let others = [
        planner.implicit("the method before failed: friction implicitly"),
        planner.explicit("the method before failed: order five"),
        planner.fixed(
            "rk4",
            "the methods before failed: order four at a fixed step",
        ),
        planner.fixed(
            "imex2",
            "the methods before failed: friction implicitly at a fixed step",
        ),
    ];
    plans.extend(others.into_iter().filter(|plan| {
        plan.integrator != first.integrator
            && (planner.may_be_implicit() || plan.family() != Some(Family::SplitImplicit))
            && (planner.smooth() || !plan.adaptive())
    }));
    plans
}

struct Planner<'a> {
    scene: &'a Scene,
    target: f64,
    frequencies: Frequencies,
}

impl<'a> Planner<'a> {
    fn new(scene: &'a Scene, target: f64) -> Self {
        Self {
            scene,
            target,
            frequencies: Frequencies::of(scene),
        }
    }

    fn has_friction(&self) -> bool {
        self.scene.slides()
    }

    /// True if bearings or seals reverse, with the input at rest. The Jacobian lacks the friction of sleeves.
    fn reverses(&self) -> bool {
        let scene = self.scene;
        let rolls = scene.sleeve_drag().is_some_and(|drag| drag != [0.0; 2]);
        speed_profile::fastest_rad_s(&scene.drive) == 0.0 && scene.rubs() && !rolls
    }

    /// True if contact forces are smooth; jumps from point to point would only shorten adaptive steps.
    fn smooth(&self) -> bool {
        self.scene.contact.detection == Detection::Exact
    }

    /// True if friction may be implicit; friction that falls with speed gives no convex problem.
    fn may_be_implicit(&self) -> bool {
        self.has_friction() && self.scene.contact.friction_law == FrictionLaw::Regularised
    }

    fn first(&self) -> Plan {
        // Only the reduced form has a Jacobian in closed form; without it a Rosenbrock step costs ten times as much.
        let is_reduced = self.scene.solver.formulation == Formulation::Reduced;
        let Frequencies {
            contact_rad_s: contact,
            friction_1_s: rate,
            ..
        } = self.frequencies;
        if !self.smooth() {
            let reason = "forces that jump from point to point have no high order and would only shorten \
                          adaptive steps";
            return if self.may_be_implicit() {
                self.fixed("imex2", &format!("{reason}; friction implicitly"))
            } else {
                self.fixed("rk4", reason)
            };
        }
        if !self.has_friction() {
            return if is_reduced && self.reverses() {
                self.rosenbrock(
                    "with the input at rest parts that rub reverse: implicitly to order five, by the exact Jacobian",
                )
            } else if is_reduced {
                self.exponential()
            } else {
                self.explicit(&format!(
                    "without friction the forces are smooth between contacts: order five with steps from a tolerance, \
                     on oscillations of {:.0} Hz",
                    contact / std::f64::consts::TAU
                ))
            };
        }
        let most = RELAXATIONS_A_RADIAN * contact * (TARGET / self.target).sqrt();
        if !self.may_be_implicit() {
            self.explicit(
                "friction that falls with speed is no convex problem, so it is followed explicitly, with steps from a \
                 tolerance",
            )
        } else if rate <= most {
            self.explicit(&format!(
                "friction relaxes the pins' spins at about {rate:.1e} 1/s, {:.0} times in a radian of the contacts' \
                 oscillation: cheaper to follow than to solve",
                rate / contact
            ))
        } else {
            let relaxes = format!(
                "friction relaxes the pins' spins at about {rate:.1e} 1/s, {:.0e} times in a radian of the contacts' oscillation",
                rate / contact
            );
            match is_reduced {
                true => self.rosenbrock(&format!(
                    "{relaxes}: implicitly to order five, by the exact Jacobian"
                )),
                false => self.implicit(&format!(
                    "{relaxes}: implicitly, with steps from a tolerance"
                )),
            }
        }
    }

    /// Returns the plan of the exponential method. On 60 random gears and ten presets at tolerances of 1e-4 to 1e-9 it took 0.2
    /// to 0.8 of the evaluations of Dormand-Prince for equal errors, for runs of any length.
    fn exponential(&self) -> Plan {
        let (solver, contact) = (&self.scene.solver, self.frequencies.contact_rad_s);
        let samples = solver.duration_s / solver.sample_s;
        let [radians, touches] =
            [contact, self.frequencies.touch_rad_s].map(|rate| solver.duration_s * rate);
        let reason = format!(
            "without friction discs and output are oscillators, to {:.0} Hz, which the exact Jacobian describes: about {:.0e} \
             evaluations, one a step and sample, where dopri5 would take {:.0e}",
            contact / std::f64::consts::TAU,
            samples.max(touches / EXPONENTIAL_STEP),
            samples + 6.0 * radians,
        );
        let plan = Plan {
            // Bearings are always engaged, and the method is exact for them.
            step_s: FIRST_RADIANS / self.frequencies.touch_rad_s,
            ..self.plan(EXPONENTIAL, SMOOTH * self.twist(), &reason)
        };
        // The method's steps end at every sample, so a longer bound would have no effect.
        let count = EnergyAccount::between(0.0, solver.sample_s, plan.step_s, 1).count() + 1;
        let longest = EXPONENTIAL_STEP * plan.longest_step_s;
        Plan {
            longest_step_s: longest.min(solver.sample_s / count as f64),
            ..plan
        }
    }

    fn explicit(&self, reason: &str) -> Plan {
        let share = if self.has_friction() { RUBBING } else { SMOOTH };
        self.plan("dopri5", share * self.twist(), reason)
    }

    /// Returns the factor on the tolerance for laws stiffer than Hertz's: their twist is smaller than the scale of errors.
    fn twist(&self) -> f64 {
        Frequencies::depth_share(self.scene).min(1.0)
    }

    fn rosenbrock(&self, reason: &str) -> Plan {
        let plan = self.plan("rodas5p", ROSENBROCK, reason);
        // With looser tolerances the method jumps back and forth over the friction's ramp, and so does the coarser run that
        // verifies it.
        Plan {
            tolerance: plan.tolerance.min(LOOSEST_ROSENBROCK / COARSER_ROSENBROCK),
            ..plan
        }
    }

    fn implicit(&self, reason: &str) -> Plan {
        self.plan("imex2-adaptive", IMPLICIT, reason)
    }

    fn fixed(&self, integrator: &'static str, reason: &str) -> Plan {
        // Order two is assumed, the order of any method under forces with kinks.
        let radians = RADIANS * (self.target / TARGET).sqrt();
        Plan {
            step_s: radians / self.frequencies.contact_rad_s,
            ..self.plan(integrator, SMOOTH, reason)
        }
    }

    fn plan(&self, integrator: &'static str, share: f64, reason: &str) -> Plan {
        Plan {
            integrator,
            step_s: FIRST_RADIANS / self.frequencies.contact_rad_s,
            tolerance: (share * self.target).max(TOLERANCES.0),
            longest_step_s: self.frequencies.longest_step_s(),
            reason: reason.to_owned(),
        }
    }
}
