//! The pairwise matrices: all engines of one track against each other.
//!
//! Tracks are never mixed: a shared-law run cannot find an error in the law, an own-contact run
//! differs by per cents on purpose; in one table each would hide the other. Native engines stand
//! in every matrix.

use crate::comparison::{Cell, Judgement, Matrix, Pair, PairEntry};
use crate::metrics::Metric;
use crate::participant::{Participant, Track};
use crate::quantities::Quantity;
use crate::verdict::{Outcome, Verdict};
use crate::windows::Window;

/// The track two engines are compared on; `None` if they must not be.
pub(crate) fn track_of(a: &Participant, b: &Participant) -> Option<Track> {
    match (a.track, b.track) {
        (a, b) if a == b => Some(a),
        (Track::Native, other) | (other, Track::Native) => Some(other),
        _ => None,
    }
}

/// One matrix per track and window. `native` has one of its own only if no other track does.
pub(crate) fn matrices(
    finished: &[&Participant],
    pairs: &[Pair],
    quantities: &[Quantity],
    windows: &[Window],
) -> Vec<Matrix> {
    let mut tracks: Vec<Track> = Vec::new();
    for participant in finished {
        if participant.track != Track::Native && !tracks.contains(&participant.track) {
            tracks.push(participant.track);
        }
    }
    tracks.sort_unstable();
    if tracks.is_empty() {
        tracks.push(Track::Native);
    }
    let mut matrices = Vec::new();
    for track in tracks {
        let engines: Vec<String> = finished
            .iter()
            .filter(|p| p.track == track || p.track == Track::Native)
            .map(|p| p.name.clone())
            .collect();
        if engines.len() < 2 {
            continue;
        }
        for window in windows {
            let cells = cells(&engines, pairs, quantities, window);
            matrices.push(Matrix {
                track,
                window: window.kind,
                engines: engines.clone(),
                cells,
            });
        }
    }
    matrices
}

fn cells(
    engines: &[String],
    pairs: &[Pair],
    quantities: &[Quantity],
    window: &Window,
) -> Vec<Cell> {
    let mut cells = Vec::new();
    for row in 1..engines.len() {
        for column in 0..row {
            // Engines and pairs have one order, so the smaller index is always `a`.
            let found = pairs
                .iter()
                .position(|p| p.a == engines[column] && p.b == engines[row]);
            if let Some(pair) = found {
                cells.push(cell(row, column, pair, &pairs[pair], quantities, window));
            }
        }
    }
    cells
}

fn cell(
    row: usize,
    column: usize,
    pair: usize,
    entries: &Pair,
    quantities: &[Quantity],
    window: &Window,
) -> Cell {
    let entries: Vec<_> = entries
        .entries
        .iter()
        .filter(|e| e.window == window.kind)
        .collect();
    let largest = |wanted: fn(&Quantity) -> bool| {
        entries
            .iter()
            .filter(|e| quantities.iter().any(|q| q.name == e.quantity && wanted(q)))
            .filter_map(|e| Some((e.metrics.as_ref()?.relative_l2?, &e.quantity)))
            .max_by(|(a, _), (b, _)| a.total_cmp(b))
    };
    let worst = decisive(&entries).or_else(|| {
        let (value, quantity) = largest(Quantity::is_load)?;
        Some(Figure {
            outcome: Outcome::Nothing,
            share: 0.0,
            value: Some(value),
            quantity,
            metric: Metric::RelativeL2,
            combined: None,
        })
    });
    let verdict = Verdict::worst(entries.iter().map(|e| &e.verdict));
    Cell {
        row,
        column,
        pair,
        worst: worst.as_ref().and_then(|w| w.value),
        worst_quantity: worst.as_ref().map(|w| w.quantity.to_owned()),
        worst_metric: worst.as_ref().map(|w| w.metric),
        worst_uncertainty: worst.as_ref().and_then(|w| w.combined),
        force: largest(Quantity::is_force).map(|(value, _)| value),
        torque: largest(Quantity::is_torque).map(|(value, _)| value),
        verdict: verdict.cloned().unwrap_or_else(|| Verdict::NotJudged {
            reason: "nothing to compare".to_owned(),
        }),
    }
}

/// A number that was judged.
struct Figure<'a> {
    outcome: Outcome,
    /// Of its limit or uncertainty.
    share: f64,
    value: Option<f64>,
    quantity: &'a str,
    metric: Metric,
    /// U.
    combined: Option<f64>,
}

/// The figure that decided: of the gravest outcome the one that uses most of its limit or uncertainty.
fn decisive<'a>(entries: &[&'a PairEntry]) -> Option<Figure<'a>> {
    let checks = entries.iter().flat_map(|entry| {
        entry.checks.iter().map(|check| Figure {
            outcome: check.verdict().outcome(),
            share: check.share(),
            value: check.value,
            quantity: &entry.quantity,
            metric: check.metric,
            combined: None,
        })
    });
    let judgements = entries.iter().flat_map(|entry| {
        let judged = entry.judgements.iter().filter(|j| j.counts);
        judged.map(|judgement| Figure {
            outcome: judgement.verdict.outcome(),
            share: share(judgement),
            value: judgement.distance.map(f64::abs),
            quantity: &entry.quantity,
            metric: judgement.metric,
            combined: judgement.combined(),
        })
    });
    judgements.chain(checks).max_by(|a, b| {
        let outcomes = a.outcome.cmp(&b.outcome);
        outcomes.then(a.share.total_cmp(&b.share))
    })
}

/// Distance over what it was allowed to be; what is not known is beyond all.
fn share(judgement: &Judgement) -> f64 {
    let (Some(distance), Some(sum)) = (judgement.distance, judgement.combined()) else {
        return f64::INFINITY;
    };
    let (distance, allowed) = match &judgement.verdict {
        Verdict::ModelDifference {
            predicted,
            tolerance,
            ..
        } => (distance - predicted, sum + tolerance.unwrap_or(0.0)),
        // What is not resolved is so by its uncertainty, not by its distance.
        Verdict::NotResolved { .. } => (sum, 1.0),
        _ => (distance, sum),
    };
    if distance == 0.0 {
        0.0
    } else {
        distance.abs() / allowed
    }
}
