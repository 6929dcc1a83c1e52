//! History of a multistep method: equally spaced states, f at these states, and the remainder of f without the linear part.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::columns::padded;
use super::propagator::{DIFFERENCES, Linear, POWERS};

/// Straight line from which states are measured: `x = y - origin - rate (t - time)`.
///
/// Angles grow without bound while their elastic part stays small; subtracting the line keeps the digits. Padded, as x.
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
            origin: vec![0.0; padded(dimension)],
            rate: vec![0.0; padded(dimension)],
        }
    }

    /// Sets the line through `y` at `time`; positions move with their rates.
    pub(super) fn set(&mut self, linear: &Linear, time: f64, y: &[f64]) {
        self.time = time;
        self.origin[..y.len()].copy_from_slice(y);
        let (first, count) = (linear.first, linear.first.min(linear.remainders()));
        self.rate[..count].copy_from_slice(&y[first..first + count]);
    }

    /// Returns the line at `time`.
    #[inline]
    fn at(&self, time: f64) -> impl Iterator<Item = f64> {
        let since = time - self.time;
        let both = self.origin.iter().zip(&self.rate);
        both.map(move |(origin, rate)| origin + rate * since)
    }

    /// Computes x from y.
    pub(super) fn measure(&self, time: f64, y: &[f64], x: &mut [f64]) {
        for ((x, y), at) in x.iter_mut().zip(y).zip(self.at(time)) {
            *x = y - at;
        }
    }

    /// Computes y from x, in place.
    pub(super) fn restore(&self, time: f64, x: &mut [f64]) {
        for (x, at) in x.iter_mut().zip(self.at(time)) {
            *x += at;
        }
    }
}

/// Stored point at one time; padded.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Point {
    /// State at which f was evaluated.
    pub(super) y: Vec<f64>,
    /// Derivative f at `y`, rows with a remainder.
    pub(super) f: Vec<f64>,
    /// Remainder at `y`.
    pub(super) g: Vec<f64>,
}

impl Point {
    /// Sets f and its remainder f - L x. Numbers are read one by one, as f was written: a wider read would stall the processor.
    #[inline]
    pub(super) fn set(&mut self, f: &[f64], product: &[f64]) {
        let count = f.len();
        let (to, g, product) = (
            &mut self.f[..count],
            &mut self.g[..count],
            &product[..count],
        );
        for k in 0..count {
            to[k] = f[k];
            g[k] = f[k] - product[k];
        }
    }

    /// Sets the remainder f - L x.
    pub(super) fn set_remainder(&mut self, product: &[f64]) {
        for (g, (f, product)) in self.g.iter_mut().zip(self.f.iter().zip(product)) {
            *g = f - product;
        }
    }
}

/// Points at the distance of the step, the newest first.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct History {
    pub(super) points: VecDeque<Point>,
    /// Number of points in use.
    pub(super) count: usize,
    /// Length of x.
    dimension: usize,
    /// Length of the remainder.
    width: usize,
    /// State x, written when needed, then backward differences of the remainder at the newest point, of rising order, one after
    /// the other.
    differences: Vec<f64>,
    /// Number of differences that are valid for the present points.
    differed: usize,
    /// Number of differences that are valid for the points without the newest.
    before: usize,
}

impl History {
    pub(super) fn new(linear: &Linear, points: usize, differences: usize) -> Self {
        let (n, count) = (linear.dimension, linear.remainders());
        let point = Point {
            y: vec![0.0; padded(n)],
            f: vec![0.0; padded(count)],
            g: vec![0.0; padded(count)],
        };
        Self {
            points: vec![point; points].into(),
            count: 0,
            dimension: n,
            width: count,
            differences: vec![0.0; n + count * differences],
            differed: 0,
            before: 0,
        }
    }

    /// Marks the points as changed.
    pub(super) fn change(&mut self) {
        (self.differed, self.before) = (0, 0);
    }

    /// Returns a new point before the others; the oldest is dropped.
    pub(super) fn push(&mut self) -> &mut Point {
        (self.differed, self.before) = (0, self.differed);
        self.count = (self.count + 1).min(self.points.len());
        self.points.rotate_right(1);
        &mut self.points[0]
    }

    /// Drops the newest point.
    pub(super) fn pop(&mut self) {
        self.change();
        self.points.rotate_left(1);
        self.count -= 1;
    }

    /// Keeps every other point: the step doubles.
    pub(super) fn thin(&mut self) {
        self.change();
        self.count = self.count.div_ceil(2);
        for k in 1..self.count {
            self.points.swap(k, 2 * k);
        }
    }

    /// Computes the differences of orders below `count`, for which as many points are needed.
    pub(super) fn differ(&mut self, count: usize) {
        if self.differed >= count {
            return;
        }
        // Start with the oldest required point, then add one point after the other.
        let first = if self.before + 1 >= count {
            0
        } else {
            count - 1
        };
        let (width, differences) = (self.width, &mut self.differences[self.dimension..]);
        for k in (0..=first).rev() {
            let orders = if first == 0 { count } else { first - k + 1 };
            let (rows, g) = (&mut differences[..orders * width], &self.points[k].g);
            let mut column = 0;
            while column + 2 <= width {
                advance::<2>(rows, width, column, g);
                column += 2;
            }
            if column < width {
                advance::<1>(rows, width, column, g);
            }
        }
        (self.differed, self.before) = (count, 0);
    }

    /// Returns the difference of an order that is computed.
    #[inline]
    pub(super) fn difference(&self, order: usize) -> &[f64] {
        &self.differences[self.dimension + order * self.width..][..self.width]
    }

    /// Returns the place of x, to be written.
    #[inline]
    pub(super) fn x_mut(&mut self) -> &mut [f64] {
        &mut self.differences[..self.dimension]
    }

    /// Returns x as it was written, and the first `count` differences.
    #[inline]
    pub(super) fn known(&self, count: usize) -> &[f64] {
        &self.differences[..self.dimension + count * self.width]
    }

    /// Writes to `out`, one after the other, the coefficients b_k of the polynomial through the first `count` points, whose
    /// differences must be computed.
    pub(super) fn coefficients(&self, count: usize, out: &mut [f64]) {
        let width = self.width;
        for (k, out) in out.chunks_exact_mut(width).take(count).enumerate() {
            out.fill(0.0);
            let rows = self.differences[self.dimension..]
                .chunks_exact(width)
                .enumerate();
            for (j, row) in rows.take(count).skip(k) {
                let weight = POWERS[j][k];
                for (out, d) in out.iter_mut().zip(row) {
                    *out += weight * d;
                }
            }
        }
    }
}

/// Updates backward differences, in rows of `width`, by another value `g`, for N columns at a time, which stay in a register.
#[inline(always)]
fn advance<const N: usize>(differences: &mut [f64], width: usize, column: usize, g: &[f64]) {
    let mut difference: [f64; N] = std::array::from_fn(|k| g[column + k]);
    for row in differences.chunks_exact_mut(width) {
        for (kept, next) in row[column..column + N].iter_mut().zip(&mut difference) {
            (*kept, *next) = (*next, *next - *kept);
        }
    }
}

/// Converts coefficients b_k of a polynomial to its backward differences at a distance of `share` units: one after the other,
/// `width` entries each.
pub fn to_differences(coefficients: &mut [f64], width: usize, share: f64) {
    let count = coefficients.len() / width;
    let mut factor = 1.0;
    for j in 0..count {
        // Entries of higher powers are not yet differences.
        let (to, above) = coefficients[j * width..].split_at_mut(width);
        for (c, to) in to.iter_mut().enumerate() {
            let mut power = factor;
            *to *= power * DIFFERENCES[j][j];
            for (k, b) in (j + 1..count).zip(above.iter().skip(c).step_by(width)) {
                power *= share;
                *to += power * DIFFERENCES[j][k] * b;
            }
        }
        factor *= share;
    }
}

/// Converts all nonzero backward differences of a polynomial to those one point earlier.
pub fn step_back(differences: &mut [f64], width: usize) {
    for k in 0..differences.len() - width {
        differences[k] -= differences[k + width];
    }
}
