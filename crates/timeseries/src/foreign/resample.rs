//! Onto the sample times of a run.
//!
//! Where the file has a sample at a time of the run, it is taken as it is. Elsewhere values come from
//! the cubic through the four nearest samples (or the straight line). What that may cost is measured
//! on the data itself: every second sample is left out and restored from the others, which errs by
//! more than the interpolation that is used.
//!
//! Over a gap nothing is interpolated. Solvers of variable step write bursts of short steps and long ones where little happens, so
//! a spacing is held against those around it, and is none where the signals run straight on across it.

use std::ops::Range;

use super::error::ForeignError;
use super::map::{Method, Resampling};
use crate::TimeSeries;
use crate::norms::relative_l2;

/// A time counts as the file's own within this share of its spacing: a rounding.
const SAME: f64 = 1e-6;
/// Spacings on each side that a gap is held against.
const AROUND: usize = 4;
/// A signal runs straight on across a gap if the slopes at both ends carry it past the other end by less than this share of
/// its standard deviation.
const STRAIGHT: f64 = 0.05;
/// Rows within the run at least, unless it has as few samples there.
const FEWEST: usize = 10;

/// Foreign time series on the times of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// All times of the run; NaN where the file says nothing.
    pub time_series: TimeSeries,
    /// Start and end of the part of the run that the file covers, s.
    pub covers_s: [f64; 2],
    /// Times of the run that were the file's own.
    pub own: usize,
    /// Times of the run that were interpolated.
    pub interpolated: usize,
    /// Largest relative L2 error of restoring left-out samples, over the columns, and the name of its column. `None` if
    /// nothing was interpolated.
    pub restores: Option<(f64, String)>,
    /// Gaps of the file that were not bridged, s: only the longest stretch without one is used.
    pub gaps_s: Vec<[f64; 2]>,
}

/// Puts `foreign` onto `times_s` (increasing).
///
/// # Errors
/// The two have no time in common, or the file's rows are too dense or too rare for the run.
pub fn resample(
    foreign: &TimeSeries,
    times_s: &[f64],
    how: Resampling,
) -> Result<Resampled, ForeignError> {
    let own_times = foreign.time_s();
    let (stretch, gaps_s) = longest_stretch(foreign, how.longest_gap);
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

/// The value at any time within the samples, by the cubic.
pub(super) fn value_at(time: &[f64], values: &[f64], t: f64) -> f64 {
    Place::of(time, t, 0.0).value(time, values, Method::Cubic)
}

/// The upper one of the values in the middle; 0 without any.
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

/// The longest stretch without a gap, which is a spacing of more than `longest` times those around it, and all gaps.
fn longest_stretch(foreign: &TimeSeries, longest: f64) -> (Range<usize>, Vec<[f64; 2]>) {
    let time = foreign.time_s();
    let spacings = spacings(time);
    let around = |k: usize| {
        let before = &spacings[k.saturating_sub(AROUND)..k];
        let after = &spacings[k + 1..(k + 1 + AROUND).min(spacings.len())];
        // The larger one: short steps end where long ones begin.
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
    /// Long steps, a burst of short ones in the middle of them, and growing ones: all of it is one stretch.
    #[test]
    fn regress_variable_steps_are_no_gaps() {
        let mut times = vec![0.0];
        let mut go = |step: f64, count: usize| {
            for _ in 0..count {
                let last: f64 = times[times.len() - 1];
                times.push(last + step);
            }
        };
        go(1e-4, 100);
        go(5e-6, 400);
        // As a solver's step grows after an event.
        for grown in 0..4 {
            go(5e-6 * f64::from(1 << grown), 2);
        }
        go(1e-4, 80);
        // An event and its two rows.
        go(3e-6, 1);
        go(9.7e-5, 1);
        go(1e-4, 5);
        let end = times[times.len() - 1];
        let found = resample(&wave(&times), &even(101, end / 100.0, 0.0), CUBIC).unwrap();
        assert_eq!((found.gaps_s.len(), found.covers_s), (0, [0.0, end]));
        // Nor is a long step among short ones where nothing happens, but it is one where something does.
        let mut rows: Vec<f64> = even(200, 1e-5, 0.0);
        rows.extend(even(200, 1e-5, 0.004));
        let run = even(50, 1e-4, 0.0);
        let of = |signal: fn(f64) -> f64| {
            let mut series = TimeSeries::new(rows.clone()).unwrap();
            let values = rows.iter().map(|t| signal(*t)).collect();
            series.push("a_n", values).unwrap();
            resample(&series, &run, CUBIC).unwrap().gaps_s.len()
        };
        assert_eq!((of(|t| 3.0 * t), of(|t| (2000.0 * t).sin())), (0, 1));
    }

    /// Two gaps in a row are two, each held against what lies around both.
    #[test]
    fn regress_gaps_side_by_side_are_seen() {
        let times = even(101, 1e-3, 0.0);
        let kept = times.iter().enumerate();
        let kept = kept.filter(|(k, _)| !(30..60).contains(k) || *k == 45);
        let kept: Vec<f64> = kept.map(|(_, t)| *t).collect();
        let found = resample(&wave(&kept), &times, CUBIC).unwrap();
        assert_eq!(found.gaps_s.len(), 2);
    }

    #[test]
    fn bad_input_rows_that_never_meet_the_run_are_refused() {
        let times = even(201, 1e-4, 0.0);
        for (step, part) in [
            (1e-300, "all rows of the file"),
            (0.01, "has 3 rows"),
            (1e296, "has 1 rows"),
        ] {
            let error = resample(&wave(&even(201, step, 0.0)), &times, CUBIC).unwrap_err();
            let error = error.to_string();
            assert!(
                error.contains(part) && error.contains("time.factor"),
                "{error}"
            );
        }
        // A record that ends soon after the run began is compared where it is.
        let few = resample(&wave(&even(205, 1e-4, -0.02)), &times, CUBIC).unwrap();
        assert_eq!(few.own, 5);
    }
}
