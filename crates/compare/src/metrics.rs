//! How far two courses are apart.
//!
//! For a pair (a, b) no engine is the truth, so every denominator is **the larger of the two**:
//! relative L2 = RMS(a - b) / max(RMS a, RMS b), and so on. Swapping the engines changes nothing,
//! scaling both changes nothing, and only two all-zero courses would divide 0 by 0: they agree, 0.
//! Against the usual denominator, the RMS of one of them, the figure differs by no more than its
//! own size: 1e-4 stays 1e-4 within 1e-8.

use serde::Serialize;

use crate::sprague_geers::{self, SpragueGeers};
use crate::statistics::{self, View};

/// Every metric of one quantity of a pair. `None` where a value is not finite or a course is
/// empty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairMetrics {
    /// RMS(a - b) / max(RMS a, RMS b) over all channels and samples.
    pub relative_l2: Option<f64>,
    /// max |a - b| / max(peak a, peak b).
    pub relative_linf: Option<f64>,
    /// RMS(a - b), in the quantity's unit.
    pub difference_rms: Option<f64>,
    /// max |a - b|, in the quantity's unit.
    pub difference_max: Option<f64>,
    /// Where the largest difference is.
    pub worst: Option<WorstSample>,
    /// The larger of the two peaks, in the quantity's unit: the scale of the comparison.
    pub larger_peak: Option<f64>,
    /// Relative L2 over the channels of the window's last sample alone.
    pub end_value: Option<f64>,
    /// |mean a - mean b| / max(|mean a|, |mean b|).
    pub mean_difference: Option<f64>,
    /// |peak a - peak b| / max.
    pub peak_difference: Option<f64>,
    /// |RMS a - RMS b| / max.
    pub rms_difference: Option<f64>,
    /// mean a / mean b; `None` for a zero denominator.
    pub mean_ratio: Option<f64>,
    /// peak a / peak b.
    pub peak_ratio: Option<f64>,
    /// RMS a / RMS b.
    pub rms_ratio: Option<f64>,
    /// Sprague-Geers of `a` measured on `b`; `None` where one of them is zero throughout.
    pub sprague_geers: Option<SpragueGeers>,
    /// Free of direction: sqrt(M^2 + P^2) with M = larger RMS / smaller RMS - 1.
    pub sprague_geers_c: Option<f64>,
}

/// The sample where two courses are furthest apart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstSample {
    /// Channel number within the quantity.
    pub channel: usize,
    /// Time, s.
    pub time_s: f64,
}

impl PairMetrics {
    /// All metrics of two views of one shape; `time_s` are the window's sample times.
    ///
    /// `None` if the shapes differ or `time_s` has another length.
    #[must_use]
    pub fn of(a: &View<'_>, b: &View<'_>, time_s: &[f64]) -> Option<Self> {
        let fits = |view: &View<'_>| view.channels().iter().all(|c| c.len() == time_s.len());
        if !a.same_shape(b) || !fits(a) || !fits(b) {
            return None;
        }
        let means = a.mean().zip(b.mean());
        let peaks = a.peak().zip(b.peak());
        let squares = a.rms().zip(b.rms());
        let differences = || a.values().zip(b.values()).map(|(a, b)| a - b);
        let difference_max = statistics::peak(differences());
        let difference_rms = difference_max.and_then(|peak| statistics::rms(differences(), peak));
        Some(Self {
            relative_l2: difference_rms
                .zip(squares)
                .and_then(|(d, both)| over_larger(d, both)),
            relative_linf: difference_max
                .zip(peaks)
                .and_then(|(d, both)| over_larger(d, both)),
            difference_rms,
            difference_max,
            worst: worst(a, b, time_s),
            larger_peak: peaks.map(|(a, b)| a.max(b)),
            end_value: end_value(a, b),
            mean_difference: means.and_then(apart),
            peak_difference: peaks.and_then(apart),
            rms_difference: squares.and_then(apart),
            mean_ratio: means.and_then(ratio),
            peak_ratio: peaks.and_then(ratio),
            rms_ratio: squares.and_then(ratio),
            sprague_geers: sprague_geers::sprague_geers(a, b),
            sprague_geers_c: sprague_geers::comprehensive(a, b),
        })
    }
}

/// `difference` over the larger magnitude of the two; 0 for 0/0, `None` if not finite.
fn over_larger(difference: f64, (a, b): (f64, f64)) -> Option<f64> {
    let larger = a.abs().max(b.abs());
    if difference == 0.0 {
        return larger.is_finite().then_some(0.0);
    }
    Some(difference.abs() / larger).filter(|value| value.is_finite())
}

/// Relative difference of two figures, free of direction.
fn apart((a, b): (f64, f64)) -> Option<f64> {
    over_larger(a - b, (a, b))
}

/// a / b; `None` unless finite.
fn ratio((a, b): (f64, f64)) -> Option<f64> {
    Some(a / b).filter(|value| value.is_finite())
}

/// Relative L2 of the last sample over all channels.
fn end_value(a: &View<'_>, b: &View<'_>) -> Option<f64> {
    let last = |view: &View<'_>| {
        view.channels()
            .iter()
            .map(|c| c.last().copied())
            .collect::<Option<Vec<_>>>()
    };
    let (a, b) = (last(a)?, last(b)?);
    let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
    let rms = |values: &[f64]| View::new(vec![values]).rms();
    over_larger(rms(&differences)?, (rms(&a)?, rms(&b)?))
}

fn worst(a: &View<'_>, b: &View<'_>, time_s: &[f64]) -> Option<WorstSample> {
    let mut found: Option<(f64, WorstSample)> = None;
    for (channel, (a, b)) in a.channels().iter().zip(b.channels()).enumerate() {
        for ((a, b), &time_s) in a.iter().zip(*b).zip(time_s) {
            let difference = (a - b).abs();
            if !difference.is_finite() {
                return None;
            }
            if found
                .as_ref()
                .is_none_or(|(largest, _)| difference > *largest)
            {
                found = Some((difference, WorstSample { channel, time_s }));
            }
        }
    }
    found.map(|(_, sample)| sample)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
