//! Onto the sample times of a run.
//!
//! Where the file has a sample at a time of the run, it is taken as it is. Elsewhere values come from
//! the cubic through the four nearest samples (or the straight line). What that may cost is measured
//! on the data itself: every second sample is left out and restored from the others, which errs by
//! more than the interpolation that is used.

use std::ops::Range;

use super::error::ForeignError;
use super::map::{Method, Resampling};
use crate::TimeSeries;
use crate::norms::relative_l2;

/// A time counts as the file's own within this share of its spacing: a rounding.
const SAME: f64 = 1e-6;

/// Foreign time series on the times of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// All times of the run; NaN where the file says nothing.
    pub time_series: TimeSeries,
    /// What the file covers of the run, s.
    pub covers_s: [f64; 2],
    /// Times of the run that were the file's own.
    pub own: usize,
    /// Times of the run that were interpolated.
    pub interpolated: usize,
    /// Of the column that suffers most: relative L2 error of restoring left-out samples, and its name.
    /// `None` if nothing was interpolated.
    pub restores: Option<(f64, String)>,
    /// Gaps of the file that were not bridged, s: only the longest stretch without one is used.
    pub gaps_s: Vec<[f64; 2]>,
}

/// Puts `foreign` onto `times_s` (increasing).
///
/// # Errors
/// The two have no time in common.
pub fn resample(
    foreign: &TimeSeries,
    times_s: &[f64],
    how: Resampling,
) -> Result<Resampled, ForeignError> {
    let own_times = foreign.time_s();
    let (stretch, gaps_s) = longest_stretch(own_times, how.longest_gap);
    let time = &own_times[stretch.clone()];
    let ends = |times: &[f64]| {
        (
            times.first().copied().unwrap_or(0.0),
            times.last().copied().unwrap_or(0.0),
        )
    };
    let (from_s, to_s) = ends(time);
    let slack = SAME * usual_spacing(time);
    let covered = times_s.partition_point(|&t| t < from_s - slack)
        ..times_s.partition_point(|&t| t <= to_s + slack);
    if covered.is_empty() || time.is_empty() {
        let (run_from_s, run_to_s) = ends(times_s);
        return Err(ForeignError(format!(
            "the file covers {from_s} to {to_s} s, none of it in the run's {run_from_s} to {run_to_s} s; set time.unit and \
             time.offset_s of the map"
        )));
    }
    let places: Vec<Place> = times_s[covered.clone()]
        .iter()
        .map(|&t| Place::of(time, t, slack))
        .collect();
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

/// Where a time falls among samples.
enum Place {
    At(usize),
    /// In the interval that begins with this sample, at this time.
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

/// The polynomial through the samples around the interval [k, k+1], at `t`.
fn between(time: &[f64], values: &[f64], k: usize, t: f64, method: Method) -> f64 {
    let around = match method {
        Method::Linear => k..k + 2,
        Method::Cubic => {
            let from = k.saturating_sub(1).min(time.len().saturating_sub(4));
            from..from + 4
        }
    };
    let around = around.start..around.end.min(time.len());
    around
        .clone()
        .map(|i| {
            let others = around.clone().filter(|&j| j != i);
            let weight: f64 = others
                .map(|j| (t - time[j]) / (time[i] - time[j]))
                .product();
            weight * values[i]
        })
        .sum()
}

/// Relative L2 error of restoring every second sample from the others; `None` with too few.
fn restoring(time: &[f64], values: &[f64], method: Method) -> Option<f64> {
    let half = |list: &[f64]| list.iter().copied().step_by(2).collect::<Vec<f64>>();
    let (kept_time, kept) = (half(time), half(values));
    if kept.len() < 4 {
        return None;
    }
    let left_out = (1..time.len().saturating_sub(1)).step_by(2);
    let (restored, own): (Vec<f64>, Vec<f64>) = left_out
        .map(|k| {
            (
                between(&kept_time, &kept, k / 2, time[k], method),
                values[k],
            )
        })
        .unzip();
    let error = relative_l2(&restored.as_slice().into(), &own.as_slice().into(), 0.0);
    Some(error).filter(|value| value.is_finite())
}

/// Median of the spacings, s.
fn usual_spacing(time: &[f64]) -> f64 {
    let mut spacings: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    spacings.sort_by(f64::total_cmp);
    spacings.get(spacings.len() / 2).copied().unwrap_or(0.0)
}

/// The longest stretch without a gap of more than `longest` usual spacings, and all such gaps.
fn longest_stretch(time: &[f64], longest: f64) -> (Range<usize>, Vec<[f64; 2]>) {
    let most = longest * usual_spacing(time) * (1.0 + SAME);
    let (mut best, mut start, mut gaps) = (0..0, 0, Vec::new());
    for k in 1..=time.len() {
        let ends = k == time.len() || time[k] - time[k - 1] > most;
        if !ends {
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

#[cfg(test)]
mod tests {
    use super::*;

    const CUBIC: Resampling = Resampling {
        method: Method::Cubic,
        longest_gap: 4.0,
    };

    fn wave(times: &[f64]) -> TimeSeries {
        let mut time_series = TimeSeries::new(times.to_vec()).unwrap();
        time_series
            .push(
                "a_n",
                times.iter().map(|t| 5.0 + (40.0 * t).sin()).collect(),
            )
            .unwrap();
        time_series
    }

    fn even(count: usize, step: f64, from: f64) -> Vec<f64> {
        (0..count).map(|k| from + k as f64 * step).collect()
    }

    #[test]
    fn own_times_are_taken_as_they_are() {
        let times = even(101, 1e-3, 0.0);
        let found = resample(&wave(&times), &times, CUBIC).unwrap();
        assert_eq!(
            (found.time_series, found.own, found.interpolated),
            (wave(&times), 101, 0)
        );
        assert!(found.restores.is_none() && found.gaps_s.is_empty());
    }

    /// The error that is told is larger than the one that is made, by any method.
    #[test]
    fn the_told_error_bounds_the_made_one() {
        let times = even(200, 1e-3, 0.0);
        let exact = wave(&times);
        for (method, most) in [(Method::Cubic, 1e-5), (Method::Linear, 1e-3)] {
            let found = resample(
                &wave(&even(300, 1.7e-3, -0.01)),
                &times,
                Resampling { method, ..CUBIC },
            )
            .unwrap();
            assert!(found.interpolated > 150);
            let [made, exact] =
                [&found.time_series, &exact].map(|c| c.channels()[0].values.as_slice());
            let made = relative_l2(&made.into(), &exact.into(), 0.0);
            let told = found.restores.unwrap().0;
            assert!(made < told && told < most, "{method:?}: {made:e} {told:e}");
        }
    }

    #[test]
    fn what_is_not_covered_stays_empty() {
        let times = even(101, 1e-3, 0.0);
        let found = resample(&wave(&even(51, 1e-3, 0.02)), &times, CUBIC).unwrap();
        assert!(
            (found.covers_s[0] - 0.02).abs() < 1e-12 && (found.covers_s[1] - 0.07).abs() < 1e-12
        );
        let values = &found.time_series.channels()[0].values;
        assert!(values[..20].iter().chain(&values[71..]).all(|v| v.is_nan()));
        assert!(values[20..71].iter().all(|v| v.is_finite()));
        let apart = resample(&wave(&even(51, 1e-3, 3.0)), &times, CUBIC).unwrap_err();
        assert!(apart.to_string().contains("time.offset_s"), "{apart}");
    }

    #[test]
    fn long_gaps_are_not_bridged_and_short_ones_are() {
        let times = even(101, 1e-3, 0.0);
        let missing = |range: Range<usize>| -> Vec<f64> {
            let kept = times.iter().enumerate().filter(|(k, _)| !range.contains(k));
            kept.map(|(_, t)| *t).collect()
        };
        let short = resample(&wave(&missing(40..42)), &times, CUBIC).unwrap();
        assert_eq!((short.interpolated, short.gaps_s.len()), (2, 0));
        let long = resample(&wave(&missing(30..40)), &times, CUBIC).unwrap();
        assert_eq!(long.gaps_s.len(), 1);
        assert!(
            (long.covers_s[0] - 0.04).abs() < 1e-12,
            "{:?}",
            long.covers_s
        );
    }
}
