//! The comparison itself: participants and limits in, verdicts out.

use std::collections::BTreeMap;
use std::ops::Range;

use pinwheel_courses::Courses;

use crate::comparison::{Comparison, EngineEntry, EngineSummary, Figures, Pair, PairEntry};
use crate::grid::Common;
use crate::judge::{Judge, Sides};
use crate::limits::{Limit, StatedLimit};
use crate::matrix::{self, track_of};
use crate::metrics::PairMetrics;
use crate::participant::{Context, Participant, track};
use crate::quantities::{self, INPUT_TORQUE, OUTPUT_ANGLE, OUTPUT_TORQUE, Quantity};
use crate::statistics::{Statistics, View};
use crate::verdict::{Counts, Verdict};
use crate::windows::{self, FEWEST_SAMPLES, SETTLING_S, Window, WindowKind};
use crate::{CompareError, grid};

/// Compares every finished run with every other on its track, window by window.
///
/// `limits` is usually [`limits::TABLE`](crate::limits::TABLE). Runs that did not finish are
/// listed with their reason and not judged. A single engine is no error: its figures and its
/// balance with the load remain.
///
/// # Errors
/// No participant, two of one name, or finished runs on different sample times.
pub fn compare(
    context: &Context,
    participants: &[Participant],
    limits: &[Limit],
) -> Result<Comparison, CompareError> {
    compare_stated(context, participants, limits, &[])
}

/// [`compare`] with measured participants, held against the limits stated for them alone.
///
/// # Errors
/// As [`compare`].
pub fn compare_stated(
    context: &Context,
    participants: &[Participant],
    limits: &[Limit],
    stated: &[StatedLimit],
) -> Result<Comparison, CompareError> {
    if participants.is_empty() {
        return Err(CompareError::Empty);
    }
    for (k, participant) in participants.iter().enumerate() {
        if participants[..k]
            .iter()
            .any(|other| other.name == participant.name)
        {
            return Err(CompareError::Duplicate(participant.name.clone()));
        }
    }
    let finished: Vec<&Participant> = participants
        .iter()
        .filter(|p| p.status.is_finished())
        .collect();
    let nothing = Courses::default();
    // The finest grid: recordings may hold a part of it.
    let finest = finished
        .iter()
        .rev()
        .max_by_key(|p| p.courses.len())
        .copied();
    if let Some(finest) = finest {
        for other in &finished {
            grid::common(finest, other)?;
        }
    }
    let (windows, absent_windows) = windows::windows(
        finest.map_or(&nothing, |p| &p.courses),
        context.settling_s.unwrap_or(SETTLING_S),
        &context.load_changes_s,
    );
    let quantities = quantities::derive(finished.iter().map(|p| &p.courses));
    let judge = Judge {
        limits,
        stated,
        friction: context.friction_coefficient > 0.0,
        context,
    };

    let engines: Vec<EngineSummary> = participants
        .iter()
        .map(|p| engine_summary(p, context, &windows, &quantities, judge))
        .collect();
    let mut pairs = Vec::new();
    for (k, b) in finished.iter().enumerate() {
        for a in &finished[..k] {
            if let Some(track) = track_of(a, b) {
                pairs.push(pair(Sides { track, a, b }, &windows, &quantities, judge)?);
            }
        }
    }
    let matrices = matrix::matrices(&finished, &pairs, &quantities, &windows);
    let mut counts = Counts::default();
    engines
        .iter()
        .flat_map(|e| &e.judged)
        .for_each(|entry| counts.add(&entry.verdict));
    pairs
        .iter()
        .flat_map(|p| &p.entries)
        .for_each(|entry| counts.add(&entry.verdict));
    Ok(Comparison {
        context: context.clone(),
        passed: counts.exceeded == 0 && counts.within > 0,
        counts,
        unfinished: participants.len() - finished.len(),
        windows,
        absent_windows,
        quantities,
        engines,
        pairs,
        matrices,
    })
}

fn engine_summary(
    participant: &Participant,
    context: &Context,
    windows: &[Window],
    quantities: &[Quantity],
    judge: Judge<'_>,
) -> EngineSummary {
    let (mut all_figures, mut judged) = (Vec::new(), Vec::new());
    let windows = if participant.status.is_finished() {
        windows
    } else {
        &[]
    };
    for window in windows {
        let figures = figures(participant, context, window, quantities);
        let output = quantities.iter().find(|q| q.name == OUTPUT_TORQUE);
        let judged_alone = participant.track != track::MEASURED;
        if let Some((quantity, load_n_m)) = output.zip(context.load_n_m).filter(|_| judged_alone) {
            let mean = figures
                .quantities
                .get(OUTPUT_TORQUE)
                .map(|statistics| statistics.mean);
            let found = judge.load(participant, quantity, window.kind, mean, load_n_m);
            let found = found.map(|(checks, verdict)| {
                if participant.cost.recorded.is_none() {
                    return (checks, verdict);
                }
                // One sample a millisecond aliases the ripple into the mean: 1e-4 of it for 40 sleeves.
                let reason = "a recording has too few samples for this mean".to_owned();
                (Vec::new(), Verdict::NotJudged { reason })
            });
            judged.extend(found.map(|(checks, verdict)| EngineEntry {
                quantity: quantity.name.clone(),
                window: window.kind,
                checks,
                verdict,
            }));
        }
        all_figures.push(figures);
    }
    EngineSummary {
        name: participant.name.clone(),
        track: participant.track.clone(),
        version: participant.version.clone(),
        summary: participant.summary.clone(),
        differences: participant.differences.clone(),
        status: participant.status.clone(),
        cost: participant.cost.clone(),
        figures: all_figures,
        judged,
    }
}

fn figures(
    participant: &Participant,
    context: &Context,
    window: &Window,
    quantities: &[Quantity],
) -> Figures {
    let courses = &participant.courses;
    let samples = covered(
        &[(participant, courses)],
        courses.window(window.from_s, window.to_s),
    );
    let statistics: BTreeMap<String, Statistics> = quantities
        .iter()
        .filter_map(|quantity| {
            let quantity = &shared(quantity, &[participant]);
            let view = View::of(courses, quantity, samples.clone())?;
            Some((quantity.name.clone(), Statistics::of(&view)?))
        })
        .collect();
    let efficiency = || {
        // A start-up stores and returns energy: no efficiency there.
        if window.kind == WindowKind::Transient {
            return None;
        }
        let mean = |name: &str| statistics.get(name).map(|s| s.mean);
        let time_s = courses.time_s().get(samples.clone())?;
        let angle_rad = courses.channel(OUTPUT_ANGLE)?.get(samples.clone())?;
        let turned = angle_rad.last()? - angle_rad.first()?;
        let output_speed = turned / (time_s.last()? - time_s.first()?);
        let power_in = mean(INPUT_TORQUE)? * context.input_speed_rad_s?;
        let efficiency = mean(OUTPUT_TORQUE)? * output_speed / power_in;
        (power_in > 0.0 && efficiency.is_finite()).then_some(efficiency)
    };
    Figures {
        window: window.kind,
        efficiency: efficiency(),
        quantities: statistics,
    }
}

/// The quantity without channels that a measured participant lacks: a rig has force cells on three of
/// sixteen sleeves. Engines have all channels of a quantity or none.
fn shared(quantity: &Quantity, participants: &[&Participant]) -> Quantity {
    let mut quantity = quantity.clone();
    if participants.iter().any(|p| p.track == track::MEASURED) {
        quantity.channels.retain(|name| {
            let has = |p: &&Participant| p.courses.channel(name).is_some();
            participants.iter().all(has)
        });
    }
    quantity
}

/// The part of `samples` that all measured participants cover: theirs may be missing at both ends.
fn covered(participants: &[(&Participant, &Courses)], mut samples: Range<usize>) -> Range<usize> {
    let measured = |p: &&(&Participant, &Courses)| p.0.track == track::MEASURED;
    for (_, courses) in participants.iter().filter(measured) {
        let channels = courses.channels();
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

fn pair(
    sides: Sides<'_>,
    windows: &[Window],
    quantities: &[Quantity],
    judge: Judge<'_>,
) -> Result<Pair, CompareError> {
    let Sides { track, a, b } = sides;
    let common = grid::common(a, b)?;
    let mut entries = Vec::new();
    for window in windows {
        for quantity in quantities {
            entries.extend(pair_entry(sides, &common, window, quantity, judge));
        }
    }
    Ok(Pair {
        a: a.name.clone(),
        b: b.name.clone(),
        track: track.to_owned(),
        entries,
    })
}

/// `None` if neither engine has the quantity.
fn pair_entry(
    sides: Sides<'_>,
    (of_a, of_b): &Common<'_>,
    window: &Window,
    quantity: &Quantity,
    judge: Judge<'_>,
) -> Option<PairEntry> {
    let Sides { a, b, .. } = sides;
    let entry = |metrics, checks, verdict| {
        let quantity = quantity.name.clone();
        Some(PairEntry {
            quantity,
            window: window.kind,
            metrics,
            checks,
            verdict,
        })
    };
    let unjudged = |reason| entry(None, Vec::new(), Verdict::NotJudged { reason });
    let has = |p: &Participant| {
        quantity
            .channels
            .iter()
            .filter(|name| p.courses.channel(name).is_some())
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
    let quantity = &shared(quantity, &[a, b]);
    if samples.len() < FEWEST_SAMPLES {
        return unjudged(format!(
            "both have {} samples in this window, fewer than {FEWEST_SAMPLES}",
            samples.len()
        ));
    }
    let metrics = View::of(of_a, quantity, samples.clone())
        .zip(View::of(of_b, quantity, samples.clone()))
        .zip(of_a.time_s().get(samples))
        .and_then(|((of_a, of_b), time_s)| PairMetrics::of(&of_a, &of_b, time_s));
    let Some(metrics) = metrics else {
        return unjudged(format!(
            "`{}` has channels that only one of the two has",
            quantity.name
        ));
    };
    let (checks, verdict) = judge.pair(sides, quantity, window, &metrics);
    entry(Some(metrics), checks, verdict)
}
