//! Two engines side by side.

use pinwheel_timeseries::TimeSeries;

use crate::comparison::{EngineSummary, Pair, PairEntry};
use crate::grid::Common;
use crate::judge::{Case, Judge, Sides};
use crate::metrics::PairMetrics;
use crate::participant::Participant;
use crate::quantities::Quantity;
use crate::summary::{covered, shared, uncertainty};
use crate::uncertainty::QuantityUncertainty;
use crate::verdict::Assessment;
use crate::windows::{FEWEST_SAMPLES, Window};
use crate::{CompareError, grid};
use pinwheel_timeseries::norms::View;

/// Compares two engines in each window and quantity.
pub(crate) fn pair(
    sides: Sides<'_>,
    engines: &[EngineSummary],
    judge: Judge<'_>,
) -> Result<Pair, CompareError> {
    let Sides { track, a, b } = sides;
    let common = grid::common(a, b)?;
    let mut entries = Vec::new();
    for window in judge.windows {
        for quantity in judge.quantities {
            entries.extend(pair_entry(sides, engines, &common, window, quantity, judge));
        }
    }
    Ok(Pair {
        a: a.name.clone(),
        b: b.name.clone(),
        track,
        entries,
    })
}

/// Returns the entry of one quantity; `None` if neither engine has it.
fn pair_entry(
    sides: Sides<'_>,
    engines: &[EngineSummary],
    (of_a, of_b): &Common<'_>,
    window: &Window,
    quantity: &Quantity,
    judge: Judge<'_>,
) -> Option<PairEntry> {
    let Sides { a, b, .. } = sides;
    let unjudged = |reason: String| {
        Some(PairEntry {
            quantity: quantity.name.clone(),
            window: window.kind,
            metrics: None,
            assessments: Vec::new(),
            result: Assessment::not_compared(reason),
        })
    };
    let lacks = |p: &Participant| unjudged(format!("{} has no `{}`", p.name, quantity.name));
    match [a, b].map(|p| quantity.is_in(&p.time_series)) {
        [false, false] => return None,
        [false, _] => return lacks(a),
        [_, false] => return lacks(b),
        _ => {}
    }
    let samples = of_a.window(window.from_s, window.to_s);
    let samples = covered(&[(a, of_a.as_ref()), (b, of_b.as_ref())], samples);
    let all = quantity;
    let quantity = &shared(quantity, &[a, b]);
    if samples.len() < FEWEST_SAMPLES {
        return unjudged(format!(
            "both have {} samples in this window, fewer than {FEWEST_SAMPLES}",
            samples.len()
        ));
    }
    let metrics = View::of(of_a, &quantity.channels, samples.clone())
        .zip(View::of(of_b, &quantity.channels, samples.clone()))
        .zip(of_a.time_s().get(samples))
        .and_then(|((of_a, of_b), time_s)| PairMetrics::of(&of_a, &of_b, time_s));
    let Some(metrics) = metrics else {
        let name = &quantity.name;
        return unjudged(format!(
            "`{name}` has channels that only one of the two has"
        ));
    };
    let uncertainty = |p: &Participant, common: &TimeSeries| -> Option<QuantityUncertainty> {
        if *quantity != *all {
            // A test rig measures only some of the pins: their uncertainty counts.
            let samples = p.time_series.window(window.from_s, window.to_s);
            return uncertainty(p, quantity, window, covered(&[(p, common)], samples), judge);
        }
        let summary = engines.iter().find(|e| e.name == p.name)?;
        summary.uncertainty_of(&quantity.name, window.kind).cloned()
    };
    let uncertainties = [uncertainty(a, of_a), uncertainty(b, of_b)];
    let assessments = judge.pair(&Case {
        sides,
        quantity,
        window,
        metrics: &metrics,
        uncertainties: uncertainties.each_ref().map(Option::as_ref),
        pointwise: judge.context.is_pointwise(window.to_s),
    });
    let deciding = assessments.iter().filter(|one| one.decides);
    let result = Assessment::gravest(deciding, |one| one)?.clone();
    Some(PairEntry {
        quantity: quantity.name.clone(),
        window: window.kind,
        metrics: Some(metrics),
        assessments,
        result,
    })
}
