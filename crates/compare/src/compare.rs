//! The comparison itself: participants and rules in, verdicts out.

use pinwheel_courses::Courses;

use crate::comparison::{Comparison, EngineSummary};
use crate::judge::{Judge, Negligible, Sides};
use crate::limits::{Limit, MEASURED_ON, StatedLimit, fits};
use crate::matrix::{self, track_of};
use crate::pairs::pair;
use crate::participant::{Context, Participant};
use crate::quantities::{self, Quantity};
use crate::rules::Rules;
use crate::summary::engine_summary;
use crate::uncertainty::Evidence;
use crate::verdict::{Counts, Outcome};
use crate::windows::{self, SETTLING_S, Window};
use crate::{CompareError, grid};

/// Compares by limits alone: [`compare_with`] without evidence.
///
/// `limits` is usually [`limits::TABLE`](crate::limits::TABLE).
///
/// # Errors
/// As [`compare_with`].
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
/// As [`compare_with`].
pub fn compare_stated(
    context: &Context,
    participants: &[Participant],
    limits: &[Limit],
    stated: &[StatedLimit],
) -> Result<Comparison, CompareError> {
    let rules = Rules {
        limits,
        stated,
        ..Rules::default()
    };
    compare_with(context, participants, &rules)
}

/// Compares every finished run with every other on its track, window by window.
///
/// Runs that did not finish are listed with their reason and not judged. A single engine is no error: its figures,
/// its uncertainties and its balance with the load remain.
///
/// # Errors
/// No participant, two of one name, finished runs on different sample times, evidence for nobody, a stated limit
/// that matches nothing.
pub fn compare_with(
    context: &Context,
    participants: &[Participant],
    rules: &Rules<'_>,
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
    for (k, evidence) in rules.evidence.iter().enumerate() {
        let same = |other: &Evidence| other.engine == evidence.engine;
        if !participants.iter().any(|p| p.name == evidence.engine)
            || rules.evidence[..k].iter().any(same)
        {
            return Err(CompareError::Evidence(evidence.engine.clone()));
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
    matched(rules.stated, &finished, &windows, &quantities)?;
    let judge = Judge {
        rules,
        friction: context.friction_coefficient > 0.0,
        guarded: context
            .guarded
            .as_deref()
            .is_some_and(|name| MEASURED_ON.contains(&name)),
        context,
        negligible: Negligible::of(context, &finished, &quantities),
    };

    let engines: Vec<EngineSummary> = participants
        .iter()
        .map(|p| engine_summary(p, context, &windows, &quantities, judge))
        .collect();
    let mut pairs = Vec::new();
    for (k, b) in finished.iter().enumerate() {
        for a in &finished[..k] {
            if let Some(track) = track_of(a, b) {
                let sides = Sides { track, a, b };
                pairs.push(pair(sides, &engines, &windows, &quantities, judge)?);
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
        passed: counts.outcome() == Outcome::Passed,
        outcome: counts.outcome(),
        resolution: rules.resolution,
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

/// Every stated limit has something that it is held against.
fn matched(
    stated: &[StatedLimit],
    finished: &[&Participant],
    windows: &[Window],
    quantities: &[Quantity],
) -> Result<(), CompareError> {
    for limit in stated {
        let Some(owner) = finished.iter().find(|p| p.name == limit.engine) else {
            continue;
        };
        let has = |p: &Participant, q: &Quantity| {
            q.channels
                .iter()
                .any(|name| p.courses.channel(name).is_some())
        };
        // With someone else who has it too.
        let there = |q: &&Quantity| {
            has(owner, q) && finished.iter().any(|p| p.name != owner.name && has(p, q))
        };
        let shared: Vec<&str> = quantities
            .iter()
            .filter(there)
            .map(|q| q.name.as_str())
            .collect();
        let window = windows.iter().any(|w| w.kind == limit.window);
        if window && shared.iter().any(|name| fits(&limit.quantity, name)) {
            continue;
        }
        let words: Vec<&str> = windows.iter().map(|w| w.kind.word()).collect();
        let list = |names: &[&str]| {
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        return Err(CompareError::Unmatched {
            engine: limit.engine.clone(),
            window: limit.window.word(),
            quantity: limit.quantity.clone(),
            available: format!(
                "the windows {} and the quantities {}",
                list(&words),
                list(&shared)
            ),
        });
    }
    Ok(())
}
