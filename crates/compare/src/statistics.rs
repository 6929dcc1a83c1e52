//! Figures of one course alone, over all channels of a quantity jointly.

use std::ops::Range;

use pinwheel_courses::Courses;
use serde::Serialize;

use crate::quantities::Quantity;

/// The channels of one quantity, cut to one window. All channels have the same length.
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

    /// A quantity's channels in `courses` over the samples `window`; `None` if one is missing or
    /// too short.
    #[must_use]
    pub fn of(courses: &'a Courses, quantity: &Quantity, window: Range<usize>) -> Option<Self> {
        let channels: Option<Vec<_>> = quantity
            .channels
            .iter()
            .map(|name| {
                courses
                    .channel(name)
                    .and_then(|values| values.get(window.clone()))
            })
            .collect();
        channels.map(Self::new)
    }

    /// The channels.
    #[must_use]
    pub fn channels(&self) -> &[&'a [f64]] {
        &self.channels
    }

    /// All values, channel by channel.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.channels
            .iter()
            .flat_map(|channel| channel.iter().copied())
    }

    /// Number of values.
    #[must_use]
    pub fn count(&self) -> usize {
        self.channels.iter().map(|channel| channel.len()).sum()
    }

    /// Whether both have the same number of channels of the same lengths.
    #[must_use]
    pub fn same_shape(&self, other: &Self) -> bool {
        self.channels.len() == other.channels.len()
            && self
                .channels
                .iter()
                .zip(&other.channels)
                .all(|(a, b)| a.len() == b.len())
    }

    /// Channel and sample of the first value that is not finite.
    #[must_use]
    pub fn first_not_finite(&self) -> Option<(usize, usize)> {
        self.channels
            .iter()
            .enumerate()
            .find_map(|(channel, values)| {
                values
                    .iter()
                    .position(|v| !v.is_finite())
                    .map(|sample| (channel, sample))
            })
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

    /// Mean; `None` without values or with one that is not finite.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        let scale = scale_of(extremes(&self.channels)?);
        let mut sum = 0.0;
        for channel in &self.channels {
            for value in *channel {
                sum += value * scale.recip();
            }
        }
        Some(sum / self.count() as f64 * scale)
    }
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

/// A power of two near the largest magnitude: sums and squares of values over it neither overflow nor vanish.
fn scale_of([low, high]: [f64; 2]) -> f64 {
    let peak = high.max(-low);
    if peak == 0.0 {
        1.0
    } else {
        power_of_two_below(peak)
    }
}

/// Largest magnitude of finite values; `None` otherwise.
pub(crate) fn peak(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next().filter(|value| value.is_finite())?.abs();
    values.try_fold(first, |peak, value| {
        value.is_finite().then(|| peak.max(value.abs()))
    })
}

/// The largest power of two not above `value` > 0, and at least the smallest normal number: neither dividing by it nor
/// multiplying by its inverse rounds.
fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

/// Root mean square of finite values whose largest magnitude is `peak`: scaled down by it, so
/// that squares neither overflow nor vanish.
pub(crate) fn rms(values: impl Iterator<Item = f64>, peak: f64) -> Option<f64> {
    if peak == 0.0 {
        return Some(0.0);
    }
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// Of a view; `None` without values or with one that is not finite.
    #[must_use]
    pub fn of(view: &View<'_>) -> Option<Self> {
        let [min, max] = extremes(&view.channels)?;
        let scale = scale_of([min, max]);
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
            peak: max.max(-min),
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
        let spoiled = View::new(vec![&[1.0, 2.0], &[3.0, f64::INFINITY]]);
        assert_eq!(spoiled.first_not_finite(), Some((1, 1)));
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
}
