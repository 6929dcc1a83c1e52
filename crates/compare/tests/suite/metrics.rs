//! Metrics of pairs.

use pinwheel_compare::metrics::*;
use pinwheel_timeseries::norms::View;

fn of(a: &[f64], b: &[f64]) -> PairMetrics {
    let time: Vec<f64> = (0..a.len()).map(|k| k as f64).collect();
    PairMetrics::of(&View::new(vec![a]), &View::new(vec![b]), &time).unwrap()
}

#[test]
fn known_values() {
    // RMS of (3, 4) is sqrt(12.5), of (3, 5) sqrt(17); difference (0, -1): RMS sqrt(0.5).
    let metrics = of(&[3.0, 4.0], &[3.0, 5.0]);
    let close = |value: Option<f64>, wanted: f64| (value.unwrap() - wanted).abs() < 1e-15;
    assert!(close(metrics.relative_l2, (0.5f64 / 17.0).sqrt()));
    assert!(close(metrics.relative_linf, 0.2));
    assert!(close(metrics.end_value, 0.2));
    assert!(close(metrics.mean_difference, 0.125));
    assert!(close(metrics.mean_ratio, 0.875));
    assert!(close(metrics.peak_ratio, 0.8));
    assert!(close(metrics.rms_ratio, (12.5f64 / 17.0).sqrt()));
    assert_eq!(
        metrics.worst,
        Some(WorstSample {
            channel: 0,
            time_s: 1.0
        })
    );
}

#[test]
fn the_table_is_in_order_and_complete() {
    for (k, row) in METRICS.iter().enumerate() {
        assert_eq!(row.metric as usize, k);
    }
    assert_eq!(Metric::of_pairs().count(), METRICS.len() - 1);
}

#[test]
fn the_sign_of_a_mean_difference() {
    let sign = |a: f64, b: f64| of(&[a, a], &[b, b]).signed_mean_difference();
    assert_eq!(sign(2.0, 1.0), Some(0.5));
    assert_eq!(sign(1.0, 2.0), Some(-0.5));
    assert_eq!(sign(-2.0, -1.0), Some(0.5), "larger magnitude");
    assert_eq!((sign(2.0, -1.0), sign(2.0, 0.0)), (None, None));
}

#[test]
fn peaks_of_a_group_are_over_the_group() {
    let (a, b) = (
        View::new(vec![&[1.0], &[-8.0]]),
        View::new(vec![&[10.0], &[-8.0]]),
    );
    let metrics = PairMetrics::of(&a, &b, &[0.0]).unwrap();
    assert_eq!(metrics.peak_ratio, Some(0.8));
    assert_eq!(metrics.relative_linf, Some(0.9));
    assert_eq!(
        metrics.worst,
        Some(WorstSample {
            channel: 0,
            time_s: 0.0
        })
    );
}

#[test]
fn zeros() {
    let both = of(&[0.0, 0.0], &[0.0, 0.0]);
    assert_eq!(both.relative_l2, Some(0.0));
    assert_eq!(both.mean_difference, Some(0.0));
    assert_eq!(both.mean_ratio, None);
    assert_eq!(both.sprague_geers_c, Some(0.0));
    let one = of(&[0.0, 0.0], &[1.0, 2.0]);
    assert_eq!((one.relative_l2, one.relative_linf), (Some(1.0), Some(1.0)));
    assert_eq!(one.sprague_geers, None);
}

#[test]
fn non_finite_empty_and_misshapen() {
    let spoiled = of(&[1.0, f64::NAN], &[1.0, 2.0]);
    assert_eq!(
        (spoiled.relative_l2, spoiled.end_value, spoiled.worst),
        (None, None, None)
    );
    let empty = of(&[], &[]);
    assert_eq!((empty.relative_l2, empty.end_value), (None, None));
    let (a, b) = (View::new(vec![&[1.0]]), View::new(vec![&[1.0], &[2.0]]));
    assert!(PairMetrics::of(&a, &b, &[0.0]).is_none());
    assert!(PairMetrics::of(&a, &a, &[0.0, 1.0]).is_none());
}
