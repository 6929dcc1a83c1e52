//! Results of one engine: figures, uncertainties and torque balance.

use std::collections::BTreeMap;
use std::ops::Range;

use pinwheel_timeseries::norms::{Statistics, View};
use pinwheel_timeseries::sampling;
use pinwheel_timeseries::{
    ABOVE_ONE, CREATED, NO_LOSS, TimeSeries, efficiency as ratio, mean_powers,
};

use crate::comparison::{EngineEntry, EngineSummary, Figures, RefinementSummary};
use crate::judge::{Judge, Negligible};
use crate::model;
use crate::participant::{Context, Participant, SharedModel};
use crate::quantities::{self, OUTPUT_TORQUE, Quantity};
use crate::rules::Rules;
use crate::uncertainty::{
    Basis, Estimate, Evidence, QuantityUncertainty, Source, Uncertainty, Unresolved, rounding_floor,
};
use crate::windows::{self, SETTLING_S, Window, WindowKind};

/// Returns the error of a run from rounding alone, as a share.
fn floor(participant: &Participant, context: &Context) -> f64 {
    let walk = rounding_floor(participant.cost.steps);
    // Measured effect of a rounding on the scene, unless rounding drives the runs apart.
    let measured = context.divergence.as_ref();
    let grown = measured.filter(|d| d.horizon_s.is_none());
    let grown = grown.map_or(0.0, |d| d.largest_share);
    walk.max(grown)
}

/// Returns the uncertainty of one quantity of a participant in the samples of a window; `None` without evidence.
pub(crate) fn uncertainty(
    participant: &Participant,
    quantity: &Quantity,
    window: &Window,
    samples: Range<usize>,
    judge: Judge<'_>,
) -> Option<QuantityUncertainty> {
    let evidence = judge.rules.evidence_of(&participant.name)?;
    let own = || {
        View::of(
            &participant.time_series,
            &quantity.channels,
            samples.clone(),
        )
    };
    let new = |norms, share| QuantityUncertainty::new(&quantity.name, window.kind, norms, share);
    let everywhere = |what: Uncertainty| new([(); 5].map(|()| what.clone()), None);
    // Refinement does not reduce the error of a quantity that is pure rounding, and its runs show no order.
    if let Source::Refinement(_) = evidence.source
        && let Some(below) = judge.negligible.below(quantity)
        && let Some(view) = own()
        && Statistics::of(&view).is_some_and(|own| own.peak < below)
    {
        return Some(everywhere(Uncertainty::Known(Estimate {
            basis: Basis::Rounding,
            ..Estimate::stated(below)
        })));
    }
    let missing = |why: &Unresolved| everywhere(Uncertainty::Unknown(why.clone()));
    Some(match &evidence.source {
        Source::Refinement(ladder) => {
            let floor = floor(participant, judge.context);
            let pointwise = judge.context.is_pointwise(window.to_s);
            let (finest, channels) = (&participant.time_series, &quantity.channels);
            match ladder.estimate(finest, channels, &samples, floor, pointwise) {
                Ok(estimate) => new(estimate.norms.map(Uncertainty::from), estimate.relative_l2),
                Err(unresolved) => missing(&unresolved),
            }
        }
        Source::Recorded(list) => {
            let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * window.to_s;
            let record = list.iter().find(|u| {
                u.quantity == quantity.name
                    && same(u.from_s, window.from_s)
                    && same(u.to_s, window.to_s)
            });
            match record {
                Some(record) => {
                    let rms = own().and_then(|view| view.rms());
                    let share = record.l2.zip(rms).map(|(u, rms)| u / rms);
                    new(record.norms().map(Uncertainty::recorded), share)
                }
                None => {
                    let why = "its recording holds no uncertainty of this window";
                    missing(&Unresolved::new(why, "record it again, or run it live"))
                }
            }
        }
        Source::Exact(share) => {
            let Statistics { peak, rms, .. } = Statistics::of(&own()?)?;
            let of = |size: f64| Uncertainty::Known(Estimate::stated(share * size));
            new([rms, peak, rms, peak, rms].map(of), Some(*share))
        }
        Source::Unknown(unresolved) => missing(unresolved),
    })
}

/// Returns the uncertainties of a participant's quantities in each window.
pub fn uncertainties(
    context: &Context,
    participant: &Participant,
    evidence: &Evidence,
) -> Vec<(Window, QuantityUncertainty)> {
    let time_series = &participant.time_series;
    let quantities = quantities::derive([time_series]);
    let settling_s = context.settling_s.unwrap_or(SETTLING_S);
    let (windows, _) = windows::windows(time_series, settling_s, &context.load_changes_s);
    let judge = Judge {
        rules: &Rules {
            evidence: std::slice::from_ref(evidence),
            ..Rules::default()
        },
        context,
        windows: &windows,
        quantities: &quantities,
        negligible: Negligible::of(context, &[participant], &quantities),
    };
    let each = windows.iter().flat_map(|window| {
        let samples = time_series.window(window.from_s, window.to_s);
        quantities.iter().filter_map(move |quantity| {
            let view = View::of(time_series, &quantity.channels, samples.clone())?;
            Statistics::of(&view)?;
            let uncertainty = uncertainty(participant, quantity, window, samples.clone(), judge)?;
            Some((*window, uncertainty))
        })
    });
    each.collect()
}

pub(crate) fn engine_summary(participant: &Participant, judge: Judge<'_>) -> EngineSummary {
    let (mut all_figures, mut judged, mut uncertainties) = (Vec::new(), Vec::new(), Vec::new());
    let finished = participant.status.is_finished();
    for window in judge.windows.iter().filter(|_| finished) {
        let figures = figures(participant, window, judge);
        let samples = participant.time_series.window(window.from_s, window.to_s);
        let there = judge.quantities.iter();
        let there = there.filter(|q| figures.quantities.contains_key(&q.name));
        let known: Vec<QuantityUncertainty> = there
            .filter_map(|q| uncertainty(participant, q, window, samples.clone(), judge))
            .collect();
        if let Some(of_output) = judge.context.output(window)
            && participant.track != SharedModel::Measured
            && judge.quantities.iter().any(|q| q.name == OUTPUT_TORQUE)
        {
            let u = known.iter().find(|u| u.quantity == OUTPUT_TORQUE);
            judged.push(EngineEntry {
                quantity: OUTPUT_TORQUE.to_owned(),
                window: window.kind,
                result: judge.load(participant, samples, of_output, u.map(|u| &u.mean)),
            });
        }
        all_figures.push(figures);
        uncertainties.extend(known);
    }
    EngineSummary {
        name: participant.name.clone(),
        track: participant.track,
        version: participant.version.clone(),
        summary: participant.summary.clone(),
        differences: participant.differences.clone(),
        status: participant.status.clone(),
        cost: participant.cost.clone(),
        figures: all_figures,
        judged,
        uncertainty: uncertainties,
        refinement: judge
            .rules
            .evidence_of(&participant.name)
            .and_then(|e| RefinementSummary::of(e, participant.cost.wall_s)),
    }
}

fn figures(participant: &Participant, window: &Window, judge: Judge<'_>) -> Figures {
    let time_series = &participant.time_series;
    let samples = time_series.window(window.from_s, window.to_s);
    let samples = covered(&[(participant, time_series)], samples);
    let figures = judge.quantities.iter().filter_map(|quantity| {
        let quantity = &shared(quantity, &[participant]);
        let (name, samples) = (&quantity.name, samples.clone());
        let figures = sampling::Figures::of(time_series, name, &quantity.channels, samples)?;
        let named = |of: Statistics| (name.clone(), of);
        Some((named(figures.statistics), named(figures.sampling)))
    });
    let (quantities, sampling): (BTreeMap<_, _>, BTreeMap<_, _>) = figures.unzip();
    let created = model::account(participant, window).map(|e| e.remainder_j / e.driver_j);
    let works = efficiency(participant, window, samples, judge);
    let accounted = works.ok().zip(created);
    let accounted = accounted.map(|(works, created)| works / (1.0 + created));
    let (efficiency, efficiency_reason) = match (works, created) {
        (Err(reason), _) => (None, reason.map(str::to_owned)),
        (Ok(_), Some(created)) if created.abs() > CREATED => (
            None,
            Some(format!(
                "not defined: the contact law {} {:.2} % of the power",
                if created > 0.0 { "creates" } else { "destroys" },
                100.0 * created.abs()
            )),
        ),
        (Ok(_), _) if !judge.context.has_losses && judge.context.friction_coefficient == 0.0 => {
            (None, Some(NO_LOSS.to_owned()))
        }
        (Ok(works), None) if works > 1.0 => (None, Some(ABOVE_ONE.to_owned())),
        (Ok(works), _) => (accounted.or(Some(works)).map(|share| share.min(1.0)), None),
    };
    Figures {
        window: window.kind,
        efficiency,
        efficiency_reason,
        quantities,
        sampling,
    }
}

/// Returns power out over power in, or the reason for its absence if readers need it.
fn efficiency(
    participant: &Participant,
    window: &Window,
    samples: Range<usize>,
    judge: Judge<'_>,
) -> Result<f64, Option<&'static str>> {
    if window.kind == WindowKind::Transient {
        return Err(Some("a start-up stores and returns energy"));
    }
    let context = judge.context;
    let speed_in = context.input_speed_rad_s.ok_or(None)?;
    let account = model::account(participant, window);
    let [power_in, power_out] = account
        .and_then(|account| account.mean_powers(window.from_s, window.to_s))
        .or_else(|| mean_powers(&participant.time_series, samples, speed_in))
        .ok_or(None)?;
    if speed_in == 0.0 {
        return Err(Some("the driver does not turn"));
    }
    let negligible = |load: f64| load.abs() <= judge.negligible.torque_n_m;
    if context.load_n_m.is_some_and(negligible) {
        return Err(Some("the scene has no load, so no power is delivered"));
    }
    ratio(power_in, power_out).map_err(Some)
}

/// Returns the quantity without channels that a measured participant lacks: a rig has force cells on three of sixteen pins.
/// Engines have all channels of a quantity or none.
pub(crate) fn shared(quantity: &Quantity, participants: &[&Participant]) -> Quantity {
    let mut quantity = quantity.clone();
    let is_measured = |p: &&Participant| p.track == SharedModel::Measured;
    if participants.iter().any(is_measured) {
        quantity.channels.retain(|name| {
            let has = |p: &&Participant| p.time_series.channel(name).is_some();
            participants.iter().all(has)
        });
    }
    quantity
}

/// Returns the part of `samples` that all measured participants cover; their data may be missing at both ends.
pub(crate) fn covered(
    participants: &[(&Participant, &TimeSeries)],
    mut samples: Range<usize>,
) -> Range<usize> {
    let measured = |p: &&(&Participant, &TimeSeries)| p.0.track == SharedModel::Measured;
    for (_, time_series) in participants.iter().filter(measured) {
        let channels = time_series.channels();
        let there = |k: usize| {
            let mut values = channels.iter().map(|channel| channel.values.get(k));
            values.all(|value| value.is_some_and(|v| !v.is_nan()))
        };
        while samples.start < samples.end && !there(samples.start) {
            samples.start += 1;
        }
        while samples.start < samples.end && !there(samples.end - 1) {
            samples.end -= 1;
        }
    }
    samples
}
