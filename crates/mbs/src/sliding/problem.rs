//! Implicit regularised Coulomb friction as a minimisation.
//!
//! ```text
//! minimise over v:  1/2 (v - v*)' M (v - v*) + a sum_c L_c v_s H(u_c / v_s),   u_c = offset_c + J_c v
//! H(x) = x^2/2 for |x| <= 1, |x| - 1/2 beyond (Huber)
//! ```
//! Stationarity is the implicit step: `M (v - v*) = -a sum J' L clamp(u/v_s, -1, 1)`. The function is strictly convex and
//! piecewise quadratic. A Newton step after which every contact sticks or slides as before therefore reaches the minimum
//! exactly. A line search makes the earlier steps descend ([Qi, Sun 1993], [Hintermueller, Ito, Kunisch 2002] for the
//! semi-smooth Newton method).

use super::arrowhead::Arrowhead;
use super::contact::Row;

/// Contact of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// Sliding speed u as a function of the velocities.
    pub rate: Row,
    /// Friction limit L = mu F_n >= 0, N.
    pub limit: f64,
    /// Ramp speed v_s > 0, m/s.
    pub ramp: f64,
}

impl Slip {
    /// Returns the friction against the sliding at `u`, N: L clamp(u/v_s, -1, 1).
    #[inline]
    pub fn force(&self, u: f64) -> f64 {
        self.limit * (u / self.ramp).clamp(-1.0, 1.0)
    }

    /// Returns -1, 0, 1 for sliding backwards, sticking, sliding forwards.
    #[inline]
    fn state(&self, u: f64) -> i8 {
        if u > self.ramp {
            1
        } else if u < -self.ramp {
            -1
        } else {
            0
        }
    }
}

/// Largest number of Newton steps. A gear takes 1 to 4; random problems with inertias 1 : 1e6 up to 100.
const MOST_STEPS: usize = 1000;
/// Ratio of the slope to that at the start of a step at which a line search ends.
const SLOPE_SHARE: f64 = 0.1;
/// Largest change of a sliding speed at convergence, relative to its ramp, including rounding of the last step.
const RATE_SHARE: f64 = 1e-10;
/// Change of a velocity at convergence by rounding alone: a narrow ramp may require more digits than a double has.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Minimisation with its memory.
#[derive(Debug, Clone)]
pub struct SlidingProblem {
    matrix: Arrowhead,
    inertia: Vec<f64>,
    step: Vec<f64>,
    /// Rate and change of rate of every contact.
    rates: Vec<[f64; 2]>,
}

impl SlidingProblem {
    /// Creates a problem. `inertia`: diagonal of M, all positive. `is_leaf`: velocities of which no contact joins two.
    pub fn new(inertia: Vec<f64>, is_leaf: &[bool]) -> Self {
        Self {
            matrix: Arrowhead::new(is_leaf),
            step: vec![0.0; inertia.len()],
            rates: Vec::new(),
            inertia,
        }
    }

    /// Returns the diagonal of M.
    pub fn inertia(&self) -> &[f64] {
        &self.inertia
    }

    /// Minimises for the target velocities `target` and the time `a` (s); `v` is a first estimate and becomes the minimum.
    /// Returns the number of Newton steps; `None` if a value is not finite or a contact joins two leaves.
    pub fn solve(
        &mut self,
        a: f64,
        slips: &[Slip],
        target: &[f64],
        v: &mut [f64],
    ) -> Option<usize> {
        if slips.is_empty() {
            v.copy_from_slice(target);
            return Some(0);
        }
        self.rates.clear();
        self.rates
            .extend(slips.iter().map(|slip| [slip.rate.value(v), 0.0]));
        for step in 1..=MOST_STEPS {
            self.newton_step(a, slips, target, v)?;
            if self.step_is_rounding(target, v) {
                return Some(step);
            }
            for (rate, slip) in self.rates.iter_mut().zip(slips) {
                rate[1] = slip.rate.dot(&self.step);
            }
            let share = self.line_search(a, slips, target, v)?;
            for (v, d) in v.iter_mut().zip(&self.step) {
                *v += share * d;
            }
            let mut settled = share == 1.0;
            for (rate, slip) in self.rates.iter_mut().zip(slips) {
                let before = rate[0];
                rate[0] = slip.rate.value(v);
                let (moved, digits) = ((rate[0] - before).abs(), RATE_SHARE * slip.ramp);
                let same =
                    slip.state(before) == slip.state(rate[0]) && f64::EPSILON * moved <= digits;
                settled &= same || moved <= digits;
            }
            if settled {
                return Some(step);
            }
        }
        None
    }

    /// Solves H step = -gradient at `v`.
    fn newton_step(&mut self, a: f64, slips: &[Slip], target: &[f64], v: &[f64]) -> Option<()> {
        self.matrix.reset(&self.inertia);
        for (k, step) in self.step.iter_mut().enumerate() {
            *step = -self.inertia[k] * (v[k] - target[k]);
        }
        for (slip, &[u, _]) in slips.iter().zip(&self.rates) {
            slip.rate.add_to(-a * slip.force(u), &mut self.step);
            if slip.state(u) == 0 && !self.matrix.add(a * slip.limit / slip.ramp, &slip.rate) {
                return None;
            }
        }
        self.matrix.solve(&mut self.step);
        self.step.iter().all(|x| x.is_finite()).then_some(())
    }

    fn step_is_rounding(&self, target: &[f64], v: &[f64]) -> bool {
        let mut sizes = v.iter().zip(target).zip(&self.step);
        sizes.all(|((v, target), d)| d.abs() <= ROUNDING * (v.abs() + target.abs()))
    }

    /// Returns the derivative of the function along the step, at the fraction `s` of it.
    fn slope(&self, a: f64, slips: &[Slip], target: &[f64], v: &[f64], s: f64) -> f64 {
        let kinetic: f64 = (0..v.len())
            .map(|k| self.inertia[k] * (v[k] + s * self.step[k] - target[k]) * self.step[k])
            .sum();
        let powers = slips.iter().zip(&self.rates);
        let powers = powers.map(|(slip, &[u, du])| slip.force(u + s * du) * du);
        kinetic + a * powers.sum::<f64>()
    }

    /// Returns the fraction of the step to take: 1 where the function still falls there, else near the minimum along it.
    fn line_search(&self, a: f64, slips: &[Slip], target: &[f64], v: &[f64]) -> Option<f64> {
        let slope = |s| self.slope(a, slips, target, v, s);
        let (start, end) = (slope(0.0), slope(1.0));
        if !(start.is_finite() && end.is_finite()) {
            return None;
        }
        let enough = SLOPE_SHARE * start.abs();
        if end <= enough {
            return Some(1.0);
        }
        // The slope rises along the step and changes sign: regula falsi, halved where it stalls (Illinois).
        let (mut low, mut high) = ((0.0, start), (1.0, end));
        for _ in 0..60 {
            let s = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
            if !(s > 0.0 && s < 1.0) {
                break;
            }
            let here = slope(s);
            if here.abs() <= enough {
                return Some(s);
            }
            if here < 0.0 {
                low = (s, here);
                high.1 *= 0.5;
            } else {
                high = (s, here);
                low.1 *= 0.5;
            }
        }
        Some(0.5 * (low.0 + high.0))
    }
}
