//! What a multistep method remembers: equally spaced states, f there, and the remainder beside the linear part.

use serde::{Deserialize, Serialize};

use super::propagator::Linear;

/// Backward differences become coefficients of powers: `s (s + 1) ... (s + j - 1)/j! = sum_k powers[j][k] s^k/k!`.
const fn powers() -> [[f64; MOST]; MOST] {
    let mut out = [[0.0; MOST]; MOST];
    out[0][0] = 1.0;
    let mut j = 1;
    while j < MOST {
        // Times (s + j - 1)/j; s times s^k/k! is (k + 1) s^(k+1)/(k+1)!.
        let mut k = 0;
        while k < j {
            out[j][k] += out[j - 1][k] * (j - 1) as f64 / j as f64;
            out[j][k + 1] += out[j - 1][k] * (k + 1) as f64 / j as f64;
            k += 1;
        }
        j += 1;
    }
    out
}

/// Differences at most.
pub(super) const MOST: usize = 9;
pub(super) const POWERS: [[f64; MOST]; MOST] = powers();

/// The straight line that states are measured from: `x = y - origin - rate (t - time)`.
///
/// Angles grow without bound while what is elastic of them stays small; the line keeps the digits.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Line {
    time: f64,
    origin: Vec<f64>,
    rate: Vec<f64>,
}

impl Line {
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            time: 0.0,
            origin: vec![0.0; dimension],
            rate: vec![0.0; dimension],
        }
    }

    /// Through `y` at `time`; positions move with their rates.
    pub(super) fn set(&mut self, linear: &Linear, time: f64, y: &[f64]) {
        self.time = time;
        self.origin.copy_from_slice(y);
        let (first, count) = (linear.first, linear.first.min(linear.remainders()));
        self.rate[..count].copy_from_slice(&y[first..first + count]);
    }

    #[inline]
    fn at(&self, k: usize, time: f64) -> f64 {
        self.origin[k] + self.rate[k] * (time - self.time)
    }

    /// x of y.
    #[inline]
    pub(super) fn measure(&self, time: f64, y: &[f64], x: &mut [f64]) {
        for (k, (x, y)) in x.iter_mut().zip(y).enumerate() {
            *x = y - self.at(k, time);
        }
    }

    /// y of x, in place.
    #[inline]
    pub(super) fn restore(&self, time: f64, x: &mut [f64]) {
        for (k, x) in x.iter_mut().enumerate() {
            *x += self.at(k, time);
        }
    }
}

/// One remembered time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Point {
    /// State at which f was evaluated.
    pub(super) y: Vec<f64>,
    /// f there, rows with a remainder.
    pub(super) f: Vec<f64>,
    /// The remainder there.
    pub(super) g: Vec<f64>,
}

/// Points at the distance of the step, the newest first.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct History {
    pub(super) points: Vec<Point>,
    /// How many of them hold something.
    pub(super) known: usize,
    /// Backward differences of the remainder at the newest point, of rising order, one after the other.
    differences: Vec<f64>,
    /// How many of them are those of the points.
    differed: usize,
    /// How many are those of the points without the newest.
    before: usize,
}

impl History {
    pub(super) fn new(linear: &Linear, points: usize, differences: usize) -> Self {
        let (n, count) = (linear.dimension, linear.remainders());
        let point = Point {
            y: vec![0.0; n],
            f: vec![0.0; count],
            g: vec![0.0; count],
        };
        Self {
            points: vec![point; points],
            known: 0,
            differences: vec![0.0; count * differences],
            differed: 0,
            before: 0,
        }
    }

    /// The points are others than they were.
    pub(super) fn change(&mut self) {
        (self.differed, self.before) = (0, 0);
    }

    /// Room for a new point before the others; the oldest is forgotten.
    pub(super) fn push(&mut self) -> &mut Point {
        (self.differed, self.before) = (0, self.differed);
        self.points.rotate_right(1);
        self.known = (self.known + 1).min(self.points.len());
        &mut self.points[0]
    }

    /// Forgets the newest point.
    pub(super) fn pop(&mut self) {
        self.change();
        self.points.rotate_left(1);
        self.known -= 1;
    }

    /// Every other point: the step doubles.
    pub(super) fn thin(&mut self) {
        self.change();
        self.known = self.known.div_ceil(2);
        for k in 1..self.known {
            self.points.swap(k, 2 * k);
        }
    }

    /// Differences of orders below `count`, which so many points give.
    #[inline]
    pub(super) fn differ(&mut self, count: usize) {
        if self.differed >= count {
            return;
        }
        let width = self.points[0].g.len();
        // Those of the oldest point that counts, then one point after the other.
        let first = if self.before + 1 >= count {
            0
        } else {
            count - 1
        };
        for (known, point) in self.points[..=first].iter().rev().enumerate() {
            let orders = if first == 0 { count } else { known + 1 };
            for (c, g) in point.g.iter().enumerate() {
                let mut difference = *g;
                for kept in self.differences[c..].iter_mut().step_by(width).take(orders) {
                    let older = std::mem::replace(kept, difference);
                    difference -= older;
                }
            }
        }
        (self.differed, self.before) = (count, 0);
    }

    /// The difference of an order that is there.
    #[inline]
    pub(super) fn difference(&self, order: usize) -> &[f64] {
        let width = self.points[0].g.len();
        &self.differences[order * width..(order + 1) * width]
    }

    /// Coefficients b_k of the polynomial through the first `count` points, whose differences are there: one after the
    /// other in `out`.
    #[inline]
    pub(super) fn coefficients(&self, count: usize, out: &mut [f64]) {
        let width = self.points[0].g.len();
        for (k, out) in out.chunks_exact_mut(width).take(count).enumerate() {
            out.fill(0.0);
            let rows = self.differences.chunks_exact(width).enumerate();
            for (j, row) in rows.take(count).skip(k) {
                let weight = POWERS[j][k];
                for (out, d) in out.iter_mut().zip(row) {
                    *out += weight * d;
                }
            }
        }
    }
}

/// Moves the origin of a polynomial by `s` units: coefficients one after the other, of `width` each.
pub(super) fn shift(coefficients: &mut [f64], width: usize, s: f64) {
    let count = coefficients.len() / width;
    for k in 0..count {
        let mut factor = 1.0;
        for i in 1..count - k {
            factor *= s / i as f64;
            for c in 0..width {
                coefficients[k * width + c] += factor * coefficients[(k + i) * width + c];
            }
        }
    }
}
