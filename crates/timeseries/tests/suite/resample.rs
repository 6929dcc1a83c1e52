//! Records at the sample times of a run.

use std::ops::Range;

use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::foreign::{Method, Resampling, resample};
use pinwheel_timeseries::norms::relative_l2;

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
    let after = resample(&wave(&times), &times, CUBIC).unwrap();
    assert_eq!(
        (after.time_series, after.own, after.interpolated),
        (wave(&times), 101, 0)
    );
    assert!(after.restores.is_none() && after.gaps_s.is_empty());
}

/// The stated error exceeds the actual one, for any method.
#[test]
fn the_stated_error_bounds_the_actual_one() {
    let times = even(200, 1e-3, 0.0);
    let exact = wave(&times);
    for (method, most) in [(Method::Cubic, 1e-5), (Method::Linear, 1e-3)] {
        let after = resample(
            &wave(&even(300, 1.7e-3, -0.01)),
            &times,
            Resampling { method, ..CUBIC },
        )
        .unwrap();
        assert!(after.interpolated > 150);
        let [made, exact] = [&after.time_series, &exact].map(|c| c.channels()[0].values.as_slice());
        let made = relative_l2(&made.into(), &exact.into(), 0.0);
        let u = after.restores.unwrap().0;
        assert!(made < u && u < most, "{method:?}: {made:e} {u:e}");
    }
}

#[test]
fn what_is_not_covered_stays_empty() {
    let times = even(101, 1e-3, 0.0);
    let after = resample(&wave(&even(51, 1e-3, 0.02)), &times, CUBIC).unwrap();
    assert!((after.covers_s[0] - 0.02).abs() < 1e-12 && (after.covers_s[1] - 0.07).abs() < 1e-12);
    let values = &after.time_series.channels()[0].values;
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
/// Long steps with a burst of short ones between them, and growing ones, have no gap.
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
    // A solver's step grows after an event.
    for grown in 0..4 {
        go(5e-6 * f64::from(1 << grown), 2);
    }
    go(1e-4, 80);
    // Two rows of an event.
    go(3e-6, 1);
    go(9.7e-5, 1);
    go(1e-4, 5);
    let end = times[times.len() - 1];
    let after = resample(&wave(&times), &even(101, end / 100.0, 0.0), CUBIC).unwrap();
    assert_eq!((after.gaps_s.len(), after.covers_s), (0, [0.0, end]));
    // A long step among short ones is a gap only if the signal changes.
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

/// Two adjacent gaps are both detected, each compared with the spacings around both.
#[test]
fn regress_gaps_side_by_side_are_detected() {
    let times = even(101, 1e-3, 0.0);
    let kept = times.iter().enumerate();
    let kept = kept.filter(|(k, _)| !(30..60).contains(k) || *k == 45);
    let kept: Vec<f64> = kept.map(|(_, t)| *t).collect();
    let after = resample(&wave(&kept), &times, CUBIC).unwrap();
    assert_eq!(after.gaps_s.len(), 2);
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
    // A record that ends soon after the start of the run is compared there.
    let few = resample(&wave(&even(205, 1e-4, -0.02)), &times, CUBIC).unwrap();
    assert_eq!(few.own, 5);
}
