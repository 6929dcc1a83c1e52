//! Two engines side by side.

use pinwheel_timeseries::TimeSeries;

use crate::comparison::{EngineSummary, Pair, PairEntry};
use crate::grid::Common;
use crate::judge::{Judge, Sides, Uncertainties};
use crate::metrics::{Metric, PairMetrics};
use crate::participant::{Participant, Track};
use crate::quantities::Quantity;
use crate::summary::{covered, floor, shared, uncertainty};
use crate::uncertainty::{Estimate, Extrapolated, QuantityUncertainty, Source};
use crate::verdict::{self, Assessment, Side};
use crate::windows::{FEWEST_SAMPLES, Window};
use crate::{CompareError, grid};
use pinwheel_timeseries::norms::View;

pub(crate) fn pair(
    sides: Sides<'_>,
    engines: &[EngineSummary],
    windows: &[Window],
    quantities: &[Quantity],
    judge: Judge<'_>,
) -> Result<Pair, CompareError> {
    let Sides { track, a, b } = sides;
    let common = grid::common(a, b)?;
    let mut entries = Vec::new();
    for window in windows {
        for quantity in quantities {
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

/// `None` if neither engine has the quantity.
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
            extrapolated: None,
            result: Assessment::not_compared(reason),
        })
    };
    let has = |p: &Participant| {
        quantity
            .channels
            .iter()
            .filter(|name| p.time_series.channel(name).is_some())
            .count()
    };
    match (has(a), has(b)) {
        (0, 0) => return None,
        (0, _) => return unjudged(format!("{} has no `{}`", a.name, quantity.name)),
        (_, 0) => return unjudged(format!("{} has no `{}`", b.name, quantity.name)),
        _ => {}
    }
    let samples = of_a.window(window.from_s, window.to_s);
    let samples = covered(&[(a, of_a.as_ref()), (b, of_b.as_ref())], samples);
    let whole = quantity;
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
        return unjudged(format!(
            "`{}` has channels that only one of the two has",
            quantity.name
        ));
    };
    let uncertainty = |p: &Participant, common: &TimeSeries| -> Option<QuantityUncertainty> {
        if *quantity != *whole {
            // A rig has some of the sleeves only: the uncertainty of those.
            let samples = p.time_series.window(window.from_s, window.to_s);
            return uncertainty(p, quantity, window, covered(&[(p, common)], samples), judge);
        }
        let summary = engines.iter().find(|e| e.name == p.name)?;
        let found = summary
            .uncertainty
            .iter()
            .find(|u| u.quantity == quantity.name && u.window == window.kind)?;
        Some(found.clone())
    };
    let of_sides = [uncertainty(a, of_a), uncertainty(b, of_b)];
    let of_sides = [of_sides[0].as_ref(), of_sides[1].as_ref()];
    let assessments = judge.pair(sides, quantity, window, &metrics, of_sides);
    let deciding = assessments.iter().filter(|one| one.decides);
    let result = Assessment::worst(deciding)?.clone();
    let extrapolated = extrapolated(sides, quantity, window, of_sides, judge);
    Some(PairEntry {
        quantity: quantity.name.clone(),
        window: window.kind,
        metrics: Some(metrics),
        assessments,
        extrapolated,
        result,
    })
}

/// The relative L2 judgement of two participants of one law, both on one grid, with the leading error term of every
/// confirmed refinement study taken off; `None` where neither has one.
fn extrapolated(
    Sides { track, a, b }: Sides<'_>,
    quantity: &Quantity,
    window: &Window,
    [of_a, of_b]: Uncertainties<'_>,
    judge: Judge<'_>,
) -> Option<Assessment> {
    let one_law = [Track::Native, Track::SharedLaw].contains(&track);
    if !one_law
        || !judge.context.is_pointwise(window.to_s)
        || !grid::same(&a.time_series, &b.time_series)
    {
        return None;
    }
    let samples = a.time_series.window(window.from_s, window.to_s);
    let sharper = |p: &Participant, of: Option<&QuantityUncertainty>| {
        let evidence = judge.rules.evidence.iter().find(|e| e.engine == p.name)?;
        let Source::Refinement(study) = &evidence.source else {
            return None;
        };
        let floor = floor(p, evidence, judge.context);
        study.extrapolated(&p.time_series, quantity, samples.clone(), &of?.l2, floor)
    };
    let (new_a, new_b) = (sharper(a, of_a), sharper(b, of_b));
    if new_a.is_none() && new_b.is_none() {
        return None;
    }
    let view = |p: &'_ Participant, new: &Option<Extrapolated>| -> Option<Vec<Vec<f64>>> {
        match new {
            Some(new) => Some(new.channels.clone()),
            None => {
                let view = View::of(&p.time_series, &quantity.channels, samples.clone())?;
                Some(view.channels().iter().map(|c| c.to_vec()).collect())
            }
        }
    };
    let (one, other) = (view(a, &new_a)?, view(b, &new_b)?);
    let of = |channels: &'_ [Vec<f64>]| channels.iter().map(Vec::len).sum::<usize>();
    if of(&one) != of(&other) {
        return None;
    }
    let metrics = PairMetrics::of(
        &View::new(one.iter().map(Vec::as_slice).collect()),
        &View::new(other.iter().map(Vec::as_slice).collect()),
        a.time_series.time_s().get(samples.clone())?,
    )?;
    let scale = metrics.larger_rms?;
    let u = |new: &Option<Extrapolated>, of: Option<&QuantityUncertainty>| -> Option<Estimate> {
        let old = *of?.l2.estimate()?;
        let u = new.as_ref().map_or(old.u, |new| new.u);
        let relative = if u == 0.0 { 0.0 } else { u / scale };
        relative
            .is_finite()
            .then_some(Estimate { u: relative, ..old })
    };
    let (side_a, side_b) = (
        Side::known(&a.name, u(&new_a, of_a)?),
        Side::known(&b.name, u(&new_b, of_b)?),
    );
    let distance = metrics.relative_l2?;
    let sides = [&side_a, &side_b];
    let resolution = judge.rules.resolution;
    Some(Assessment {
        decides: false,
        ..verdict::pair(Metric::RelativeL2, distance, sides, resolution)
    })
}
