//! Search for the largest step with a correct run.

use super::{Failure, Options};
use crate::StudyError;

/// Doubles or halves from the study's step until the verdict changes, then bisects to 10 %.
pub(super) fn largest_step(
    options: &Options,
    stable: bool,
    mut failure: impl FnMut(f64) -> Result<Option<Failure>, StudyError>,
) -> Result<(Option<f64>, Option<Failure>), StudyError> {
    let [least, most] = options.steps_s;
    let (mut good, mut bad) = (stable.then_some(options.step_s), None);
    let mut step = options.step_s;
    if !stable {
        bad = failure(step)?.map(|how| (step, how));
    }
    loop {
        step *= if stable { 2.0 } else { 0.5 };
        if step > most || step < least {
            break;
        }
        let how = failure(step)?;
        let turned = how.is_some() == stable;
        match how {
            None => good = Some(step),
            Some(how) => bad = Some((step, how)),
        }
        if turned {
            break;
        }
    }
    while let (Some(low), Some((high, _))) = (good, &bad)
        && high / low > 1.1
    {
        let middle = (low * high).sqrt();
        match failure(middle)? {
            None => good = Some(middle),
            Some(how) => bad = Some((middle, how)),
        }
    }
    Ok((good, bad.map(|(_, how)| how)))
}
