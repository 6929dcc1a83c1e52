//! Balances on rigid bearings by nested brackets, where contacts have no derivatives.
//!
//! Contacts restore, so M_i falls with theta_i, and with the discs in balance M_out falls with psi. The balance is two nested
//! roots of falling functions, each bracketed. Brackets need no good start and cope with backlash, where all moments are 0 over
//! the free play.

use nalgebra::DVector;

use super::problem::Problem;
use super::{Equilibrium, Statics};
use crate::GearboxError;

/// Tolerance of angles, rad: 1e-14 rad on a radius of 64 mm is 1e-11 of a penetration.
const ANGLE: f64 = 2e-15;
/// Largest number of steps of one root.
const STEPS: usize = 200;
/// Difference steps, rad: of the discs' angles, and of the output's angle with the discs in balance.
const OF_DISCS: f64 = 1e-9;
const OF_OUTPUT: f64 = 1e-8;

/// Root of a falling function with its bracket.
#[derive(Clone, Copy)]
struct Root {
    low: f64,
    high: f64,
    at: f64,
    /// Length of the last step.
    last: f64,
}

impl Root {
    fn about(middle: f64, half: f64, at: f64) -> Self {
        let (low, high) = (middle - half, middle + half);
        Self {
            low,
            high,
            at: at.clamp(low, high),
            last: f64::INFINITY,
        }
    }

    /// Moves to the next estimate from the value `here` of the function, which is not 0, and its slope. Newton's step is taken
    /// where it stays inside the bracket and is less than half of the last one, else the middle.
    fn step(&mut self, here: f64, slope: f64) {
        *(if here > 0.0 {
            &mut self.low
        } else {
            &mut self.high
        }) = self.at;
        let newton = self.at - here / slope;
        let inside = newton > self.low && newton < self.high;
        let next = match slope < 0.0 && inside && (newton - self.at).abs() < 0.5 * self.last {
            true => newton,
            false => 0.5 * (self.low + self.high),
        };
        (self.last, self.at) = ((next - self.at).abs(), next);
    }
}

impl Statics<'_> {
    /// Balances the discs for the output at `u[0]`, and returns the residual, in which the output's moment remains.
    fn balance_discs(&mut self, problem: &Problem, u: &mut [f64]) -> DVector<f64> {
        let half = self.brackets().0;
        let ideal = self.ideal(problem.free, problem.phi);
        let middles = ideal[1..].iter().zip(&u[1..]);
        let mut roots: Vec<Root> = middles.map(|(m, at)| Root::about(*m, half, *at)).collect();
        let mut beside = u.to_vec();
        for _ in 0..STEPS {
            for (at, root) in u[1..].iter_mut().zip(&roots) {
                *at = root.at;
            }
            let here = self.residual(problem, u);
            if roots.iter().all(|root| root.last < ANGLE) {
                return here;
            }
            for (beside, at) in beside[1..].iter_mut().zip(&u[1..]) {
                *beside = at + OF_DISCS;
            }
            beside[0] = u[0];
            let there = self.residual(problem, &beside);
            for (k, root) in roots.iter_mut().enumerate() {
                match here[k + 1] == 0.0 {
                    true => root.last = 0.0,
                    false => root.step(here[k + 1], (there[k + 1] - here[k + 1]) / OF_DISCS),
                }
            }
        }
        self.residual(problem, u)
    }

    /// Solves the equilibrium by brackets alone, with hundreds of times the evaluations. It is the reference for Newton's
    /// method.
    ///
    /// # Errors
    /// Errors of [`Statics::solve`].
    pub fn solve_by_brackets(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let problem = self.problem(phi, load, &self.rigid);
        let ideal = self.ideal(problem.free, phi);
        let mut root = Root::about(problem.ideal, problem.reach, problem.ideal);
        for (end, sign) in [(root.low, 1.0), (root.high, -1.0)] {
            let mut u = ideal.clone();
            u[0] = end;
            if self.balance_discs(&problem, &mut u)[0] * sign < 0.0 {
                return Err(GearboxError::NoEquilibrium { load_n_m: load });
            }
        }
        let mut u = ideal;
        for _ in 0..STEPS {
            u[0] = root.at;
            let here = self.balance_discs(&problem, &mut u)[0];
            if here == 0.0 || root.last < ANGLE {
                break;
            }
            let mut beside = u.clone();
            beside[0] += OF_OUTPUT;
            let there = self.balance_discs(&problem, &mut beside)[0];
            root.step(here, (there - here) / OF_OUTPUT);
        }
        let left = self.residual(&problem, &u);
        Ok(self.equilibrium(&problem, &u, (left, None)))
    }
}
