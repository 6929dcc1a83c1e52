//! Resampling of foreign time series to the sample times of a run.
//!
//! Samples at a time of the run are taken unchanged. Between samples the cubic through the four nearest (or a straight line)
//! applies. Its error is measured on the data: every second sample is omitted and restored from the others, with a larger error
//! than that of the interpolation.
//!
//! Gaps are not interpolated. Variable-step solvers write bursts of short steps, and long steps where little happens. So a
//! spacing is compared with its neighbours, and is no gap if the signals continue in a straight line.

use std::ops::Range;

use super::error::ForeignError;
use super::map::{Method, Resampling};
use crate::TimeSeries;
use crate::norms::relative_l2;

/// Largest distance of a time of the run from a sample, as a share of the spacing: a rounding.
const SAME: f64 = 1e-6;
/// Number of spacings on each side with which a gap is compared.
const AROUND: usize = 4;
/// Largest miss of a straight continuation from both ends of a gap, as a share of the signal's standard deviation.
const STRAIGHT: f64 = 0.05;
/// Smallest number of rows within the run, unless the run has fewer samples there.
const FEWEST: usize = 10;

/// Foreign time series on the sample times of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// Time series at all sample times of the run; NaN where the file has no data.
    pub time_series: TimeSeries,
    /// Start and end of the part of the run that the file covers, s.
    pub covers_s: [f64; 2],
    /// Number of the run's times at samples of the file.
    pub own: usize,
    /// Number of the run's times between samples of the file.
    pub interpolated: usize,
    /// Largest relative L2 error of restored samples over the columns, with the column's name; `None` without interpolation.
    pub restores: Option<(f64, String)>,
    /// Gaps of the file, s: only the longest part without a gap is used.
    pub gaps_s: Vec<[f64; 2]>,
}

/// Interpolates `foreign` to `times_s` (increasing).
///
/// # Errors
/// No common time, or rows too dense or too sparse for the run.
pub fn resample(
    foreign: &TimeSeries,
    times_s: &[f64],
    how: Resampling,
) -> Result<Resampled, ForeignError> {
    let own_times = foreign.time_s();
    let (stretch, gaps_s) = longest_stretch(foreign, how.longest_gap);
    let time = &own_times[stretch.clone()];
    let ends = |times: &[f64]| {
        let ends = times.first().zip(times.last());
        ends.map_or((0.0, 0.0), |(first, last)| (*first, *last))
    };
    let (from_s, to_s) = ends(time);
    let slack = SAME * usual_spacing(time);
    let covered = times_s.partition_point(|&t| t < from_s - slack)
        ..times_s.partition_point(|&t| t <= to_s + slack);
    let (run_from_s, run_to_s) = ends(times_s);
    let refused = |what: String| {
        let remedy = "set time.unit, time.factor and time.offset_s of the map";
        Err(ForeignError(format!("{what}; {remedy}")))
    };
    if covered.is_empty() || time.is_empty() {
        return refused(format!(
            "the file covers {from_s} to {to_s} s, none of it in the run's {run_from_s} to {run_to_s} s"
        ));
    }
    if let [first, second, ..] = times_s
        && to_s - from_s < second - first
    {
        return refused(format!(
            "all rows of the file lie within {:e} s, where the run has a sample each {:e} s",
            to_s - from_s,
            second - first
        ));
    }
    let in_run = |t: &&f64| (run_from_s - slack..=run_to_s + slack).contains(*t);
    let inside = time.iter().filter(in_run).count();
    if inside < FEWEST.min(covered.len()) {
        return refused(format!(
            "the file has {inside} rows in the run's {run_from_s} to {run_to_s} s, too few to compare"
        ));
    }
    let places = times_s[covered.clone()].iter();
    let places: Vec<Place> = places.map(|&t| Place::of(time, t, slack)).collect();
    let at_own = |place: &&Place| matches!(place, Place::At(_));
    let own = places.iter().filter(at_own).count();
    let interpolated = places.len() - own;
    let mut time_series = TimeSeries::new(times_s.to_vec()).map_err(ForeignError::unreadable)?;
    let mut restores: Option<(f64, String)> = None;
    for channel in foreign.channels() {
        let values = &channel.values[stretch.clone()];
        let mut column = vec![f64::NAN; times_s.len()];
        for (slot, place) in column[covered.clone()].iter_mut().zip(&places) {
            *slot = place.value(time, values, how.method);
        }
        if interpolated > 0
            && let Some(error) = restoring(time, values, how.method)
            && restores.as_ref().is_none_or(|(worst, _)| error > *worst)
        {
            restores = Some((error, channel.name.clone()));
        }
        time_series
            .push(channel.name.clone(), column)
            .map_err(ForeignError::unreadable)?;
    }
    Ok(Resampled {
        time_series,
        covers_s: [times_s[covered.start], times_s[covered.end - 1]],
        own,
        interpolated,
        restores,
        gaps_s,
    })
}

/// Position of a time among samples.
enum Place {
    At(usize),
    /// Time inside the interval that begins with this sample.
    Between(usize, f64),
}

impl Place {
    fn of(time: &[f64], t: f64, slack: f64) -> Self {
        let after = time.partition_point(|&x| x < t);
        let near = |k: usize| time.get(k).is_some_and(|x| (x - t).abs() <= slack);
        if near(after) {
            Self::At(after)
        } else if after > 0 && near(after - 1) {
            Self::At(after - 1)
        } else {
            Self::Between(after.clamp(1, time.len().max(2) - 1) - 1, t)
        }
    }

    fn value(&self, time: &[f64], values: &[f64], method: Method) -> f64 {
        match *self {
            Self::At(k) => values[k],
            Self::Between(k, t) => between(time, values, k, t, method),
        }
    }
}

/// Evaluates the polynomial through the samples around the interval [k, k+1] at `t`.
fn between(time: &[f64], values: &[f64], k: usize, t: f64, method: Method) -> f64 {
    let around = match method {
        Method::Linear => k..k + 2,
        Method::Cubic => {
            let from = k.saturating_sub(1).min(time.len().saturating_sub(4));
            from..from + 4
        }
    };
    let around = around.start..around.end.min(time.len());
    let term = |i: usize| {
        let others = around.clone().filter(|&j| j != i);
        let factors = others.map(|j| (t - time[j]) / (time[i] - time[j]));
        factors.product::<f64>() * values[i]
    };
    around.clone().map(term).sum()
}

/// Returns the relative L2 error of restoring every second sample from the others; `None` with too few.
fn restoring(time: &[f64], values: &[f64], method: Method) -> Option<f64> {
    let half = |list: &[f64]| list.iter().copied().step_by(2).collect::<Vec<f64>>();
    let (kept_time, kept) = (half(time), half(values));
    if kept.len() < 4 {
        return None;
    }
    let left_out = (1..time.len().saturating_sub(1)).step_by(2);
    let restored = |k: usize| between(&kept_time, &kept, k / 2, time[k], method);
    let both = left_out.map(|k| (restored(k), values[k]));
    let (restored, own): (Vec<f64>, Vec<f64>) = both.unzip();
    let error = relative_l2(&restored.as_slice().into(), &own.as_slice().into(), 0.0);
    Some(error).filter(|value| value.is_finite())
}

/// Evaluates the cubic at a time within the samples.
pub(super) fn value_at(time: &[f64], values: &[f64], t: f64) -> f64 {
    Place::of(time, t, 0.0).value(time, values, Method::Cubic)
}

/// Returns the upper median of the values; 0 if there are none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn spacings(time: &[f64]) -> Vec<f64> {
    time.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Median of the spacings, s.
pub(super) fn usual_spacing(time: &[f64]) -> f64 {
    median(spacings(time))
}

/// Returns the longest part without a gap, and all gaps. A gap is a spacing of more than `longest` neighbouring spacings.
fn longest_stretch(foreign: &TimeSeries, longest: f64) -> (Range<usize>, Vec<[f64; 2]>) {
    let time = foreign.time_s();
    let spacings = spacings(time);
    let around = |k: usize| {
        let before = &spacings[k.saturating_sub(AROUND)..k];
        let after = &spacings[k + 1..(k + 1 + AROUND).min(spacings.len())];
        // Larger of the two sides, because short steps end where long ones begin.
        median(before.to_vec()).max(median(after.to_vec()))
    };
    let deviation = |values: &[f64]| {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        (squares / count).sqrt()
    };
    let channels = foreign.channels().iter().map(|channel| {
        let values = channel.values.as_slice();
        (values, STRAIGHT * deviation(values))
    });
    let channels: Vec<(&[f64], f64)> = channels.collect();
    let runs_straight = |k: usize| {
        let slope = |values: &[f64], k: usize| Some((values.get(k + 1)? - values[k]) / spacings[k]);
        channels.iter().all(|&(values, most)| {
            let across = slope(values, k).unwrap_or(f64::NAN);
            let off = |side: Option<usize>| {
                let slope = side.and_then(|side| slope(values, side));
                (slope.unwrap_or(f64::NAN) - across).abs() * spacings[k]
            };
            off(k.checked_sub(1)) <= most && off(Some(k + 1)) <= most
        })
    };
    let is_gap = |k: usize| {
        let around = around(k);
        around > 0.0 && spacings[k] > longest * around * (1.0 + SAME) && !runs_straight(k)
    };
    let (mut best, mut start, mut gaps) = (0..0, 0, Vec::new());
    for k in 1..=time.len() {
        if k < time.len() && !is_gap(k - 1) {
            continue;
        }
        if k - start > best.len() {
            best = start..k;
        }
        if k < time.len() {
            gaps.push([time[k - 1], time[k]]);
        }
        start = k;
    }
    (best, gaps)
}
