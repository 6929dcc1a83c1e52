//! Torque balance of the output shaft in a window, a law of mechanics that every engine and contact law must satisfy:
//!
//! ```text
//! mean output torque + load = J (omega_end - omega_start) / T
//! ```
//! J is the moment of inertia of the shaft with its output pins. The second difference of an angle is the integral of its
//! acceleration under a triangle, so the sum of these differences equals the right-hand side without a derivative. The integral
//! of the torque under such a triangle is (1, 10, 1)/12 of three samples (Numerov). Rounding and the error of this quadrature
//! remain; the quadrature over every other sample estimates that error, whose order is unknown where contacts open and close. A
//! kink that both sets of samples miss alike shows in its own triangle, whose remainder exceeds the mean remainder.

use std::ops::Range;

use pinwheel_timeseries::convergence::SAFETY_UNCONFIRMED;
use pinwheel_timeseries::{TimeSeries, columns};

/// Relative difference below which two sample intervals are equal.
const EQUAL: f64 = 1e-6;
/// Fewest triangles at twice the spacing.
const FEWEST: usize = 2;

/// Remainder of the torque balance in a window, N m, and its bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Balance {
    /// Mean of torque and load less the mean inertia torque.
    pub(crate) left_over: f64,
    /// Bound of the error of the quadrature.
    pub(crate) quadrature: f64,
    /// Bound of the error from the rounding of the angle.
    pub(crate) rounding: f64,
}

/// Largest number of roundings of an angle in one step; those of several steps add up as a random walk.
const ROUNDINGS: f64 = 8.0;

/// Returns the torque balance of a run with `steps` integration steps between samples; `None` with too few equally spaced
/// samples or a missing channel.
pub(crate) fn of(
    time_series: &TimeSeries,
    samples: Range<usize>,
    load: f64,
    inertia: f64,
    steps: f64,
) -> Option<Balance> {
    let part = |values: &[f64]| values.get(samples.clone()).map(<[f64]>::to_vec);
    let time = part(time_series.time_s())?;
    let torque = part(time_series.channel(columns::OUTPUT_TORQUE)?)?;
    let angle = part(time_series.channel(columns::OUTPUT_ANGLE)?)?;
    let spacing = time.get(1)? - time[0];
    let is_equal = |t: &&[f64]| (t[1] - t[0] - spacing).abs() <= EQUAL * spacing;
    let len = time.windows(2).take_while(is_equal).count() + 1;
    // Integral over one triangle, then over the window, from sample `first` on, `stride` apart.
    let one = |k: usize| {
        let mean = (torque[k] + 10.0 * torque[k + 1] + torque[k + 2]) / 12.0;
        let gained = (angle[k + 2] - angle[k + 1]) - (angle[k + 1] - angle[k]);
        mean + load - inertia * gained / (spacing * spacing)
    };
    let left_over = |first: usize, stride: usize| {
        let at: Vec<usize> = (first..len).step_by(stride).collect();
        let triangles = at.len().checked_sub(2).filter(|n| *n >= FEWEST)? as f64;
        let three = |k: &[usize]| torque[k[0]] + 10.0 * torque[k[1]] + torque[k[2]];
        let sum: f64 = at.windows(3).map(three).sum();
        let [.., b, c] = at[..] else { return None };
        let gained = (angle[c] - angle[b]) - (angle[at[1]] - angle[at[0]]);
        let span = spacing * stride as f64;
        Some(sum / 12.0 / triangles + load - inertia * gained / (span * span * triangles))
    };
    let all = left_over(0, 1)?;
    let halves = [left_over(0, 2)?, left_over(1, 2)?];
    let off = |k: usize| (one(k) - all).abs();
    let kink = (0..len - 2).map(off).fold(0.0, f64::max) / (len - 2) as f64;
    let angles = angle[..len].iter();
    let turned = angles.fold(0.0, |most: f64, a| most.max(a.abs()));
    let off_of_halves = halves.iter().map(|half| (half - all).abs());
    Some(Balance {
        left_over: all,
        quadrature: SAFETY_UNCONFIRMED * off_of_halves.fold(kink, f64::max),
        rounding: ROUNDINGS * steps.max(1.0).sqrt() * f64::EPSILON * turned * inertia
            / (spacing * spacing * (len - 2) as f64),
    })
}
