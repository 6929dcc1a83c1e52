//! Store of time series: a time column and channels of the same length.

use std::collections::HashMap;
use std::ops::Range;

use crate::sampling::Between;
use crate::{TimeSeriesError, columns};

/// Named column.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name with its unit as suffix.
    pub name: String,
    /// Values, one per sample.
    pub values: Vec<f64>,
}

/// Channels over a common, strictly increasing time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeSeries {
    time_s: Vec<f64>,
    channels: Vec<Channel>,
    index: HashMap<String, usize>,
    /// Record of the quantities between samples, as the solver evaluated them; not stored in files.
    between: Option<Box<Between>>,
}

impl TimeSeries {
    /// Makes time series without channels over the times `time_s` (s, strictly increasing).
    ///
    /// # Errors
    /// [`TimeSeriesError::Time`] names the first row that does not increase.
    pub fn new(time_s: Vec<f64>) -> Result<Self, TimeSeriesError> {
        for (row, pair) in time_s.windows(2).enumerate() {
            // A NaN on either side fails the comparison, too.
            if !(pair[0] < pair[1]) {
                return Err(TimeSeriesError::Time {
                    row: row + 2,
                    before: pair[0],
                    after: pair[1],
                });
            }
        }
        Ok(Self {
            time_s,
            ..Self::default()
        })
    }

    /// Makes time series from columns in any order, including the time.
    ///
    /// # Errors
    /// No `time_s`, or it does not increase; errors of [`push`](Self::push).
    pub fn of_columns(
        columns: impl IntoIterator<Item = (String, Vec<f64>)>,
    ) -> Result<Self, TimeSeriesError> {
        let is_time = |(name, _): &(String, Vec<f64>)| name == columns::TIME;
        let (time, channels): (Vec<_>, Vec<_>) = columns.into_iter().partition(is_time);
        let mut time = time.into_iter();
        let (_, time_s) = time.next().ok_or(TimeSeriesError::NoTime)?;
        let mut time_series = Self::new(time_s)?;
        for (name, values) in channels {
            time_series.push(name, values)?;
        }
        match time.next() {
            Some((name, _)) => Err(TimeSeriesError::Duplicate(name)),
            None => Ok(time_series),
        }
    }

    /// Adds a channel with one value per sample.
    ///
    /// # Errors
    /// The length differs from the time column's, or the name is taken.
    pub fn push(
        &mut self,
        name: impl Into<String>,
        values: Vec<f64>,
    ) -> Result<(), TimeSeriesError> {
        let name = name.into();
        if values.len() != self.time_s.len() {
            return Err(TimeSeriesError::Length {
                name,
                got: values.len(),
                expected: self.time_s.len(),
            });
        }
        if self.index.contains_key(&name) {
            return Err(TimeSeriesError::Duplicate(name));
        }
        self.index.insert(name.clone(), self.channels.len());
        self.channels.push(Channel { name, values });
        Ok(())
    }

    /// Sample times, s.
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// True without any sample.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Selects samples by row; rows that do not exist or do not increase are left out.
    pub fn select(&self, rows: &[usize]) -> Self {
        let mut kept: Vec<usize> = Vec::with_capacity(rows.len());
        for &row in rows {
            if row < self.len() && kept.last().is_none_or(|&last| row > last) {
                kept.push(row);
            }
        }
        let pick = |values: &[f64]| kept.iter().map(|&row| values[row]).collect();
        let channels = self.channels.iter().map(|channel| Channel {
            name: channel.name.clone(),
            values: pick(&channel.values),
        });
        Self {
            time_s: pick(&self.time_s),
            channels: channels.collect(),
            index: self.index.clone(),
            between: None,
        }
    }

    /// Sets or removes the record of the quantities between samples.
    #[must_use]
    pub fn with_between(self, between: Option<Between>) -> Self {
        let between = between.map(Box::new);
        Self { between, ..self }
    }

    /// Record of the quantities between samples; `None` if the solver gave none.
    pub fn between(&self) -> Option<&Between> {
        self.between.as_deref()
    }

    /// Returns all channels in the order in which they were added.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Returns the values of one channel.
    pub fn channel(&self, name: &str) -> Option<&[f64]> {
        let place = *self.index.get(name)?;
        Some(&self.channels[place].values)
    }

    /// Returns the numbered channels `prefix_0, prefix_1, ...` in the order of their numbers.
    pub fn group(&self, prefix: &str) -> Vec<&[f64]> {
        let numbered = |k: usize| self.channel(&format!("{prefix}_{k}"));
        (0..).map_while(numbered).collect()
    }

    /// Returns the sample indices with `from_s <= t <= to_s`, widened by a rounding at both ends.
    pub fn window(&self, from_s: f64, to_s: f64) -> Range<usize> {
        // An open end does not indicate the rounding of times.
        let scale = if to_s.is_finite() { to_s } else { from_s };
        let slack = 1e-9 * scale.abs().max(1e-9);
        let start = self.time_s.partition_point(|&t| t < from_s - slack);
        let end = self.time_s.partition_point(|&t| t <= to_s + slack);
        start..end.max(start)
    }
}

/// Splits `external_sleeve_force_n_3` into its group `external_sleeve_force_n` and index 3.
/// A name without a numeric suffix is its own group.
pub fn group_of(name: &str) -> (&str, Option<usize>) {
    match name.rsplit_once('_') {
        Some((prefix, digits))
            if !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()) =>
        {
            (prefix, digits.parse().ok())
        }
        _ => (name, None),
    }
}
