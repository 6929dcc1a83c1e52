//! Distances between two time series.
//!
//! No engine is the truth, so every denominator is **the larger of the two**: relative L2 = RMS(a - b) / max(RMS a, RMS b), and
//! so on. Swapping or scaling both time series changes nothing. Two all-zero time series agree: 0/0 counts as 0. Compared with
//! the usual denominator, the RMS of one time series, the relative change of the figure is its own size: 1e-4 stays 1e-4 within
//! 1e-8.

use serde::{Serialize, Serializer};

use crate::sprague_geers::{self, SpragueGeers};
use crate::uncertainty::Norm;
use pinwheel_timeseries::norms::{self, View};

/// Definition of a metric: names, uncertainty and value.
pub struct Row {
    /// Metric that the row describes.
    pub metric: Metric,
    /// Name of the metric in files, maps and on the terminal.
    pub key: &'static str,
    /// Name of the metric for readers.
    pub label: &'static str,
    /// Norm of the run's uncertainty that bounds the change of the metric.
    pub norm: Norm,
    /// Largest change of the metric under that uncertainty, both relative.
    sensitivity: f64,
    /// Value of the metric for a pair; `None` for metrics of one engine alone.
    pub of: fn(&PairMetrics) -> Option<f64>,
}

/// Defines all metrics, a row each.
macro_rules! metrics {
    ($($(#[$doc:meta])* $metric:ident $key:literal $label:literal $norm:ident $sensitivity:literal $of:expr;)*) => {
        /// Figure that is compared with a limit or an uncertainty. Metrics are relative, free of direction and never negative.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Metric {
            $($(#[$doc])* $metric,)*
        }

        /// All metrics, in the order of the variants.
        pub static METRICS: [Row; [$($key),*].len()] = [$(Row {
            metric: Metric::$metric,
            key: $key,
            label: $label,
            norm: Norm::$norm,
            sensitivity: $sensitivity,
            of: $of,
        }),*];
    };
}

metrics! {
    /// RMS of the difference over the larger of the two RMS, all channels jointly.
    RelativeL2 "relative-l2" "relative L2" L2 1.0 |m| m.relative_l2;
    /// Largest difference over the larger of the two peaks.
    RelativeLinf "relative-linf" "relative L\u{221e}" Linf 1.0 |m| m.relative_linf;
    /// Difference of the means over the larger mean.
    Mean "mean" "mean" Mean 1.0 |m| m.mean_difference;
    /// Difference of the peaks over the larger peak.
    Peak "peak" "peak" Peak 1.0 |m| m.peak_difference;
    /// Difference of the RMS values over the larger RMS value.
    Rms "rms" "rms" Rms 1.0 |m| m.rms_difference;
    /// Sprague-Geers comprehensive error C, magnitude taken larger over smaller. M moves by the relative L2 at most, the angle P pi
    /// as well: C by sqrt(1 + 1/pi^2).
    SpragueGeers "sprague-geers" "Sprague\u{2013}Geers C" L2 1.0495 |m| m.sprague_geers_c;
    /// Mean output torque of one engine against the load, over the load.
    MeanAgainstLoad "mean-against-load" "mean against the load" Mean 1.0 |_| None;
}

impl Metric {
    /// Returns the row of the metric in [`METRICS`].
    pub fn row(self) -> &'static Row {
        &METRICS[self as usize]
    }

    /// Returns the name in files, maps and on the terminal.
    pub fn key(self) -> &'static str {
        self.row().key
    }

    /// Returns the name for readers.
    pub fn label(self) -> &'static str {
        self.row().label
    }

    /// True if the metric compares two runs sample by sample, which is meaningless once rounding has driven two runs of one
    /// solver apart.
    pub fn is_pointwise(self) -> bool {
        matches!(self.row().norm, Norm::L2 | Norm::Linf)
    }

    /// Returns the value of the metric for a pair.
    pub(crate) fn of(self, metrics: &PairMetrics) -> Option<f64> {
        (self.row().of)(metrics)
    }

    /// Returns the largest ratio of the metric's change to the uncertainty that applies to it, both relative.
    pub(crate) fn sensitivity(self) -> f64 {
        self.row().sensitivity
    }

    /// Metrics that judge a pair, in the order of a report.
    pub fn of_pairs() -> impl Iterator<Item = Self> {
        let all = METRICS.iter().map(|row| row.metric);
        all.filter(|metric| *metric != Self::MeanAgainstLoad)
    }
}

impl Serialize for Metric {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

/// Every metric of one quantity of a pair; `None` where a value is not finite or a signal is empty.
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
    /// Sample with the largest difference.
    pub worst: Option<WorstSample>,
    /// The larger of the two peaks, in the quantity's unit: the scale of the comparison.
    pub larger_peak: Option<f64>,
    /// The larger of the two RMS values, in the quantity's unit.
    pub larger_rms: Option<f64>,
    /// The larger magnitude of the two means, in the quantity's unit.
    pub larger_mean: Option<f64>,
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
    /// Sprague-Geers error of `a` relative to `b`; `None` where `a` or `b` is zero throughout.
    pub sprague_geers: Option<SpragueGeers>,
    /// Sprague-Geers error without direction: sqrt(M^2 + P^2) with M = larger RMS / smaller RMS - 1.
    pub sprague_geers_c: Option<f64>,
}

/// Sample with the largest difference of two time series.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstSample {
    /// Channel number within the quantity.
    pub channel: usize,
    /// Time, s.
    pub time_s: f64,
}

impl PairMetrics {
    /// Evaluates all metrics of two views of one shape; `time_s` are the window's sample times, s.
    ///
    /// ```
    /// use pinwheel_compare::metrics::PairMetrics;
    /// use pinwheel_timeseries::norms::View;
    ///
    /// let (a, b) = ([1.0, 2.0, 3.0], [1.0, 2.0, 3.03]);
    /// let (a, b) = (View::new(vec![&a[..]]), View::new(vec![&b[..]]));
    /// let metrics = PairMetrics::of(&a, &b, &[0.0, 0.1, 0.2]).ok_or("shapes differ")?;
    /// assert!(metrics.peak_difference.is_some_and(|d| (d - 0.03 / 3.03).abs() < 1e-12));
    /// # Ok::<(), &str>(())
    /// ```
    ///
    /// `None` if the shapes differ or `time_s` has another length.
    pub fn of(a: &View<'_>, b: &View<'_>, time_s: &[f64]) -> Option<Self> {
        let fits = |channel: &&[f64]| channel.len() == time_s.len();
        if !a.same_shape(b) || !a.channels().iter().all(fits) {
            return None;
        }
        let means = a.mean().zip(b.mean());
        let peaks = a.peak().zip(b.peak());
        let squares = a.rms().zip(b.rms());
        let difference_max = norms::peak(a.less(b));
        let difference_rms = difference_max.and_then(|peak| norms::rms(a.less(b), peak));
        Some(Self {
            relative_l2: over_larger(difference_rms, squares),
            relative_linf: over_larger(difference_max, peaks),
            difference_rms,
            difference_max,
            worst: worst(a, b, time_s),
            larger_peak: peaks.map(|(a, b)| a.max(b)),
            larger_rms: squares.map(|(a, b)| a.max(b)),
            larger_mean: means.map(|(a, b)| a.abs().max(b.abs())),
            end_value: end_value(a, b),
            mean_difference: apart(means),
            peak_difference: apart(peaks),
            rms_difference: apart(squares),
            mean_ratio: ratio(means),
            peak_ratio: ratio(peaks),
            rms_ratio: ratio(squares),
            sprague_geers: sprague_geers::sprague_geers(a, b),
            sprague_geers_c: sprague_geers::comprehensive(a, b),
        })
    }

    /// Returns the reference size of an uncertainty in a norm, in the quantity's unit: the larger figure of the two runs.
    pub(crate) fn larger(&self, norm: Norm) -> Option<f64> {
        match norm {
            Norm::L2 | Norm::Rms => self.larger_rms,
            Norm::Linf | Norm::Peak => self.larger_peak,
            Norm::Mean => self.larger_mean,
        }
    }

    /// Returns the difference of the means as [`Metric::Mean`], positive where the mean of `a` has the larger magnitude.
    /// `None` if one mean is zero or the means have opposite signs.
    pub fn signed_mean_difference(&self) -> Option<f64> {
        let ratio = self.mean_ratio.filter(|ratio| *ratio > 0.0)?;
        Some(if ratio >= 1.0 {
            1.0 - 1.0 / ratio
        } else {
            ratio - 1.0
        })
    }
}

/// Returns `difference` over the larger magnitude of the two; 0 for 0/0, `None` if a value is missing or the result is not
/// finite.
fn over_larger(difference: Option<f64>, both: Option<(f64, f64)>) -> Option<f64> {
    let (difference, (a, b)) = difference.zip(both)?;
    let larger = a.abs().max(b.abs());
    if difference == 0.0 {
        return larger.is_finite().then_some(0.0);
    }
    Some(difference.abs() / larger).filter(|value| value.is_finite())
}

/// Returns the relative difference of two figures, free of direction.
fn apart(both: Option<(f64, f64)>) -> Option<f64> {
    over_larger(both.map(|(a, b)| a - b), both)
}

/// Returns a / b; `None` unless finite.
fn ratio(both: Option<(f64, f64)>) -> Option<f64> {
    both.map(|(a, b)| a / b).filter(|value| value.is_finite())
}

/// Returns the relative L2 of the last sample over all channels.
fn end_value(a: &View<'_>, b: &View<'_>) -> Option<f64> {
    let last = |view: &View<'_>| -> Option<Vec<f64>> {
        let channels = view.channels().iter();
        channels.map(|c| c.last().copied()).collect()
    };
    let (a, b) = (last(a)?, last(b)?);
    let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
    let rms = |values: &[f64]| View::from(values).rms();
    over_larger(rms(&differences), rms(&a).zip(rms(&b)))
}

fn worst(a: &View<'_>, b: &View<'_>, time_s: &[f64]) -> Option<WorstSample> {
    let mut worst: Option<(f64, WorstSample)> = None;
    for (channel, (a, b)) in a.channels().iter().zip(b.channels()).enumerate() {
        for ((a, b), &time_s) in a.iter().zip(*b).zip(time_s) {
            let difference = (a - b).abs();
            if !difference.is_finite() {
                return None;
            }
            if worst
                .as_ref()
                .is_none_or(|(largest, _)| difference > *largest)
            {
                worst = Some((difference, WorstSample { channel, time_s }));
            }
        }
    }
    worst.map(|(_, sample)| sample)
}
