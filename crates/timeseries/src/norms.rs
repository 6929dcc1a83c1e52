//! Norms and figures of time series: how large one is, and how far two are apart.
//!
//! ```text
//! RMS            sqrt(sum x^2 / n)            over all channels and samples of a view
//! relative L2    RMS(a - b) / RMS(b)          b is the reference
//! relative Linf  max |a - b| / max |b|
//! ```
//! Where the reference is next to nothing, a least value stands in for it. What is not finite, or has another shape,
//! has no norm: `None` or NaN, which is never a small one.

use std::borrow::Cow;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::{TimeSeries, columns};

/// Sample times may differ by this part of their spacing: a rounding, which moves a course by as
/// small a part of its change over one sample.
const SAME: f64 = 1e-6;

const FORCES: [&str; 2] = [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE];

/// Some channels of one run, cut to one window. All channels have the same length.
#[derive(Debug, Clone)]
pub struct View<'a> {
    channels: Vec<&'a [f64]>,
}

impl<'a> View<'a> {
    /// A view of channels of the same length.
    #[must_use]
    pub fn new(channels: Vec<&'a [f64]>) -> Self {
        Self { channels }
    }

    /// The channels `names` of `time_series` over the samples `window`; `None` if one is missing or too short.
    #[must_use]
    pub fn of(
        time_series: &'a TimeSeries,
        names: &[impl AsRef<str>],
        window: Range<usize>,
    ) -> Option<Self> {
        let cut = |name: &str| time_series.channel(name)?.get(window.clone());
        let channels: Option<Vec<_>> = names.iter().map(|name| cut(name.as_ref())).collect();
        channels.map(Self::new)
    }

    /// All forces of pins over the samples `window`.
    #[must_use]
    pub fn forces(time_series: &'a TimeSeries, window: Range<usize>) -> Self {
        let groups = FORCES.iter().flat_map(|prefix| time_series.group(prefix));
        Self::new(groups.filter_map(|c| c.get(window.clone())).collect())
    }

    /// The driver's torque over the samples `window`; nothing where it is not there.
    #[must_use]
    pub fn driver_torque(time_series: &'a TimeSeries, window: Range<usize>) -> Self {
        Self::of(time_series, &[columns::INPUT_TORQUE], window).unwrap_or(Self::new(Vec::new()))
    }

    /// The channels.
    #[must_use]
    pub fn channels(&self) -> &[&'a [f64]] {
        &self.channels
    }

    /// All values, channel by channel.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.channels.iter().copied().flatten().copied()
    }

    /// Number of values.
    #[must_use]
    pub fn count(&self) -> usize {
        self.channels.iter().map(|channel| channel.len()).sum()
    }

    /// True if both have the same number of channels of the same lengths.
    #[must_use]
    pub fn same_shape(&self, other: &Self) -> bool {
        let (own, others) = (self.channels.iter(), other.channels.iter());
        own.map(|channel| channel.len())
            .eq(others.map(|channel| channel.len()))
    }

    /// Largest magnitude; `None` without values or with one that is not finite.
    #[must_use]
    pub fn peak(&self) -> Option<f64> {
        peak(self.values())
    }

    /// Root mean square; `None` without values or with one that is not finite.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        rms(self.values(), self.peak()?)
    }

    /// `self - other`, value by value; both have one shape.
    pub fn less<'b>(&'b self, other: &'b Self) -> impl Iterator<Item = f64> + 'b {
        self.values().zip(other.values()).map(|(a, b)| a - b)
    }

    /// Mean; `None` without values or with one that is not finite.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        Some(Statistics::of(self)?.mean)
    }
}

impl<'a> From<&'a [f64]> for View<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self::new(vec![values])
    }
}

/// Relative L2 distance of `a` from the reference `b`. Where `b` is smaller, `least` in one channel at every sample stands in
/// for it. 0 where both are nothing, 1 where only `b` is and `least` is 0; NaN where one has no norm.
#[must_use]
pub fn relative_l2(a: &View<'_>, b: &View<'_>, least: f64) -> f64 {
    let least = least / (b.channels.len().max(1) as f64).sqrt();
    let off = peak(a.less(b)).and_then(|peak| rms(a.less(b), peak));
    share(off.filter(|_| a.same_shape(b)), b.rms(), least)
}

/// Largest difference of `a` from the reference `b` over the peak of `b`, which counts as `least` at least. 0, 1 and NaN as in
/// [`relative_l2`].
#[must_use]
pub fn relative_linf(a: &View<'_>, b: &View<'_>, least: f64) -> f64 {
    share(peak(a.less(b)).filter(|_| a.same_shape(b)), b.peak(), least)
}

fn share(difference: Option<f64>, size: Option<f64>, least: f64) -> f64 {
    let (Some(difference), Some(size)) = (difference, size) else {
        return f64::NAN;
    };
    let size = size.max(least);
    if difference == 0.0 {
        0.0
    } else if size == 0.0 {
        1.0
    } else {
        difference / size
    }
}

/// Rows of the increasing times `whole` at each of `times`; `None` where it has no such sample.
pub fn rows_at<'a>(times: &'a [f64], whole: &'a [f64]) -> impl Iterator<Item = Option<usize>> + 'a {
    times.iter().map(|&time| {
        let after = whole.partition_point(|&t| t < time);
        let near = |row: usize| {
            let t = whole.get(row)?;
            let spacing = match row.checked_sub(1).and_then(|before| whole.get(before)) {
                Some(before) => t - before,
                None => whole.get(1)? - t,
            };
            ((t - time).abs() <= SAME * spacing).then_some(row)
        };
        near(after).or_else(|| near(after.checked_sub(1)?))
    })
}

/// Loads that a gear does not notice: distances are shares of no less.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadFloor {
    /// Force of a pin, N.
    pub force_n: f64,
    /// The driver's torque, N m.
    pub torque_n_m: f64,
}

/// Relative distances of two runs of a gearbox.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Distance {
    /// All pin forces together, L2.
    pub forces: f64,
    /// The driver's torque, L2.
    pub driver_torque: f64,
    /// The largest of a pin force at a sample, over the largest force: what bounds an extreme, which the root of a mean does not.
    #[serde(default)]
    pub force_at_most: f64,
    /// Largest difference of the driver's torque at a sample, over the largest torque.
    #[serde(default)]
    pub torque_at_most: f64,
}

impl Distance {
    /// Distance of `a` from the reference `b`, over the samples that both have. Where `a` is sampled less often, its
    /// times must be among those of `b`. See [`relative_l2`].
    #[must_use]
    pub fn between(a: &TimeSeries, b: &TimeSeries, least: LoadFloor) -> Self {
        let rows: Vec<usize> = rows_at(a.time_s(), b.time_s())
            .map_while(|row| row)
            .collect();
        let samples = 0..rows.len();
        let b = if rows.iter().copied().eq(samples.clone()) {
            Cow::Borrowed(b)
        } else {
            Cow::Owned(b.select(&rows))
        };
        let at = |view: for<'v> fn(&'v TimeSeries, Range<usize>) -> View<'v>, least: f64| {
            let (a, b) = (view(a, samples.clone()), view(&b, samples.clone()));
            [relative_l2(&a, &b, least), relative_linf(&a, &b, least)]
        };
        let [forces, force_at_most] = at(|run, rows| View::forces(run, rows), least.force_n);
        let [driver_torque, torque_at_most] =
            at(|run, rows| View::driver_torque(run, rows), least.torque_n_m);
        Self {
            forces,
            driver_torque,
            force_at_most,
            torque_at_most,
        }
    }

    /// Each by itself, of whatever has as many.
    pub fn of_each(mut of: impl FnMut(fn(&Self) -> f64) -> f64) -> Self {
        Self {
            forces: of(|d| d.forces),
            driver_torque: of(|d| d.driver_torque),
            force_at_most: of(|d| d.force_at_most),
            torque_at_most: of(|d| d.torque_at_most),
        }
    }

    /// As errors of a run. The torque is a sum of forces times lever arms, so it is known no better than they are, however near
    /// two runs of it lie by accident.
    #[must_use]
    pub fn torque_as_forces(&self) -> Self {
        Self {
            driver_torque: self.driver_torque.max(self.forces),
            torque_at_most: self.torque_at_most.max(self.force_at_most),
            ..*self
        }
    }

    /// The larger of both L2; NaN if either is.
    #[must_use]
    pub fn worst(&self) -> f64 {
        if self.forces.is_nan() || self.driver_torque.is_nan() {
            return f64::NAN;
        }
        self.forces.max(self.driver_torque)
    }

    /// Each with another's added.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self::of_each(|part| part(self) + part(other))
    }

    /// Each, and `least` where it is less.
    #[must_use]
    pub fn at_least(&self, least: f64) -> Self {
        Self::of_each(|part| part(self).max(least))
    }
}

/// How large the loads of a run are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LoadMagnitude {
    /// Largest pin force, N.
    pub peak_force_n: f64,
    /// Mean of the driver's torque, N m.
    pub mean_torque_n_m: f64,
    /// Root mean square of the driver's torque, N m.
    pub rms_torque_n_m: f64,
}

impl LoadMagnitude {
    /// Over the whole run; NaN for what is not there or not finite.
    #[must_use]
    pub fn of(time_series: &TimeSeries) -> Self {
        let whole = 0..time_series.len();
        let torque = View::driver_torque(time_series, whole.clone());
        Self {
            peak_force_n: View::forces(time_series, whole).peak().unwrap_or(f64::NAN),
            mean_torque_n_m: torque.mean().unwrap_or(f64::NAN),
            rms_torque_n_m: torque.rms().unwrap_or(f64::NAN),
        }
    }
}

/// Mean; 0 without values.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Largest less smallest of finite values; 0 without any.
#[must_use]
pub fn range(values: &[f64]) -> f64 {
    extremes(&[values]).map_or(0.0, |[low, high]| high - low)
}

/// Smallest and largest of finite values; `None` without any or with one that is not finite.
fn extremes(channels: &[&[f64]]) -> Option<[f64; 2]> {
    const LANES: usize = 4;
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    // What is not finite leaves NaN here.
    let mut spoiled = [0.0; LANES];
    let mut take = |lane: usize, value: f64| {
        low[lane] = if value < low[lane] { value } else { low[lane] };
        high[lane] = if value > high[lane] {
            value
        } else {
            high[lane]
        };
        spoiled[lane] += 0.0 * value;
    };
    for channel in channels {
        let (whole, rest) = channel.as_chunks::<LANES>();
        for chunk in whole {
            (0..LANES).for_each(|lane| take(lane, chunk[lane]));
        }
        rest.iter().for_each(|&value| take(0, value));
    }
    let low = low.into_iter().fold(f64::INFINITY, f64::min);
    let high = high.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (low <= high && spoiled.iter().sum::<f64>() == 0.0).then_some([low, high])
}

/// Largest magnitude of finite values; `None` otherwise.
#[must_use]
pub fn peak(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next().filter(|value| value.is_finite())?.abs();
    values.try_fold(first, |peak, value| {
        value.is_finite().then(|| peak.max(value.abs()))
    })
}

/// The largest power of two not above `value` >= 0, and at least the smallest normal number: neither dividing by it nor
/// multiplying by its inverse rounds.
fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

/// Root mean square of finite values whose largest magnitude is `peak`: scaled down by it, so
/// that squares neither overflow nor vanish. `None` without values.
#[must_use]
pub fn rms(values: impl Iterator<Item = f64>, peak: f64) -> Option<f64> {
    let scale = power_of_two_below(peak);
    let (mut sum, mut count) = (0.0, 0usize);
    for value in values {
        let scaled = value / scale;
        sum += scaled * scaled;
        count += 1;
    }
    (count > 0).then(|| scale * (sum / count as f64).sqrt())
}

/// Mean, extremes, root mean square. All in the quantity's unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Mean over channels and samples.
    pub mean: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub peak: f64,
}

impl Statistics {
    /// Statistics of a view; `None` without values or with one that is not finite.
    #[must_use]
    pub fn of(view: &View<'_>) -> Option<Self> {
        let [min, max] = extremes(&view.channels)?;
        // Evaluation and squares of values over a power of two near the largest magnitude neither overflow nor vanish.
        let peak = max.max(-min);
        let scale = power_of_two_below(peak);
        let (mut sum, mut squares) = (0.0, 0.0);
        for channel in &view.channels {
            for value in *channel {
                let scaled = value * scale.recip();
                sum += scaled;
                squares += scaled * scaled;
            }
        }
        let count = view.count() as f64;
        Some(Self {
            mean: sum / count * scale,
            min,
            max,
            rms: scale * (squares / count).sqrt(),
            peak,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        let view = View::new(vec![&[1.0, -7.0], &[3.0, 1.0]]);
        let figures = Statistics::of(&view).unwrap();
        assert_eq!(
            (figures.mean, figures.min, figures.max, figures.peak),
            (-0.5, -7.0, 3.0, 7.0)
        );
        assert!((figures.rms - 15f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn huge_values_do_not_overflow() {
        let figures = Statistics::of(&View::new(vec![&[1e200, -1e200, 1e200]])).unwrap();
        assert!((figures.rms / 1e200 - 1.0).abs() < 1e-15);
        let largest = Statistics::of(&View::new(vec![&[f64::MAX, f64::MAX]])).unwrap();
        assert!(largest.mean.is_finite() && largest.rms.is_finite());
        // Below the smallest normal number.
        let tiny = Statistics::of(&View::new(vec![&[3e-320, -1e-320]])).unwrap();
        assert_eq!((tiny.mean, tiny.peak), (1e-320, 3e-320));
    }

    #[test]
    fn nothing_and_non_finite() {
        assert!(Statistics::of(&View::new(vec![])).is_none());
        assert!(Statistics::of(&View::new(vec![&[]])).is_none());
        // Wherever it stands: values are taken four at a time.
        for place in 0..6 {
            for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut values = [1.0; 6];
                values[place] = odd;
                let view = View::new(vec![&values]);
                assert!(Statistics::of(&view).is_none() && view.mean().is_none());
            }
        }
        assert!(View::new(vec![&[]]).mean().is_none());
    }

    /// A distance that is not a number is no small one.
    #[test]
    fn the_worst_of_two_distances() {
        let of = |forces: f64, driver_torque: f64| Distance {
            forces,
            driver_torque,
            force_at_most: 3.0,
            torque_at_most: 6.0,
        };
        assert_eq!((of(1.0, 2.0).worst(), of(2.0, 1.0).worst()), (2.0, 2.0));
        assert!(of(f64::NAN, 1.0).worst().is_nan() && of(1.0, f64::NAN).worst().is_nan());
        let sum = of(2.0, 4.0).plus(&of(1.0, 2.0));
        assert_eq!((sum.forces, sum.driver_torque), (3.0, 6.0));
        assert_eq!((sum.force_at_most, sum.torque_at_most), (6.0, 12.0));
        assert_eq!(of(2.0, 4.0).at_least(3.0), of(3.0, 4.0));
    }

    /// A force and a torque that are linear in time.
    fn time_series(times: &[f64], force: f64, torque: f64) -> TimeSeries {
        let mut time_series = TimeSeries::new(times.to_vec()).unwrap();
        let values = |slope: f64| times.iter().map(|t| slope * t).collect();
        time_series
            .push(columns::INPUT_TORQUE, values(torque))
            .unwrap();
        time_series
            .push("external_sleeve_force_n_0", values(force))
            .unwrap();
        time_series
    }

    #[test]
    fn what_is_nothing_is_measured_by_the_least_load() {
        let least = LoadFloor {
            force_n: 0.5,
            torque_n_m: 2e-3,
        };
        let times = [0.0, 3.0, 4.0];
        let nothing = time_series(&times, 0.0, 0.0);
        let off = Distance::between(&time_series(&times, 0.5, 2e-3), &nothing, least);
        // sqrt((3^2 + 4^2)/3 samples)
        let expected = (25.0_f64 / 3.0).sqrt();
        for found in [off.forces, off.driver_torque] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{off:?}");
        }
        let something = time_series(&times, 1.0, 1.0);
        let against_nothing = Distance::between(&something, &nothing, LoadFloor::default());
        assert_eq!(
            (against_nothing.forces, against_nothing.worst()),
            (1.0, 1.0)
        );
        assert_eq!(
            Distance::between(&nothing, &nothing, LoadFloor::default()).worst(),
            0.0
        );
    }

    /// A series that is sampled less often, or written with rounding, is compared at its own times.
    #[test]
    fn samples_are_compared_at_their_times() {
        let fine = time_series(&[0.0, 1.0, 2.0, 3.0, 4.0], 100.0, 10.0);
        for coarse in [[0.0, 2.0, 4.0], [0.0, 2.0 + 1e-9, 4.0 - 1e-9]] {
            let off = Distance::between(
                &time_series(&coarse, 110.0, 10.0),
                &fine,
                LoadFloor::default(),
            );
            assert!((off.forces - 0.1).abs() < 1e-8, "{off:?}");
            assert!(off.driver_torque < 1e-8, "{off:?}");
            assert!((off.force_at_most - 0.1).abs() < 1e-8 && off.torque_at_most < 1e-8);
        }
        let rows: Vec<_> = rows_at(&[0.0, 1.5, 2.0], &[0.0, 1.0, 2.0]).collect();
        assert_eq!(rows, [Some(0), None, Some(2)]);
    }

    #[test]
    fn norms_by_hand() {
        let (a, b) = ([3.0, 4.0, 1.0], [3.0, 4.0, 0.0]);
        let norms = |from: usize, least: f64| {
            let (a, b) = (View::from(&a[from..]), View::from(&b[from..]));
            (
                (1e15 * relative_l2(&a, &b, least)).round() * 1e-15,
                relative_linf(&a, &b, least),
            )
        };
        assert_eq!(norms(0, 0.5), (0.2, 0.25));
        assert_eq!(norms(2, 0.5), (2.0, 2.0), "of the least value");
        let short = View::from(&a[..2]);
        assert!(relative_l2(&short, &View::from(&b[..]), 0.0).is_nan());
        assert!(relative_linf(&short, &View::from(&b[..]), 0.0).is_nan());
        assert_eq!(
            (range(&a), range(&[]), mean(&[]), mean(&a)),
            (3.0, 0.0, 0.0, 8.0 / 3.0)
        );
    }
}
