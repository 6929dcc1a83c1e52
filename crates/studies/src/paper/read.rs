//! Figures of time series.

pub(super) use pinwheel_timeseries::norms::{mean, range};
use pinwheel_timeseries::{TimeSeries, columns, norms};

/// Columns of the contract.
pub(super) const INPUT: &str = columns::INPUT_TORQUE;
pub(super) const OUTPUT: &str = columns::OUTPUT_TORQUE;
pub(super) const EXTERNAL: &str = columns::EXTERNAL_FORCE;
pub(super) const INTERNAL: &str = columns::INTERNAL_FORCE;

/// Window after the start-up transient, s.
pub(super) const STEADY: (f64, f64) = (0.3, 0.6);
/// One input turn, the window of the single figures, s. The paper mentions 0.24 to 0.28 s.
pub(super) const DRAWN: (f64, f64) = (0.24, 0.36);
/// Window of the start-up transient after its first oscillations, s.
pub(super) const DYING: (f64, f64) = (0.06, 0.15);

/// Returns the values of one channel, or of the first of a group, within a window; none without such a channel.
pub(super) fn part<'a>(time_series: &'a TimeSeries, name: &str, window: (f64, f64)) -> &'a [f64] {
    let range = time_series.window(window.0, window.1);
    let values = time_series.channel(name);
    let values = values.or_else(|| time_series.group(name).first().copied());
    values.and_then(|values| values.get(range)).unwrap_or(&[])
}

/// Returns the sample times within a window.
pub(super) fn times(time_series: &TimeSeries, window: (f64, f64)) -> Vec<f64> {
    time_series.time_s()[time_series.window(window.0, window.1)].to_vec()
}

/// Returns all values of a group of channels within a window.
pub(super) fn all(time_series: &TimeSeries, group: &str, window: (f64, f64)) -> Vec<f64> {
    let range = time_series.window(window.0, window.1);
    let channels = time_series.group(group);
    let channels = channels.iter();
    let parts = channels.filter_map(|values| values.get(range.clone()));
    parts.flatten().copied().collect()
}

/// Returns the largest value; 0 without values.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Returns the largest force of a group within a window; 0 without values.
pub(super) fn peak(time_series: &TimeSeries, group: &str, window: (f64, f64)) -> f64 {
    largest(&all(time_series, group, window))
}

/// Returns the RMS of `a - b` over the RMS of `b`.
pub fn off(a: &[f64], b: &[f64]) -> f64 {
    norms::relative_l2(&a.into(), &b.into(), 0.0)
}

/// Returns the RMS of a time series less its running mean over `half` samples on both sides, i.e. of its oscillation above that
/// frequency.
pub fn roughness(values: &[f64], half: usize) -> f64 {
    let mut sum = 0.0;
    for (k, value) in values.iter().enumerate() {
        let around = &values[k.saturating_sub(half)..(k + half + 1).min(values.len())];
        let apart = value - mean(around);
        sum += apart * apart;
    }
    (sum / values.len().max(1) as f64).sqrt()
}
