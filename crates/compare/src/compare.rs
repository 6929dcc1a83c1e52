//! Comparison of participants by rules, with verdicts as the result.

use std::collections::BTreeSet;

use pinwheel_timeseries::TimeSeries;

use crate::comparison::{Comparison, EngineSummary};
use crate::judge::{Judge, Negligible, Sides};
use crate::limits::{StatedLimit, fits};
use crate::matrix::{self, track_of};
use crate::pairs::pair;
use crate::participant::{Context, Participant};
use crate::quantities::{self, Quantity};
use crate::rules::Rules;
use crate::summary::engine_summary;
use crate::verdict::Counts;
use crate::windows::{self, SETTLING_S, Window};
use crate::{CompareError, findings, grid};

/// Compares every finished run with every other one that shares a model with it, window by window.
///
/// Runs that did not finish are listed with their reason and not judged. A single engine is no error: its figures,
/// uncertainties and torque balance remain.
///
/// # Errors
/// No participant, two participants of one name, finished runs on different sample times, evidence for an unknown participant,
/// a stated limit without a match.
pub fn compare(
    context: &Context,
    participants: &[Participant],
    rules: &Rules<'_>,
) -> Result<Comparison, CompareError> {
    if participants.is_empty() {
        return Err(CompareError::Empty);
    }
    let mut names = BTreeSet::new();
    if let Some(twice) = participants.iter().find(|p| !names.insert(&p.name)) {
        return Err(CompareError::Duplicate(twice.name.clone()));
    }
    // Evidence for an unknown engine, or a second one for the same engine, is an error.
    if let Some(strange) = rules.evidence.iter().find(|e| !names.remove(&e.engine)) {
        return Err(CompareError::Evidence(strange.engine.clone()));
    }
    let finished = participants.iter().filter(|p| p.status.is_finished());
    let finished: Vec<&Participant> = finished.collect();
    let nothing = TimeSeries::default();
    // The finest sample grid; recordings may have a part of its samples.
    let finest = finished.iter().rev().max_by_key(|p| p.time_series.len());
    if let Some(finest) = finest {
        for other in &finished {
            grid::common(finest, other)?;
        }
    }
    let (windows, absent_windows) = windows::windows(
        finest.map_or(&nothing, |p| &p.time_series),
        context.settling_s.unwrap_or(SETTLING_S),
        &context.load_changes_s,
    );
    let quantities = quantities::derive(finished.iter().map(|p| &p.time_series));
    matched(rules.stated, &finished, &windows, &quantities)?;
    let judge = Judge {
        rules,
        context,
        windows: &windows,
        quantities: &quantities,
        negligible: Negligible::of(context, &finished, &quantities),
    };
    let engines = participants.iter().map(|p| engine_summary(p, judge));
    let engines: Vec<EngineSummary> = engines.collect();
    let mut pairs = Vec::new();
    for (k, b) in finished.iter().enumerate() {
        for a in &finished[..k] {
            if let Some(track) = track_of(a, b) {
                pairs.push(pair(Sides { track, a, b }, &engines, judge)?);
            }
        }
    }
    let matrices = matrix::matrices(&finished, &pairs, judge);
    let mut counts = Counts::default();
    let alone = engines.iter().flat_map(|e| &e.judged).map(|e| &e.result);
    let of_pairs = pairs.iter().flat_map(|p| &p.entries).map(|e| &e.result);
    alone.chain(of_pairs).for_each(|one| counts.add(one));
    let findings = findings::of(&engines, &pairs, judge);
    let mut comparison = Comparison {
        context: context.clone(),
        passed: false,
        findings,
        resolution: rules.resolution,
        counts,
        unfinished: participants.len() - finished.len(),
        windows,
        absent_windows,
        quantities,
        engines,
        pairs,
        matrices,
    };
    comparison.passed = comparison.exit_status() == 0;
    Ok(comparison)
}

/// Checks that every stated limit of a finished engine matches at least one comparison.
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
        let there = |q: &&Quantity| {
            let mut has = finished.iter().filter(|p| q.is_in(&p.time_series));
            // Some other participant must have the quantity, too.
            q.is_in(&owner.time_series) && has.any(|p| p.name != owner.name)
        };
        let shared = quantities.iter().filter(there);
        let shared: Vec<&str> = shared.map(|q| q.name.as_str()).collect();
        let window = windows.iter().any(|w| w.kind == limit.window);
        if window && shared.iter().any(|name| fits(&limit.quantity, name)) {
            continue;
        }
        let words: Vec<&str> = windows.iter().map(|w| w.kind.word()).collect();
        let list = |names: &[&str]| match names {
            [] => "none".to_owned(),
            names => names.join(", "),
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
