//! Newton's method of a balance: quasi-Newton steps, and a descent along the work of forces where these fail.
//!
//! Each step updates the inverse of the Jacobian from the change of the residual (C. G. Broyden, Math. Comp. 19, 1965,
//! 577-593). Derivatives are evaluated anew only where steps gain too little. The inverse at a balance serves the next pose.

use nalgebra::{DMatrix, DVector};

use super::Statics;
use super::problem::{Balanced, Free, LEFT, Problem, TRACKED};

/// Largest numbers of Newton steps and of halvings of one step.
const STEPS: usize = 60;
const HALVINGS: usize = 12;
/// Expected number of further steps, at the rate of the last one, up to which the inverse is reused, for places and for
/// angles. New derivatives cost as much.
const SERVES: f64 = 8.0;
const SERVES_ANGLES: f64 = 5.0;
/// Largest ratio of residuals after and before a step at which a tracked balance takes the next one without evaluating its
/// residual, if it would reach the goal at this rate, and the largest length of that step, relative to the contacts' depths
/// and twists.
const SURE: f64 = 0.1;
const UNSEEN: f64 = 1e-5;
/// Length of steps of discs on eccentrics and output, relative to the twists of contacts, at which no contact restores them:
/// Newton's method is abandoned.
const LOST: f64 = 1e5;
/// Largest ratio of residuals after and before a step with fresh derivatives at which that step counts as progress.
const SLOW: f64 = 0.9;
/// Largest number of steps of the search for the point where forces do no work along a step, and the work that may remain
/// there.
const WORKS: usize = 40;
const WORK: f64 = 0.1;
/// Largest length of such a step, relative to the range in which the mesh restores.
const FARTHEST: f64 = 0.1;
/// Residual up to which rounding of stiff contacts is accepted, if a Newton step moves the balance by no more than `STILL`,
/// relative to the contacts' depths and twists.
const ROUNDED: f64 = 1e-7;
const STILL: f64 = 1e-8;
/// Residual at which Newton's method ends as soon as a step gains nothing.
const BALANCED: f64 = 1e-10;
/// Weak spring to the last iterate, relative to a contact's stiffness, for directions without stiffness.
const WEAK: f64 = 1e-9;
/// Springs to the last iterate where a gear snaps through, relative to a contact's stiffness. The weakest that succeeds is
/// taken.
const HOLDS: [f64; 6] = [WEAK, 1e-2, 0.1, 1.0, 10.0, 100.0];
/// Ratios of successive steps of a disc on its eccentric that is idle: it will carry nothing. Under a force like delta^n,
/// steps shrink by the ratio 1 - 1/n without end. Exponents n of the laws are 10/9 to 5/2.
const IDLE: std::ops::Range<f64> = 0.05..0.75;
/// Largest step of the output, relative to the disc's, at which a disc may be idle.
const ALONE: f64 = 1e-3;
/// Overshoot factor of an idle disc: it is turned to the limit of its steps and slightly beyond, so that it touches nothing.
const BEYOND: f64 = 1.001;

fn beyond(u: &[f64], share: f64, step: &DVector<f64>) -> Vec<f64> {
    u.iter().zip(step).map(|(u, s)| u + share * s).collect()
}

/// Updates the inverse by Broyden's formula from `share` of a step and the change of the residual that it made.
pub(super) fn update(
    inverse: &mut DMatrix<f64>,
    share: f64,
    step: &DVector<f64>,
    change: &DVector<f64>,
) {
    let row = inverse.tr_mul(step);
    let over = row.dot(change);
    if over != 0.0 {
        let mut gain = &*inverse * change;
        gain.axpy(share, step, -1.0);
        inverse.ger(over.recip(), &gain, &row, 1.0);
    }
}

/// Lengthens the steps of idle discs, which will carry nothing.
fn release_idle(step: &mut DVector<f64>, last: &mut DVector<f64>) {
    let output = step[0].abs();
    for (turn, last) in step.iter_mut().zip(last).skip(1) {
        let left = *turn / *last;
        *last = *turn;
        if IDLE.contains(&left) && output < ALONE * turn.abs() {
            *turn *= BEYOND / (1.0 - left);
        }
    }
}

impl Statics<'_> {
    /// Solves by Newton's method with halved steps from `u`, starting with the `inverse` of a near balance if there is one.
    /// `None` without progress, or if teeth have jumped.
    pub(super) fn newton(
        &mut self,
        problem: &Problem,
        u: &mut Vec<f64>,
        mut inverse: Option<DMatrix<f64>>,
    ) -> Option<Balanced> {
        let mut here = self.residual(problem, u);
        let mut most = problem.unbalanced(&here);
        let serves = match problem.free {
            Free::Places => SERVES,
            _ => SERVES_ANGLES,
        };
        let mut last = DVector::zeros(u.len());
        for _ in 0..STEPS {
            if most < problem.goal {
                break;
            }
            let is_fresh = inverse.is_none();
            if is_fresh {
                let jacobian = self.jacobian(problem, u, &here)?;
                inverse = problem.held(jacobian, WEAK).try_inverse();
            }
            let mut step = -(inverse.as_ref()? * &here);
            if problem.free == Free::Angles {
                release_idle(&mut step, &mut last);
            }
            if problem.free != Free::Places && problem.moved(step.iter().copied()) > LOST {
                return None;
            }
            let mut share = self.farthest(problem, &step);
            let before = most;
            // Near a balance only rounding remains, and shorter steps do not reduce it.
            let tries = if is_fresh && most > LEFT { HALVINGS } else { 1 };
            for _ in 0..tries {
                let there = beyond(u, share, &step);
                let left = self.residual(problem, &there);
                let now = problem.unbalanced(&left);
                if now < most {
                    if let Some(inverse) = &mut inverse {
                        update(inverse, share, &step, &(&left - &here));
                    }
                    (*u, here, most) = (there, left, now);
                    break;
                }
                share *= 0.5;
            }
            let rate = most / before;
            if problem.goal >= TRACKED && rate < SURE && rate * most < problem.goal {
                let step = -(inverse.as_ref()? * &here);
                // A disc in its clearance moves far under nearly no force, and may touch there.
                if problem.moved(step.iter().copied()) < UNSEEN {
                    *u = beyond(u, 1.0, &step);
                    most *= rate;
                    here *= rate;
                    break;
                }
            }
            let left = (most / problem.goal).ln() / -rate.ln();
            if rate >= 1.0 || left > serves {
                if most < BALANCED {
                    break;
                }
                inverse = None;
                let stuck = most > SLOW * before;
                if is_fresh && stuck {
                    let is_still = problem.moved(step.iter().copied()) <= STILL && most <= ROUNDED;
                    if most < LEFT || is_still {
                        most = 0.0;
                        break;
                    }
                    *u = self.downhill(problem, (u, &here))?;
                    here = self.residual(problem, u);
                    most = problem.unbalanced(&here);
                }
            }
        }
        let holds = (u[0] - problem.ideal).abs() <= problem.reach;
        (most < LEFT && holds).then_some((here, inverse))
    }

    /// Returns the largest share of a step that stays away from another tooth: without stiffness, steps have no bounds of their
    /// own.
    fn farthest(&self, problem: &Problem, step: &DVector<f64>) -> f64 {
        let angle = FARTHEST * self.brackets().1;
        let lever = self.gearbox.scene.gear.lever_m();
        let shares = step.iter().enumerate().map(|(k, step)| {
            let far = match problem.is_length(k) {
                true => angle * lever,
                false => angle,
            };
            far / step.abs()
        });
        shares.fold(1.0, f64::min)
    }

    /// Moves from `u` to the point where forces do almost no more work along a Newton step. Contacts that open and close on the
    /// way may increase the residual, which Newton's method alone would never accept. Where the gear snaps through, and a step
    /// would be against the forces, springs to `u` restrain it.
    fn downhill(
        &mut self,
        problem: &Problem,
        (u, here): (&[f64], &DVector<f64>),
    ) -> Option<Vec<f64>> {
        let jacobian = self.jacobian(problem, u, here)?;
        let step = HOLDS.iter().find_map(|&hold| {
            let step = -problem.held(jacobian.clone(), hold).lu().solve(here)?;
            (here.dot(&step) > 0.0).then_some(step)
        })?;
        // The search passes through free play up to the next contact, but not over a tooth.
        let farthest = self.farthest(problem, &step);
        let (mut low, mut high) = (0.0, farthest);
        let mut share = f64::min(farthest, 1.0 / problem.moved(step.iter().copied()));
        let mut caught = false;
        for _ in 0..WORKS {
            let work = self.residual(problem, &beyond(u, share, &step)).dot(&step);
            caught |= work <= 0.0;
            match work > 0.0 {
                true => low = share,
                false => high = share,
            }
            if work.abs() <= WORK * here.dot(&step) || low == farthest {
                break;
            }
            share = match caught {
                true => 0.5 * (low + high),
                false => f64::min(2.0 * share, farthest),
            };
        }
        Some(beyond(u, share, &step))
    }
}
