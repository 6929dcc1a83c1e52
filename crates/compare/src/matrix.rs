//! The pairwise matrices: all engines of one track against each other.
//!
//! Tracks are never mixed: a shared-law run cannot find an error in the law, an own-contact run
//! differs by per cents on purpose; in one table each would hide the other. Native engines stand
//! in every matrix.

use crate::comparison::{Cell, Matrix, Pair};
use crate::metrics::Metric;
use crate::participant::{Participant, Track};
use crate::quantities::Quantity;
use crate::verdict::Assessment;
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
    let worst = entries.iter().reduce(|a, b| {
        let graver = Assessment::worst([&a.result, &b.result]);
        if graver == Some(&a.result) { a } else { b }
    });
    let decided = worst.filter(|entry| entry.result.rank() > 0);
    let (quantity, result) = match (decided, largest(Quantity::is_load)) {
        (None, Some((value, quantity))) => {
            let shown = Assessment {
                metric: Some(Metric::RelativeL2),
                difference: Some(value),
                u_a: None,
                u_b: None,
                ..worst.map_or_else(nothing, |entry| entry.result.clone())
            };
            (Some(quantity.clone()), shown)
        }
        _ => (
            worst.map(|entry| entry.quantity.clone()),
            worst.map_or_else(nothing, |entry| entry.result.clone()),
        ),
    };
    Cell {
        row,
        column,
        pair,
        quantity,
        force: largest(Quantity::is_force).map(|(value, _)| value),
        torque: largest(Quantity::is_torque).map(|(value, _)| value),
        result,
    }
}

fn nothing() -> Assessment {
    Assessment::not_compared("nothing to compare")
}
