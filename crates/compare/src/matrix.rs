//! Pairwise matrices: all engines with one shared model against each other.
//!
//! Shared models are never mixed. A shared-law run cannot reveal an error of the law, and an own-contact run differs by per
//! cents on purpose; in one table each would hide the other. Native engines are in every matrix.

use std::collections::BTreeSet;

use crate::comparison::{Cell, Matrix, Pair};
use crate::judge::Judge;
use crate::metrics::Metric;
use crate::participant::{Participant, SharedModel};
use crate::quantities::Quantity;
use crate::verdict::Assessment;
use crate::windows::Window;

/// Returns the shared model under which two engines are compared; `None` if they must not be compared.
pub(crate) fn track_of(a: &Participant, b: &Participant) -> Option<SharedModel> {
    match (a.track, b.track) {
        (a, b) if a == b => Some(a),
        (SharedModel::Native, other) | (other, SharedModel::Native) => Some(other),
        _ => None,
    }
}

/// Returns one matrix per shared model and window. `native` has one only if no other model does.
pub(crate) fn matrices(finished: &[&Participant], pairs: &[Pair], judge: Judge<'_>) -> Vec<Matrix> {
    let mut tracks: BTreeSet<SharedModel> = finished.iter().map(|p| p.track).collect();
    tracks.remove(&SharedModel::Native);
    if tracks.is_empty() {
        tracks.insert(SharedModel::Native);
    }
    let mut matrices = Vec::new();
    for track in tracks {
        let engines = finished.iter();
        let engines = engines.filter(|p| p.track == track || p.track == SharedModel::Native);
        let engines: Vec<String> = engines.map(|p| p.name.clone()).collect();
        if engines.len() < 2 {
            continue;
        }
        for window in judge.windows {
            let places =
                (1..engines.len()).flat_map(|row| (0..row).map(move |column| [row, column]));
            let cells =
                places.filter_map(|place| cell(place, &engines, pairs, judge.quantities, window));
            matrices.push(Matrix {
                track,
                window: window.kind,
                cells: cells.collect(),
                engines: engines.clone(),
            });
        }
    }
    matrices
}

/// Returns the cell of two engines; `None` if they were not compared.
fn cell(
    [row, column]: [usize; 2],
    engines: &[String],
    pairs: &[Pair],
    quantities: &[Quantity],
    window: &Window,
) -> Option<Cell> {
    // Engines and pairs have the same order, so the smaller index is always `a`.
    let both = |p: &Pair| p.a == engines[column] && p.b == engines[row];
    let pair = pairs.iter().position(both)?;
    let entries = || {
        let all = pairs[pair].entries.iter();
        all.filter(|e| e.window == window.kind)
    };
    let largest = |wanted: fn(&Quantity) -> bool| {
        entries()
            .filter(|e| quantities.iter().any(|q| q.name == e.quantity && wanted(q)))
            .filter_map(|e| Some((e.metrics.as_ref()?.relative_l2?, &e.quantity)))
            .max_by(|(a, _), (b, _)| a.total_cmp(b))
    };
    let worst = Assessment::gravest(entries(), |entry| &entry.result);
    let (mut quantity, mut result) = match worst {
        Some(entry) => (Some(&entry.quantity), entry.result.clone()),
        None => (None, Assessment::not_compared("nothing to compare")),
    };
    if result.rank() == 0
        && let Some((value, of)) = largest(Quantity::is_load)
    {
        quantity = Some(of);
        result = Assessment {
            metric: Some(Metric::RelativeL2),
            difference: Some(value),
            u_a: None,
            u_b: None,
            ..result
        };
    }
    Some(Cell {
        row,
        column,
        pair,
        quantity: quantity.cloned(),
        force: largest(Quantity::is_force).map(|(value, _)| value),
        torque: largest(Quantity::is_torque).map(|(value, _)| value),
        result,
    })
}
