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
        // Scaled as the root mean square is, so that the sum cannot overflow.
        let peak = self.peak()?;
        if peak == 0.0 {
            return Some(0.0);
        }
        let scale = power_of_two_below(peak);
        let sum: f64 = self.values().map(|v| v / scale).sum();
        Some(sum / self.count() as f64 * scale)
    }
}

/// Largest magnitude of finite values; `None` otherwise.
pub(crate) fn peak(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next().filter(|value| value.is_finite())?.abs();
    values.try_fold(first, |peak, value| {
        value.is_finite().then(|| peak.max(value.abs()))
    })
}

/// The largest power of two not above `value` > 0: dividing by it rounds nothing.
fn power_of_two_below(value: f64) -> f64 {
    let power = f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000);
    if power > 0.0 { power } else { value }
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
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut finite = true;
        for value in view.channels.iter().copied().flatten().copied() {
            finite &= value.is_finite();
            min = min.min(value);
            max = max.max(value);
        }
        let count = view.count();
        if !finite || count == 0 {
            return None;
        }
        let peak = max.max(-min);
        let (mut sum, mut squares) = (0.0, 0.0);
        let scale = if peak == 0.0 {
            1.0
        } else {
            power_of_two_below(peak)
        };
        for channel in &view.channels {
            for value in *channel {
                let scaled = value / scale;
                sum += scaled;
                squares += scaled * scaled;
            }
        }
        Some(Self {
            mean: sum / count as f64 * scale,
            min,
            max,
            rms: scale * (squares / count as f64).sqrt(),
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
    }

    #[test]
    fn nothing_and_non_finite() {
        assert!(Statistics::of(&View::new(vec![])).is_none());
        assert!(Statistics::of(&View::new(vec![&[]])).is_none());
        let spoiled = View::new(vec![&[1.0, 2.0], &[3.0, f64::INFINITY]]);
        assert!(Statistics::of(&spoiled).is_none());
        assert_eq!(spoiled.first_not_finite(), Some((1, 1)));
    }
}
