//! Common sample times of two time series, which are never interpolated.
//!
//! A recording may have fewer samples than a live run. Both are then compared at the samples of the recording, which must all
//! be samples of the live run.

use std::borrow::Cow;

use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::rows_at;

use crate::CompareError;
use crate::participant::Participant;

/// Largest difference of sample times, as a share of their spacing: a rounding, which changes a signal by as small a share of
/// its change over one sample.
const SLACK: f64 = 1e-6;

/// Two time series on the same samples.
pub(crate) type Common<'a> = (Cow<'a, TimeSeries>, Cow<'a, TimeSeries>);

/// Returns the time series of two runs at the samples that both have.
///
/// # Errors
/// The sample times differ, and neither run is a recording whose samples the other one has.
pub(crate) fn common<'a>(
    a: &'a Participant,
    b: &'a Participant,
) -> Result<Common<'a>, CompareError> {
    let (of_a, of_b) = (&a.time_series, &b.time_series);
    let Err(error) = check(a, b) else {
        return Ok((Cow::Borrowed(of_a), Cow::Borrowed(of_b)));
    };
    let at_samples_of = |part: &Participant, all: &TimeSeries| {
        part.cost.recorded.as_ref()?;
        Some(all.select(&rows_of(&part.time_series, all)?))
    };
    if let Some(of_a) = at_samples_of(b, of_a) {
        return Ok((Cow::Owned(of_a), Cow::Borrowed(of_b)));
    }
    match at_samples_of(a, of_b) {
        Some(of_b) => Ok((Cow::Borrowed(of_a), Cow::Owned(of_b))),
        None => Err(error),
    }
}

/// Returns the rows of `all` at the times of `part`; `None` if a time is missing in `all`.
fn rows_of(part: &TimeSeries, all: &TimeSeries) -> Option<Vec<usize>> {
    rows_at(part.time_s(), all.time_s()).collect()
}

/// Checks that two runs have the same sample times.
fn check(a: &Participant, b: &Participant) -> Result<(), CompareError> {
    let (times_a, times_b) = (a.time_series.time_s(), b.time_series.time_s());
    let mut before = f64::NEG_INFINITY;
    for (row, (&time_a, &time_b)) in times_a.iter().zip(times_b).enumerate() {
        let spacing = if row == 0 {
            times_a.get(1).map_or(1.0, |t| t - time_a)
        } else {
            time_a - before
        };
        if (time_a - time_b).abs() > SLACK * spacing {
            let (a, b) = (a.name.clone(), b.name.clone());
            return Err(CompareError::Grid {
                a,
                b,
                row,
                time_a,
                time_b,
            });
        }
        before = time_a;
    }
    if times_a.len() != times_b.len() {
        return Err(CompareError::Samples {
            a: a.name.clone(),
            b: b.name.clone(),
            samples_a: times_a.len(),
            samples_b: times_b.len(),
            time_s: before,
        });
    }
    Ok(())
}
