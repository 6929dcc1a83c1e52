//! Points of a multistep method, the linear part to which their remainders refer, and the matrices of steps.

use serde::{Deserialize, Serialize};

use super::columns::{Columns, padded};
use super::history::{History, Line, step_back, to_differences};
use super::propagator::{Linear, Propagator};
use crate::OdeSystem;
use crate::jacobian::Jacobian;
use crate::lu::Lu;

/// Orders K: the lower for intervals with opening and closing contacts, the higher for smooth ones; each step takes the one
/// with the smaller error.
pub(super) const ORDERS: [usize; 2] = [3, 5];
const HIGHEST: usize = ORDERS[1];
/// Number of coefficients of polynomials through the points of the highest order and one more.
pub(super) const TERMS: usize = HIGHEST + 2;
/// Relative difference below which two lengths, or two times in a step, are equal.
pub(super) const SAME: f64 = 1e-9;
/// Number of stored step matrices: steps alternate between few lengths.
const KEPT: usize = 4;

/// Matrices of a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Step {
    /// Propagator of x and of the differences.
    pub(super) propagator: Propagator,
    /// Error matrices by order: h (Gamma_K+1 - Gamma_K), states by remainders.
    pub(super) errors: [Columns; 2],
}

/// Data of the method, available once the system has provided its Jacobian.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Multistep {
    pub(super) jacobian: Jacobian,
    pub(super) linear: Linear,
    /// Newer linear part, for comparison with the present one.
    pub(super) newer: Linear,
    pub(super) line: Line,
    pub(super) history: History,
    pub(super) steps: Vec<Step>,
    /// Indices of the step that was built last, and of the step that was used last.
    pub(super) last_built: usize,
    pub(super) last: usize,
    /// Propagator to times inside steps.
    pub(super) between: Propagator,
    /// Factors of the propagator's matrix of a state.
    back: Lu,
    /// State x, then coefficients of the remainder.
    pub(super) known: Vec<f64>,
    /// State x, padded.
    pub(super) x: Vec<f64>,
    /// Product L x, padded.
    pub(super) product: Vec<f64>,
}

impl Multistep {
    pub(super) fn new(system: &dyn OdeSystem, jacobian: Jacobian, y: &[f64]) -> Self {
        let n = y.len();
        let mut scale = vec![0.0; n];
        system.scale(y, &mut scale);
        let linear = Linear::new(&system.structure(), &scale);
        let count = linear.remainders();
        let error = Columns::zero(n, count);
        let step = Step {
            propagator: Propagator::new(&linear, TERMS),
            errors: [error.clone(), error],
        };
        Self {
            jacobian,
            newer: linear.clone(),
            line: Line::new(n),
            history: History::new(&linear, 2 * HIGHEST + 3, TERMS),
            steps: vec![step; KEPT],
            last_built: 0,
            last: 0,
            between: Propagator::new(&linear, TERMS),
            back: Lu::new(n),
            known: vec![0.0; n + TERMS * count],
            x: vec![0.0; padded(n)],
            product: vec![0.0; padded(count)],
            linear,
        }
    }

    /// Computes the remainders of all points with the present linear part; the newest point is at `time`.
    pub(super) fn set_remainders(&mut self, time: f64, h: f64) {
        self.history.change();
        for k in 0..self.history.count {
            let point = &mut self.history.points[k];
            self.line
                .measure(time - k as f64 * h, &point.y, &mut self.x);
            self.linear.product(&self.x, &mut self.product);
            point.set_remainder(&self.product);
        }
    }

    /// Takes the newest Jacobian as the linear part, with the line through `y`.
    pub(super) fn renew(&mut self, time: f64, h: f64, y: &[f64]) {
        std::mem::swap(&mut self.linear, &mut self.newer);
        self.line.set(&self.linear, time, y);
        self.set_remainders(time, h);
        for step in &mut self.steps {
            step.propagator.tau = f64::NAN;
        }
    }

    /// Returns the index of the matrices of a step `h`, built if they are not stored.
    pub(super) fn matrices(&mut self, h: f64) -> usize {
        let is_of = |step: &Step| (step.propagator.tau - h).abs() <= SAME * h;
        if is_of(&self.steps[self.last]) {
            return self.last;
        }
        if let Some(k) = self.steps.iter().position(is_of) {
            self.last = k;
            return k;
        }
        self.last_built = (self.last_built + 1) % KEPT;
        let step = &mut self.steps[self.last_built];
        step.propagator.build(&self.linear, h, h);
        for (&order, error) in ORDERS.iter().zip(&mut step.errors) {
            step.propagator
                .difference_of_terms(&self.linear, order, error);
        }
        self.last = self.last_built;
        self.last_built
    }

    /// Writes the state at `time` + `tau` from `y` at `time`, with the remainder of the stored points.
    pub(super) fn state_at(&mut self, time: f64, y: &[f64], h: f64, tau: f64, out: &mut [f64]) {
        let count = self.history.count.min(TERMS);
        self.history.differ(count);
        self.line.measure(time, y, self.history.x_mut());
        self.between.build(&self.linear, tau, h);
        self.between.advance(self.history.known(count), &mut self.x);
        out.copy_from_slice(&self.x[..self.linear.dimension]);
        self.line.restore(time + tau, out);
    }

    /// Reduces the distance of the points from `h` to `to` without evaluations: the remainder is interpolated, and the states
    /// are those from which steps lead to `y` at `time`. Returns false if there are none.
    pub(super) fn respace(&mut self, time: f64, y: &[f64], h: f64, to: f64) -> bool {
        let (n, width) = (self.linear.dimension, self.linear.remainders());
        let count = self.history.count.min(TERMS);
        self.history.differ(count);
        let matrices = self.matrices(to);
        let propagator = &self.steps[matrices].propagator;
        if !propagator.factor(&self.linear, &mut self.back) {
            return false;
        }
        let (x, differences) = self.known[..n + count * width].split_at_mut(n);
        self.line.measure(time, y, x);
        self.history.coefficients(count, differences);
        to_differences(differences, width, to / h);
        for k in 1..count.min(HIGHEST + 1) {
            step_back(differences, width);
            propagator.retreat(&self.back, differences, x, &mut self.x);
            let point = &mut self.history.points[k];
            point.g[..width].copy_from_slice(&differences[..width]);
            self.linear.product(x, &mut point.f);
            for (f, g) in point.f.iter_mut().zip(&point.g) {
                *f += g;
            }
            point.y[..n].copy_from_slice(x);
            self.line.restore(time - k as f64 * to, &mut point.y);
        }
        self.history.change();
        self.history.count = count.min(HIGHEST + 1);
        true
    }
}
