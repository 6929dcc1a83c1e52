//! Norms of time series and distances between them.
//!
//! ```text
//! RMS            sqrt(sum x^2 / n)            over all channels and samples of a view
//! relative L2    RMS(a - b) / RMS(b)          b is the reference
//! relative Linf  max |a - b| / max |b|
//! ```
//! A least value replaces a negligible reference. Values that are not finite, or views of different shape, have no norm: `None`
//! or NaN, never a small number.

use std::borrow::Cow;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::{TimeSeries, columns};

/// Largest difference of sample times, as a share of their spacing: a rounding, which changes a signal by as small a share of
/// its change over one sample.
const SAME: f64 = 1e-6;

const FORCES: [&str; 2] = [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE];

/// Channels of one run over one window, all of the same length.
#[derive(Debug, Clone)]
pub struct View<'a> {
    channels: Vec<&'a [f64]>,
}

impl<'a> View<'a> {
    /// Makes a view of channels of the same length.
    pub fn new(channels: Vec<&'a [f64]>) -> Self {
        Self { channels }
    }

    /// Selects the channels `names` of `time_series` over the samples `window`; `None` if a channel is missing or too short.
    pub fn of(
        time_series: &'a TimeSeries,
        names: &[impl AsRef<str>],
        window: Range<usize>,
    ) -> Option<Self> {
        let cut = |name: &str| time_series.channel(name)?.get(window.clone());
        let channels: Option<Vec<_>> = names.iter().map(|name| cut(name.as_ref())).collect();
        channels.map(Self::new)
    }

    /// Selects the forces of all pins over the samples `window`.
    pub fn forces(time_series: &'a TimeSeries, window: Range<usize>) -> Self {
        let groups = FORCES.iter().flat_map(|prefix| time_series.group(prefix));
        Self::new(groups.filter_map(|c| c.get(window.clone())).collect())
    }

    /// Selects the driver's torque over the samples `window`; empty if the time series lacks it.
    pub fn driver_torque(time_series: &'a TimeSeries, window: Range<usize>) -> Self {
        Self::of(time_series, &[columns::INPUT_TORQUE], window).unwrap_or(Self::new(Vec::new()))
    }

    /// The channels.
    pub fn channels(&self) -> &[&'a [f64]] {
        &self.channels
    }

    /// Iterates over all values, channel by channel.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.channels.iter().copied().flatten().copied()
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.channels.iter().map(|channel| channel.len()).sum()
    }

    /// True if both have the same number of channels of the same lengths.
    pub fn same_shape(&self, other: &Self) -> bool {
        let (own, others) = (self.channels.iter(), other.channels.iter());
        own.map(|channel| channel.len())
            .eq(others.map(|channel| channel.len()))
    }

    /// Largest magnitude; `None` without values or with one that is not finite.
    pub fn peak(&self) -> Option<f64> {
        peak(self.values())
    }

    /// Root mean square; `None` without values or with one that is not finite.
    pub fn rms(&self) -> Option<f64> {
        rms(self.values(), self.peak()?)
    }

    /// `self - other`, value by value; both have one shape.
    pub fn less<'b>(&'b self, other: &'b Self) -> impl Iterator<Item = f64> + 'b {
        self.values().zip(other.values()).map(|(a, b)| a - b)
    }

    /// Mean; `None` without values or with one that is not finite.
    pub fn mean(&self) -> Option<f64> {
        Some(Statistics::of(self)?.mean)
    }
}

impl<'a> From<&'a [f64]> for View<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self::new(vec![values])
    }
}

/// Returns the relative L2 distance of `a` from the reference `b`, whose norm is at least that of `least` in one channel at
/// every sample. 0 if both are zero, 1 if only `b` and `least` are; NaN if either has no norm.
pub fn relative_l2(a: &View<'_>, b: &View<'_>, least: f64) -> f64 {
    let least = least / (b.channels.len().max(1) as f64).sqrt();
    let off = peak(a.less(b)).and_then(|peak| rms(a.less(b), peak));
    share(off.filter(|_| a.same_shape(b)), b.rms(), least)
}

/// Returns the largest difference of `a` from the reference `b` over the peak of `b`, which is at least `least`. 0, 1 and NaN
/// as for [`relative_l2`].
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

/// Returns the row in the increasing times `range` of each of `times`; `None` without a sample at that time.
pub fn rows_at<'a>(times: &'a [f64], all: &'a [f64]) -> impl Iterator<Item = Option<usize>> + 'a {
    times.iter().map(|&time| {
        let after = all.partition_point(|&t| t < time);
        let near = |row: usize| {
            let t = all.get(row)?;
            let spacing = match row.checked_sub(1).and_then(|before| all.get(before)) {
                Some(before) => t - before,
                None => all.get(1)? - t,
            };
            ((t - time).abs() <= SAME * spacing).then_some(row)
        };
        near(after).or_else(|| near(after.checked_sub(1)?))
    })
}

/// Loads that are negligible for a gear, the least references of distances.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadFloor {
    /// Force of a pin, N.
    pub force_n: f64,
    /// Torque of the driver, N m.
    pub torque_n_m: f64,
}

/// Relative distances of two runs of a gearbox.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Distance {
    /// L2 distance of all pin forces jointly.
    pub forces: f64,
    /// L2 distance of the driver's torque.
    pub driver_torque: f64,
    /// Largest difference of a pin force at a sample, over the largest force: a bound of extremes, which the L2 distance is
    /// not.
    #[serde(default)]
    pub force_at_most: f64,
    /// Largest difference of the driver's torque at a sample, over the largest torque.
    #[serde(default)]
    pub torque_at_most: f64,
}

impl Distance {
    /// Returns the distance of `a` from the reference `b` over their common samples. If `a` has fewer samples, its times must
    /// be among those of `b`. See [`relative_l2`].
    pub fn between(a: &TimeSeries, b: &TimeSeries, least: LoadFloor) -> Self {
        let rows = rows_at(a.time_s(), b.time_s());
        let rows: Vec<usize> = rows.map_while(|row| row).collect();
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

    /// Evaluates `of` for each component.
    pub fn of_each(mut of: impl FnMut(fn(&Self) -> f64) -> f64) -> Self {
        Self {
            forces: of(|d| d.forces),
            driver_torque: of(|d| d.driver_torque),
            force_at_most: of(|d| d.force_at_most),
            torque_at_most: of(|d| d.torque_at_most),
        }
    }

    /// Returns the distance as an error of a run. The torque is a sum of forces times lever arms, so its error is at least
    /// theirs, even if two runs agree by accident.
    pub fn torque_as_forces(&self) -> Self {
        Self {
            driver_torque: self.driver_torque.max(self.forces),
            torque_at_most: self.torque_at_most.max(self.force_at_most),
            ..*self
        }
    }

    /// Returns the larger of both L2 distances; NaN if either is NaN.
    pub fn worst(&self) -> f64 {
        if self.forces.is_nan() || self.driver_torque.is_nan() {
            return f64::NAN;
        }
        self.forces.max(self.driver_torque)
    }

    /// Adds another distance to each component.
    pub fn plus(&self, other: &Self) -> Self {
        Self::of_each(|part| part(self) + part(other))
    }

    /// Raises each component to at least `least`.
    pub fn at_least(&self, least: f64) -> Self {
        Self::of_each(|part| part(self).max(least))
    }
}

/// Magnitudes of a run's loads.
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
    /// Returns the magnitudes over the run; NaN for a column that is missing or not finite.
    pub fn of(time_series: &TimeSeries) -> Self {
        let range = 0..time_series.len();
        let torque = View::driver_torque(time_series, range.clone());
        Self {
            peak_force_n: View::forces(time_series, range).peak().unwrap_or(f64::NAN),
            mean_torque_n_m: torque.mean().unwrap_or(f64::NAN),
            rms_torque_n_m: torque.rms().unwrap_or(f64::NAN),
        }
    }
}

/// Mean; 0 without values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Range of finite values, largest less smallest; 0 without any.
pub fn range(values: &[f64]) -> f64 {
    extremes(&[values]).map_or(0.0, |[low, high]| high - low)
}

/// Smallest and largest of finite values; `None` without any or with one that is not finite.
fn extremes(channels: &[&[f64]]) -> Option<[f64; 2]> {
    const LANES: usize = 4;
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    // Becomes NaN if a value is not finite.
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
        let (range, rest) = channel.as_chunks::<LANES>();
        for chunk in range {
            (0..LANES).for_each(|lane| take(lane, chunk[lane]));
        }
        rest.iter().for_each(|&value| take(0, value));
    }
    let low = low.into_iter().fold(f64::INFINITY, f64::min);
    let high = high.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (low <= high && spoiled.iter().sum::<f64>() == 0.0).then_some([low, high])
}

/// Largest magnitude of finite values; `None` otherwise.
pub fn peak(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next().filter(|value| value.is_finite())?.abs();
    values.try_fold(first, |peak, value| {
        value.is_finite().then(|| peak.max(value.abs()))
    })
}

/// Returns the largest power of two not above `value` >= 0, at least the smallest normal number: dividing by it, or multiplying
/// by its inverse, does not round.
fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

/// Root mean square of finite values whose largest magnitude is `peak`. Scaling by it keeps squares from overflow and
/// underflow. `None` without values.
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

/// Mean, extremes, root mean square, in the quantity's unit.
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
    /// Evaluates the statistics of a view; `None` without values or with one that is not finite.
    pub fn of(view: &View<'_>) -> Option<Self> {
        let [min, max] = extremes(&view.channels)?;
        // Divided by a power of two near the largest magnitude, sums and squares neither overflow nor vanish.
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
