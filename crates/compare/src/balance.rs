//! The balance of the output shaft, which mechanics demands of every engine and law, in every window:
//!
//! ```text
//! mean output torque + load = J (omega_end - omega_start) / T
//! ```
//! J holds the shaft and the output pins that it carries. The second difference of an angle is the integral of its
//! acceleration under a triangle, so that their sum is the right-hand side without a derivative. The same triangles over the torque are
//! (1, 10, 1)/12 of three samples (Numerov). What is left is rounding and that quadrature, whose error every other
//! sample shows: where contacts open and close, of an order that is not known. One kink may fall where all samples and every
//! other one miss it alike; its own triangle shows it, which is off by more than what all leave in the mean.

use std::ops::Range;

use pinwheel_timeseries::convergence::SAFETY_UNCONFIRMED;
use pinwheel_timeseries::{TimeSeries, columns};

/// Intervals that differ by no more than this share are equal.
const EQUAL: f64 = 1e-6;
/// Fewest triangles at twice the spacing.
const FEWEST: usize = 2;

/// Remainder of the torque balance in a window, N m, and its bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Balance {
    /// Mean of torque and load, less that of the acceleration.
    pub(crate) left_over: f64,
    /// Bound of the error of the quadrature.
    pub(crate) quadrature: f64,
    /// Bound of the error from the rounding of the angle.
    pub(crate) rounding: f64,
}

/// Most roundings of an angle in a step; the roundings of the steps between two samples add up as a random walk.
const ROUNDINGS: f64 = 8.0;

/// Balance of a run with so many `steps` between samples; `None` with too few equally spaced samples, or without a
/// channel.
pub(crate) fn of(
    time_series: &TimeSeries,
    samples: Range<usize>,
    load: f64,
    inertia: f64,
    steps: f64,
) -> Option<Balance> {
    let part =
        |values: &'_ [f64]| -> Option<Vec<f64>> { Some(values.get(samples.clone())?.to_vec()) };
    let time = part(time_series.time_s())?;
    let torque = part(time_series.channel(columns::OUTPUT_TORQUE)?)?;
    let angle = part(time_series.channel(columns::OUTPUT_ANGLE)?)?;
    let spacing = time.get(1)? - time[0];
    let equal = time
        .windows(2)
        .take_while(|t| (t[1] - t[0] - spacing).abs() <= EQUAL * spacing);
    let len = equal.count() + 1;
    // Integral over one triangle, then over the window, from sample `first` on, `stride` apart.
    let one = |k: usize| {
        let mean = (torque[k] + 10.0 * torque[k + 1] + torque[k + 2]) / 12.0;
        let gained = (angle[k + 2] - angle[k + 1]) - (angle[k + 1] - angle[k]);
        mean + load - inertia * gained / (spacing * spacing)
    };
    let left_over = |first: usize, stride: usize| {
        let at: Vec<usize> = (first..len).step_by(stride).collect();
        let triangles = at.len().checked_sub(2).filter(|n| *n >= FEWEST)? as f64;
        let sum: f64 = at
            .windows(3)
            .map(|k| torque[k[0]] + 10.0 * torque[k[1]] + torque[k[2]])
            .sum();
        let [.., b, c] = at[..] else { return None };
        let gained = (angle[c] - angle[b]) - (angle[at[1]] - angle[at[0]]);
        let span = spacing * stride as f64;
        Some(sum / 12.0 / triangles + load - inertia * gained / (span * span * triangles))
    };
    let all = left_over(0, 1)?;
    let halves = [left_over(0, 2)?, left_over(1, 2)?];
    let off = |k: usize| (one(k) - all).abs();
    let kink = (0..len - 2).map(off).fold(0.0, f64::max) / (len - 2) as f64;
    let turned = angle[..len]
        .iter()
        .fold(0.0, |most: f64, a| most.max(a.abs()));
    Some(Balance {
        left_over: all,
        quadrature: SAFETY_UNCONFIRMED
            * halves
                .iter()
                .fold(kink, |most: f64, half| most.max((half - all).abs())),
        rounding: ROUNDINGS * steps.max(1.0).sqrt() * f64::EPSILON * turned * inertia
            / (spacing * spacing * (len - 2) as f64),
    })
}
