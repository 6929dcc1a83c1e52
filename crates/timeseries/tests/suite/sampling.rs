//! Signals between samples.

use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::internals::{EVEN, cubic, divided};
use pinwheel_timeseries::sampling::{Between, Figures, point};

const NAME: &str = "force_n_0";

/// Samples `of` at equal steps over 0 to 20.
fn sampled(of: &dyn Fn(f64) -> f64, steps: u32) -> Figures {
    let times: Vec<f64> = (0..=steps)
        .map(|k| 20.0 * f64::from(k) / f64::from(steps))
        .collect();
    let values = times.iter().map(|&t| of(t)).collect();
    let mut time_series = TimeSeries::new(times).unwrap();
    time_series.push(NAME, values).unwrap();
    let all = 0..time_series.len();
    Figures::of(&time_series, "force_n", &[NAME], all).unwrap()
}

/// The weights are exact for polynomials, at equal spacings or not.
#[test]
fn weights_are_those_of_polynomials() {
    let at = [-1.3, 0.0, 1.0, 1.7];
    let weights = cubic(&at, 1);
    for (power, exact) in [(0, 1.0), (1, 0.5), (2, 1.0 / 3.0), (3, 0.25)] {
        let sum: f64 = at.iter().zip(weights).map(|(t, w)| w * t.powi(power)).sum();
        assert!((sum - exact).abs() < 1e-14, "{power}: {sum}");
    }
    let ends = [([0.0, 1.0, 1.5, 3.0], 0), ([-2.0, -0.5, 0.0, 1.0], 2)];
    for (at, zero) in ends {
        let weights = cubic(&at, zero);
        let sum: f64 = at.iter().zip(weights).map(|(t, w)| w * t * t * t).sum();
        assert!((sum - 0.25).abs() < 1e-14, "{zero}: {sum}");
    }
    let even = divided(&[-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0]);
    for (one, other) in even.iter().zip(EVEN) {
        assert!((one.abs() - other.abs()).abs() < 1e-12);
    }
    let uneven = [-2.9, -2.0, -1.2, 0.0, 1.0, 2.4, 3.0];
    for power in 0..6 {
        let parts = uneven.iter().zip(divided(&uneven));
        let sum: f64 = parts.map(|(t, w)| w * t.powi(power)).sum();
        assert!(sum.abs() < 1e-9, "{power}: {sum}");
    }
}

/// The stated sampling error bounds the actual one, whether samples resolve an oscillation or not, and is small if they do.
#[test]
fn what_sampling_leaves_is_stated() {
    let of = |t: f64| 1.0 + (3.0 * t + 0.2).sin();
    let mean = 1.0 + ((0.2_f64).cos() - (60.2_f64).cos()) / 60.0;
    for steps in [19, 23, 29, 40, 67, 110, 171, 400, 1000] {
        let sample = sampled(&of, steps);
        let (figures, off) = (sample.statistics, sample.sampling);
        assert!(
            (figures.mean - mean).abs() <= off.mean + 1e-6,
            "{steps}: {sample:?}"
        );
        let missed = 2.0 - figures.peak;
        assert!((missed).abs() <= off.peak + 1e-9, "{steps}: {sample:?}");
        if steps >= 171 {
            assert!(off.mean < 1e-3 && off.peak < 4e-3, "{steps}: {sample:?}");
        }
    }
}

/// Points between samples give sharp figures where samples alone do not; only those within the window count.
#[test]
fn points_between_samples_are_detected() {
    let of = |t: f64| (2.0 * t).sin();
    let mut between = Between::new(&["force_n"], 11);
    // More than one chunk, and pairs of points close to each other.
    for k in 0..=2000 {
        let t = f64::from(k) * 0.01;
        between.push(t, k % 200 == 0, &[point([of(t)].into_iter())]);
        between.push(t + 1e-9, false, &[point([of(t + 1e-9)].into_iter())]);
    }
    let times: Vec<f64> = (0..=10).map(|k| 2.0 * f64::from(k)).collect();
    let mut time_series = TimeSeries::new(times.clone()).unwrap();
    let values = times.iter().map(|&t| of(t)).collect();
    time_series.push(NAME, values).unwrap();
    let samples = |series: &TimeSeries, window| Figures::of(series, "force_n", &[NAME], window);
    let rare = samples(&time_series, 0..11).unwrap();
    assert!(rare.sampling.mean > 0.1, "{rare:?}");
    let time_series = time_series.with_between(between.finish());
    let all = samples(&time_series, 0..11).unwrap();
    assert!((all.statistics.peak - 1.0).abs() < 1e-8, "{all:?}");
    let mean = (1.0 - (40.0_f64).cos()) / 40.0;
    assert!((all.statistics.mean - mean).abs() < 1e-8, "{all:?}");
    assert!(
        all.sampling.mean < 1e-6 && all.sampling.peak < 1e-6,
        "{all:?}"
    );
    // A single sample has no mean over time, but no NaN either.
    let one = samples(&time_series, 4..5).unwrap();
    assert_eq!(one.statistics.mean, of(8.0), "{one:?}");
    // From 2 to 4 s the signal passes its minimum and its maximum, neither at a sample.
    let part = samples(&time_series, 1..3).unwrap().statistics;
    assert!(
        (part.min + 1.0).abs() < 1e-8 && (part.max - of(3.92699)).abs() < 1e-8,
        "{part:?}"
    );
}
