//! Changes that must not affect a metric: order of engines, unit, order of channels.

use super::common;

use common::{context, participant, time_series};
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::{Rules, SharedModel, compare};
use pinwheel_timeseries::norms::{Statistics, View};
use proptest::prelude::*;

/// Generates two groups of `channels` channels with `samples` values each.
fn two_groups() -> impl Strategy<Value = (Vec<Vec<f64>>, Vec<Vec<f64>>)> {
    (1..5usize, 1..40usize).prop_flat_map(|(channels, samples)| {
        let channel = prop::collection::vec(-200.0..200.0f64, samples);
        let group = prop::collection::vec(channel, channels);
        (group.clone(), group)
    })
}

fn of(a: &[Vec<f64>], b: &[Vec<f64>]) -> PairMetrics {
    let time: Vec<f64> = (0..a[0].len()).map(|k| k as f64).collect();
    PairMetrics::of(
        &View::new(a.iter().map(Vec::as_slice).collect()),
        &View::new(b.iter().map(Vec::as_slice).collect()),
        &time,
    )
    .unwrap()
}

/// Returns the figures from which verdicts are made.
fn judged(metrics: &PairMetrics) -> [f64; 7] {
    [
        metrics.relative_l2,
        metrics.relative_linf,
        metrics.end_value,
        metrics.mean_difference,
        metrics.peak_difference,
        metrics.rms_difference,
        metrics.sprague_geers_c,
    ]
    .map(|value| value.unwrap_or(-1.0))
}

fn assert_close(left: [f64; 7], right: [f64; 7], tolerance: f64) {
    for (l, r) in left.iter().zip(right) {
        assert!(
            (l - r).abs() <= tolerance * (1.0 + l.abs()),
            "{left:?}\n{right:?}"
        );
    }
}

fn scaled(group: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    group
        .iter()
        .map(|c| c.iter().map(|v| v * factor).collect())
        .collect()
}

proptest! {
    #[test]
    fn swapping_the_engines_changes_no_verdict((a, b) in two_groups()) {
        assert_close(judged(&of(&a, &b)), judged(&of(&b, &a)), 0.0);
        let (ab, ba) = (of(&a, &b), of(&b, &a));
        if let (Some(one), Some(other)) = (ab.rms_ratio, ba.rms_ratio) {
            prop_assert!((one * other - 1.0).abs() < 1e-14);
        }
        let phases = (ab.sprague_geers.map(|s| s.phase), ba.sprague_geers.map(|s| s.phase));
        prop_assert_eq!(phases.0, phases.1);
    }

    #[test]
    fn the_unit_changes_nothing((a, b) in two_groups(), factor in 1e-6..1e6f64, sign in prop::bool::ANY) {
        let factor = if sign { factor } else { -factor };
        let other = of(&scaled(&a, factor), &scaled(&b, factor));
        // The mean of almost cancelling values is rounding: compared only where it is not.
        let (mut left, mut right) = (judged(&of(&a, &b)), judged(&other));
        (left[3], right[3]) = (0.0, 0.0);
        assert_close(left, right, 1e-11);
    }

    #[test]
    fn the_order_of_channels_changes_nothing((a, b) in two_groups()) {
        let reversed = |group: &[Vec<f64>]| group.iter().rev().cloned().collect::<Vec<_>>();
        let (mut left, mut right) = (judged(&of(&a, &b)), judged(&of(&reversed(&a), &reversed(&b))));
        (left[3], right[3]) = (0.0, 0.0);
        assert_close(left, right, 1e-12);
    }

    #[test]
    fn bounds((a, b) in two_groups()) {
        let metrics = of(&a, &b);
        // By the triangle inequality no difference exceeds twice the larger of the two.
        for value in judged(&metrics).iter().take(3) {
            prop_assert!((0.0..=2.0 + 1e-12).contains(value), "{metrics:?}");
        }
        let phase = metrics.sprague_geers.map_or(0.0, |s| s.phase);
        prop_assert!((0.0..=1.0).contains(&phase));
        // Equal time series agree exactly.
        let same = of(&a, &a);
        prop_assert_eq!(judged(&same), [0.0; 7]);
    }

    #[test]
    fn sprague_geers_agrees_with_its_formula((a, b) in two_groups()) {
        let mean = |x: &[Vec<f64>], y: &[Vec<f64>]| -> f64 {
            let products = x.iter().flatten().zip(y.iter().flatten()).map(|(x, y)| x * y);
            products.sum::<f64>() / (x.len() * x[0].len()) as f64
        };
        let (cc, mm, mc) = (mean(&a, &a), mean(&b, &b), mean(&a, &b));
        prop_assume!(cc > 1e-6 && mm > 1e-6);
        let computed = of(&a, &b).sprague_geers.unwrap();
        prop_assert!((computed.magnitude - ((cc / mm).sqrt() - 1.0)).abs() < 1e-10 * (1.0 + computed.magnitude));
        let phase = (mc / (mm * cc).sqrt()).clamp(-1.0, 1.0).acos() / std::f64::consts::PI;
        // acos is accurate to 1e-8 near its ends.
        prop_assert!((computed.phase - phase).abs() < 1e-7, "{} {phase}", computed.phase);
    }

    #[test]
    fn statistics_are_ordered((a, _) in two_groups()) {
        let figures = Statistics::of(&View::new(a.iter().map(Vec::as_slice).collect())).unwrap();
        prop_assert!(figures.min <= figures.mean + 1e-12 && figures.mean <= figures.max + 1e-12);
        prop_assert!(figures.mean.abs() <= figures.rms * (1.0 + 1e-12) && figures.rms <= figures.peak * (1.0 + 1e-12));
        prop_assert_eq!(figures.peak, figures.max.abs().max(figures.min.abs()));
    }

    #[test]
    fn the_order_of_engines_changes_no_verdict(scale in 0.9999..1.0001f64) {
        let native = participant("native", SharedModel::Native, time_series(1.0));
        let rapier = participant("rapier", SharedModel::SharedLaw, time_series(scale));
        let one = compare(&context(), &[native.clone(), rapier.clone()], &Rules::default()).unwrap();
        let other = compare(&context(), &[rapier, native], &Rules::default()).unwrap();
        prop_assert_eq!(one.counts, other.counts);
        let worst = |comparison: &pinwheel_compare::Comparison| comparison.matrices[0].cells[0].result.difference;
        prop_assert_eq!(worst(&one), worst(&other));
    }
}
