//! The way to a balance: a quasi-Newton method, and down the work of forces where it leads nowhere.
//!
//! Each step updates the inverse of the Jacobian by what the residual did (C. G. Broyden, Math. Comp. 19, 1965, 577-593), so that
//! derivatives are evaluated anew only where steps gain too little. A balance hands its inverse on to the next pose.

use nalgebra::{DMatrix, DVector};

use super::Statics;
use super::problem::{Balanced, Free, LEFT, Problem};

/// Newton steps at most, halvings of one, and the residual that a step must leave at most for the inverse to serve the next.
const STEPS: usize = 60;
const HALVINGS: usize = 12;
const SERVES: f64 = 0.3;
const SERVES_ANGLES: f64 = 0.1;
/// Steps of discs on eccentrics and output, in the twists of contacts, from which on nothing holds them: they begin afresh.
const LOST: f64 = 1e5;
/// Largest ratio of residuals after and before a step with fresh derivatives at which that step counts as progress.
const SLOW: f64 = 0.9;
/// Steps at most of a search for where forces do no work along a step, and what may be left of it.
const WORKS: usize = 40;
const WORK: f64 = 0.1;
/// Most of the way over which the mesh holds that such a step may take.
const FARTHEST: f64 = 0.1;
/// Where rounding of stiff contacts leaves more, up to this, a balance is one that a Newton step moves by no more than such a share
/// of the contacts' depths and twists.
const ROUNDED: f64 = 1e-7;
const STILL: f64 = 1e-8;
/// Newton goes on down to the first, and below the second as long as it gains.
const GOAL: f64 = 1e-12;
const BALANCED: f64 = 1e-10;
/// A weak spring to the last iterate, as a share of a contact's stiffness: for directions that nothing holds.
const WEAK: f64 = 1e-9;
/// Springs to the last iterate where a gear snaps through, as shares of a contact's stiffness. The weakest that works
/// is taken.
const HOLDS: [f64; 6] = [WEAK, 1e-2, 0.1, 1.0, 10.0, 100.0];
/// Share of a step in the one before by which a disc on its eccentric gives itself away that will carry nothing: a force like delta^n
/// falls to it by 1 - 1/n a step, for as long as one likes. Of the laws n is from 10/9 to 5/2.
const IDLE: std::ops::Range<f64> = 0.05..0.75;
/// The output then moves less than this of what the disc does.
const ALONE: f64 = 1e-3;
/// Such a disc is turned to where its steps lead together, and by this more, so that it touches nothing.
const BEYOND: f64 = 1.001;

fn beyond(u: &[f64], share: f64, step: &DVector<f64>) -> Vec<f64> {
    u.iter().zip(step).map(|(u, s)| u + share * s).collect()
}

/// Broyden's update of an inverse by a step and the change of the residual that it made.
fn update(inverse: &mut DMatrix<f64>, step: &DVector<f64>, change: &DVector<f64>) {
    let expected = &*inverse * change;
    let row = inverse.tr_mul(step);
    let over = row.dot(change);
    if over != 0.0 {
        inverse.ger(over.recip(), &(step - expected), &row, 1.0);
    }
}

/// Lengthens the steps of discs that will carry nothing.
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
    /// Newton's method from `u`, with halved steps, beginning with an `inverse` of a near balance if there is one. `None` where it got
    /// stuck, or where teeth have jumped.
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
            if most < GOAL {
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
            if problem.free != Free::Places && problem.moved(&step) > LOST {
                return None;
            }
            let mut share = self.farthest(problem, &step);
            let before = most;
            // What is left at a balance is rounding, which no shorter step betters.
            let tries = if is_fresh && most > LEFT { HALVINGS } else { 1 };
            for _ in 0..tries {
                let there = beyond(u, share, &step);
                let left = self.residual(problem, &there);
                let now = problem.unbalanced(&left);
                if now < most {
                    if let Some(inverse) = &mut inverse {
                        update(inverse, &(share * &step), &(&left - &here));
                    }
                    (*u, here, most) = (there, left, now);
                    break;
                }
                share *= 0.5;
            }
            if most > serves * before {
                if most < BALANCED {
                    break;
                }
                inverse = None;
                let stuck = most > SLOW * before;
                if is_fresh && stuck {
                    let is_still = problem.moved(&step) <= STILL && most <= ROUNDED;
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

    /// The share of a step that leads nowhere near another tooth: where nothing holds, steps have no bounds of their own.
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

    /// From `u` to where forces do next to no more work along a Newton step: contacts that open and close on the way leave more than
    /// before, by which Newton's method alone would never get past them. Where the gear snaps through, and a step would be against
    /// the forces, springs to `u` hold it.
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
        // Through free play as far as something holds, and not beyond it, nor over a tooth.
        let farthest = self.farthest(problem, &step);
        let (mut low, mut high) = (0.0, farthest);
        let mut share = f64::min(farthest, 1.0 / problem.moved(&step));
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
