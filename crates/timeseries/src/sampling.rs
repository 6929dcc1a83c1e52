//! Means and extremes of signals between samples, with their sampling errors.
//!
//! A solver that provides the states at its own steps has them condensed into one interval per sample ([`Between`]); for all
//! other runs the samples are used. Either way a quantity is given at *points*. A mean is the time integral of the cubic
//! through the four nearest points. An extreme is the lower of two values, the vertex of the parabola through a point and its
//! neighbours and the value of the quartic through five points there, and at least the point itself.
//!
//! The variation between points is estimated by the sixth difference d of seven points, with weights whose squares sum to 1. It
//! is negligible where the signal is smooth, and equals the scatter where points are independent, as in an under-sampled
//! oscillation. The error of a mean is about `sqrt(sum (h d)^2)/T`, that of an extreme d plus the difference of parabola and
//! quartic; 2.5 times these are stated. The cubic's error at the ends of a window, below 1e-6 of a resolved oscillation, is
//! neglected: no run is that accurate.

use std::ops::Range;

use crate::norms::{Statistics, View};
use crate::{TimeSeries, columns};

/// Number of points for the estimate of smoothness.
pub const POINTS: usize = 7;
/// Ratio of the stated error to the estimated scatter of a mean.
pub const SAFETY: f64 = 2.5;
/// Number of points processed at a time.
const CHUNK: usize = 256;
/// Distance to the previous point, as a share of the distance before it, below which a point is ignored.
const NEAR: f64 = 0.1;
/// Relative difference below which spacings are equal.
const EQUAL: f64 = 1e-6;
/// Weights for equal spacings: binomials over the root of 924, so that their squares sum to 1.
#[doc(hidden)]
pub const EVEN: [f64; POINTS] = {
    let unit = 0.032_897_584_747_988_45;
    [
        unit,
        -6.0 * unit,
        15.0 * unit,
        -20.0 * unit,
        15.0 * unit,
        -6.0 * unit,
        unit,
    ]
};

/// Quantity at one time over all its channels: sum, sum of squares, smallest and largest.
pub type Point = [f64; 4];

const SUM: usize = 0;
const SQUARES: usize = 1;
const MIN: usize = 2;
const MAX: usize = 3;

/// Condenses the values of all channels into a point.
pub fn point(values: impl Iterator<Item = f64>) -> Point {
    let nothing = [0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY];
    values.fold(nothing, |[sum, squares, min, max], value| {
        [
            sum + value,
            squares + value * value,
            if value < min { value } else { min },
            if value > max { value } else { max },
        ]
    })
}

/// Quantity between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Interval {
    /// Time integrals of the sum and of the squares; `off` has the squares of their errors.
    integrals: [f64; 2],
    off: [f64; 2],
    /// Largest and smallest value, each with its possible excess.
    max: [f64; 2],
    min: [f64; 2],
}

const EMPTY: Interval = Interval {
    integrals: [0.0; 2],
    off: [0.0; 2],
    max: [f64::NEG_INFINITY; 2],
    min: [f64::INFINITY; 2],
};

/// Quantities between the samples of a run, from points in the order of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Between {
    names: Vec<&'static str>,
    /// Interval data, indexed by quantity and interval.
    intervals: Vec<Vec<Interval>>,
    /// Times, s, of the points not yet processed and of the earlier points that they need. `samples` marks the points that are
    /// samples; `points` has the values by quantity.
    times: Vec<f64>,
    samples: Vec<bool>,
    points: Vec<Vec<Point>>,
    /// Number of processed intervals between the stored points.
    settled: usize,
    /// Number of points that are no samples.
    others: usize,
}

impl Between {
    /// Makes an empty record of these quantities, with capacity for `samples` samples.
    pub fn new(names: &[&'static str], samples: usize) -> Self {
        Self {
            names: names.to_vec(),
            // The clone of an empty list would have no capacity.
            intervals: (names.iter().map(|_| Vec::with_capacity(samples))).collect(),
            times: Vec::with_capacity(CHUNK + POINTS),
            samples: Vec::with_capacity(CHUNK + POINTS),
            points: vec![Vec::with_capacity(CHUNK + POINTS); names.len()],
            settled: 0,
            others: 0,
        }
    }

    /// Adds the quantities at a time, s, which must not fall. Of two points close to each other a sample takes precedence.
    pub fn push(&mut self, time: f64, is_sample: bool, points: &[Point]) {
        if let [.., before, last] = self.times[..]
            && time - last < NEAR * (last - before)
        {
            let kept = self.times.len() - 1;
            if !is_sample {
                return;
            }
            if !self.samples[kept] {
                self.truncate(kept);
                self.others -= 1;
            }
        }
        if self.times.len() == CHUNK + POINTS {
            self.settle(CHUNK + POINTS - 4);
            self.forget();
        }
        self.times.push(time);
        self.samples.push(is_sample);
        self.others += usize::from(!is_sample);
        for (all, point) in self.points.iter_mut().zip(points) {
            all.push(*point);
        }
    }

    fn truncate(&mut self, count: usize) {
        self.times.truncate(count);
        self.samples.truncate(count);
        self.points.iter_mut().for_each(|all| all.truncate(count));
    }

    /// Drops the points that later ones do not need.
    fn forget(&mut self) {
        let first = self.settled.saturating_sub(3);
        self.times.drain(..first);
        self.samples.drain(..first);
        self.points
            .iter_mut()
            .for_each(|all| drop(all.drain(..first)));
        self.settled -= first;
    }

    /// Processes the intervals between points up to the point `end`.
    fn settle(&mut self, end: usize) {
        let count = self.times.len();
        if count < POINTS {
            return;
        }
        let mut stencil = Stencil::default();
        for i in self.settled..end {
            stencil.set(&self.times, i);
            let starts = self.samples[i];
            for (points, intervals) in self.points.iter().zip(&mut self.intervals) {
                // Points before the first sample have no interval.
                if starts {
                    intervals.push(EMPTY);
                }
                let Some(last) = intervals.len().checked_sub(1) else {
                    continue;
                };
                stencil.integrate(points, &mut intervals[last]);
                if i > 0 {
                    stencil.extremes(&self.times, points, |at, is_max, value, beyond| {
                        // The extreme at a sample may lie in the interval before it.
                        let place = last.saturating_sub(usize::from(starts && at < 0.0));
                        let interval = &mut intervals[place];
                        if is_max {
                            interval.max[0] = interval.max[0].max(value);
                            interval.max[1] = interval.max[1].max(value + beyond);
                        } else {
                            interval.min[0] = interval.min[0].min(value);
                            interval.min[1] = interval.min[1].min(value - beyond);
                        }
                    });
                }
            }
        }
        self.settled = end;
    }

    /// Returns the complete record; `None` with too few points, or without points between samples.
    #[must_use]
    pub fn finish(mut self) -> Option<Self> {
        let last = self.times.len().checked_sub(1)?;
        self.settle(last);
        let is_more = self.others > 0 && self.settled == last;
        self.times = Vec::new();
        self.samples = Vec::new();
        self.points = Vec::new();
        is_more.then_some(self)
    }
}

/// Points around one interval between points.
#[derive(Debug, Default)]
struct Stencil {
    /// Indices of the point before the interval, of the first of the seven points, and of the first of the four.
    at: usize,
    seven: usize,
    four: usize,
    /// Length of the interval, s.
    h: f64,
    differences: [f64; POINTS],
    integrals: [f64; 4],
}

impl Stencil {
    fn set(&mut self, times: &[f64], i: usize) {
        let count = times.len();
        let (from, h) = (times[i], times[i + 1] - times[i]);
        let inverse = h.recip();
        self.at = i;
        self.h = h;
        self.seven = i.saturating_sub(3).min(count - POINTS);
        self.four = i.saturating_sub(1).min(count - 4);
        self.differences = sixth_difference(points_from(times, self.seven));
        let four: &[f64; 4] = points_from(times, self.four);
        let four = four.map(|t| (t - from) * inverse);
        self.integrals = cubic(&four, i - self.four).map(|share| share * h);
    }

    #[inline]
    fn integrate(&self, points: &[Point], into: &mut Interval) {
        let four: &[Point; 4] = points_from(points, self.four);
        let integrals = weighted(four, &self.integrals);
        let seven: &[Point; POINTS] = points_from(points, self.seven);
        let off = weighted(seven, &self.differences);
        for k in [SUM, SQUARES] {
            into.integrals[k] += integrals[k];
            into.off[k] += (self.h * off[k]).powi(2);
        }
        for point in &points[self.at..=self.at + 1] {
            into.max = into.max.map(|known| {
                if point[MAX] > known {
                    point[MAX]
                } else {
                    known
                }
            });
            into.min = into.min.map(|known| {
                if point[MIN] < known {
                    point[MIN]
                } else {
                    known
                }
            });
        }
    }

    /// Reports the extremes near the point: offset in units of h, true for a maximum, value, and possible excess.
    #[inline]
    fn extremes(&self, times: &[f64], points: &[Point], mut tell: impl FnMut(f64, bool, f64, f64)) {
        let [before, here, after] = points_from(points, self.at - 1);
        let is_max = here[MAX] > before[MAX] && here[MAX] >= after[MAX];
        // An open contact, with force zero, has no minimum.
        let is_min = here[MIN] < before[MIN] && here[MIN] <= after[MIN] && here[MIN] != 0.0;
        if !(is_max || is_min) {
            return;
        }
        let seven: &[Point; POINTS] = points_from(points, self.seven);
        let off = weighted(seven, &self.differences);
        // Five points centred on the point, except at the ends.
        let first = self.at.saturating_sub(2).min(points.len() - 5);
        let five: &[f64; 5] = points_from(times, first);
        let at = five.map(|t| (t - times[self.at]) / self.h);
        let values: &[Point; 5] = points_from(points, first);
        let mut vertex = |is_max: bool, sign: f64, k: usize| {
            let values = values.map(|point| sign * point[k]);
            let (place, value, apart) = vertex(&at, values, self.at - first);
            tell(place, is_max, sign * value, SAFETY * (apart + off[k].abs()));
        };
        if is_max {
            vertex(true, 1.0, MAX);
        }
        if is_min {
            vertex(false, -1.0, MIN);
        }
    }
}

/// Returns the first N elements from `first` on, which must exist.
#[inline]
fn points_from<T, const N: usize>(all: &[T], first: usize) -> &[T; N] {
    let chunk = all.get(first..).and_then(|rest| rest.first_chunk());
    chunk.unwrap_or_else(|| unreachable!("{first} of {}", all.len()))
}

/// Weighted sum of the points.
#[inline]
fn weighted<const N: usize>(points: &[Point; N], weights: &[f64; N]) -> Point {
    let mut sum = [0.0; 4];
    for (point, weight) in points.iter().zip(weights) {
        for (sum, value) in sum.iter_mut().zip(point) {
            *sum += weight * value;
        }
    }
    sum
}

/// Weights of the sixth difference at these times, with squares that sum to 1.
pub fn sixth_difference(times: &[f64; POINTS]) -> [f64; POINTS] {
    let (from, h) = (times[3], times[4] - times[3]);
    let even = (1..POINTS).fold(true, |all, k| {
        all & ((times[k] - times[k - 1] - h).abs() <= EQUAL * h)
    });
    if even {
        return EVEN;
    }
    let inverse = h.recip();
    divided(&times.map(|t| (t - from) * inverse))
}

/// Weights of the highest divided difference at these times, with squares that sum to 1.
#[doc(hidden)]
pub fn divided(at: &[f64; POINTS]) -> [f64; POINTS] {
    let mut products = [1.0; POINTS];
    for j in 0..POINTS {
        for k in 0..j {
            let apart = at[j] - at[k];
            products[j] *= apart;
            products[k] *= -apart;
        }
    }
    let weights = products.map(f64::recip);
    let size = weights.iter().map(|w| w * w).sum::<f64>().sqrt().recip();
    weights.map(|w| w * size)
}

/// Weights of the integral from 0 to 1 of the cubic through values at these times; time `zero` is 0 and the next is 1.
#[doc(hidden)]
pub fn cubic(at: &[f64; 4], zero: usize) -> [f64; 4] {
    let one = zero + 1;
    // Indices of the other two: one before and one after, except at the ends.
    let (a, b) = match zero {
        0 => (2, 3),
        1 => (0, 3),
        _ => (0, 1),
    };
    // Integral of t (t - 1) (t - other) from 0 to 1, over the value of this cubic at `own`.
    let weight =
        |own: f64, other: f64| (2.0 * other - 1.0) / (12.0 * own * (own - 1.0) * (own - other));
    let mut weights = [0.0; 4];
    (weights[a], weights[b]) = (weight(at[a], at[b]), weight(at[b], at[a]));
    // Exactness for straight lines gives the other two weights.
    weights[one] = 0.5 - weights[a] * at[a] - weights[b] * at[b];
    weights[zero] = 1.0 - weights[one] - weights[a] - weights[b];
    weights
}

/// Returns the maximum near the inner point `k` of five, which is above its neighbours: time, least value, and difference of
/// parabola and quartic there.
fn vertex(at: &[f64; 5], values: [f64; 5], k: usize) -> (f64, f64, f64) {
    let slope = |a: usize, b: usize| (values[b] - values[a]) / (at[b] - at[a]);
    let (before, after) = (k - 1, k + 1);
    let bend = (slope(k, after) - slope(before, k)) / (at[after] - at[before]);
    // Newton's parabola through the three points, at its vertex.
    let place = 0.5 * (at[before] + at[k] - slope(before, k) / bend);
    if !place.is_finite() {
        return (0.0, values[k], 0.0);
    }
    let parabola =
        values[before] + (place - at[before]) * (slope(before, k) + (place - at[k]) * bend);
    let term = |k: usize| {
        let others = (0..5).filter(|&j| j != k);
        let factors = others.map(|j| (place - at[j]) / (at[k] - at[j]));
        values[k] * factors.product::<f64>()
    };
    let quartic: f64 = (0..5).map(term).sum();
    let least = parabola.min(quartic).max(values[k]);
    (place, least, (parabola - quartic).abs())
}

/// Figures of a quantity over a window, with their sampling errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Values of the figures.
    pub statistics: Statistics,
    /// Error of each figure from the signal between points.
    pub sampling: Statistics,
}

impl Figures {
    /// Evaluates the figures of all `channels` of the quantity `name` over the samples `window`; `None` without samples, or if
    /// a channel is missing or not finite.
    pub fn of(
        time_series: &TimeSeries,
        name: &str,
        channels: &[impl AsRef<str>],
        window: Range<usize>,
    ) -> Option<Self> {
        let view = View::of(time_series, channels, window.clone())?;
        let samples = Statistics::of(&view)?;
        let times = &time_series.time_s()[window.clone()];
        let within =
            |intervals: &[Interval]| Self::within(samples, view.channels().len(), times, intervals);
        let known = time_series.between().and_then(|between| {
            let place = between.names.iter().position(|known| *known == name)?;
            between.intervals[place].get(window.start..window.end - 1)
        });
        // A single sample has no interval.
        if let Some(intervals) = known.filter(|intervals| !intervals.is_empty()) {
            return Some(within(intervals));
        }
        let mut all = Between::new(&[""], times.len());
        for (k, &time) in times.iter().enumerate() {
            let known = point(view.channels().iter().map(|channel| channel[k]));
            all.push(time, true, &[known]);
        }
        all.settle(all.times.len() - 1);
        let intervals = &all.intervals[0];
        if intervals.len() + 1 == times.len() && times.len() >= POINTS {
            return Some(within(intervals));
        }
        // With too few points the range is the only bound.
        let [mean, min, max, rms, peak] = [samples.max - samples.min; 5];
        let sampling = Statistics {
            mean,
            min,
            max,
            rms,
            peak,
        };
        Some(Self {
            statistics: samples,
            sampling,
        })
    }

    fn within(samples: Statistics, channels: usize, times: &[f64], all: &[Interval]) -> Self {
        let duration = times[times.len() - 1] - times[0];
        let share = 1.0 / (duration * channels as f64);
        let sum = |of: fn(&Interval) -> f64| all.iter().map(of).sum::<f64>();
        let off = |of: fn(&Interval) -> f64| SAFETY * share * sum(of).sqrt();
        let square = (share * sum(|i| i.integrals[1])).max(0.0);
        let rms = square.sqrt();
        let off_square = off(|i| i.off[1]);
        let largest = |k: usize| all.iter().fold(samples.max, |most, i| most.max(i.max[k]));
        let smallest = |k: usize| all.iter().fold(samples.min, |least, i| least.min(i.min[k]));
        let ([max, highest], [min, lowest]) = ([0, 1].map(largest), [0, 1].map(smallest));
        let peak = max.max(-min);
        Self {
            statistics: Statistics {
                mean: share * sum(|i| i.integrals[0]),
                min,
                max,
                rms,
                peak,
            },
            sampling: Statistics {
                mean: off(|i| i.off[0]),
                min: min - lowest,
                max: highest - max,
                // Valid for a vanishing root, too.
                rms: (square + off_square).sqrt() - rms,
                peak: highest.max(-lowest) - peak,
            },
        }
    }
}

/// Quantities of a gearbox that [`Between`] records: those of all engines except the output's angle.
pub const QUANTITIES: [&str; 4] = [
    columns::INPUT_TORQUE,
    columns::OUTPUT_TORQUE,
    columns::EXTERNAL_FORCE,
    columns::INTERNAL_FORCE,
];
