//! The rule that courses are compared on one sample grid, and are never interpolated.

use crate::CompareError;
use crate::participant::Participant;

/// Sample times may differ by this part of their spacing: a rounding, which moves a course by as
/// small a part of its change over one sample.
const SLACK: f64 = 1e-6;

/// Checks that two runs have the same sample times.
pub(crate) fn check(a: &Participant, b: &Participant) -> Result<(), CompareError> {
    let (times_a, times_b) = (a.courses.time_s(), b.courses.time_s());
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
