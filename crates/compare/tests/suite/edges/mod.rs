//! Mutants of the judge that survived a run of mutation testing; each test detects one (docs/architecture.md).

use super::common;
mod judged;
mod refinement;
mod verdicts;

use common::{participant, time_series};
use pinwheel_compare::comparison::{Comparison, PairEntry};
use pinwheel_compare::{Participant, SharedModel, WindowKind};

const FORCE: &str = "external_sleeve_force_n";

fn native() -> Participant {
    participant("native", SharedModel::Native, time_series(1.0))
}

fn other(track: SharedModel, scale: f64) -> Participant {
    participant("other", track, time_series(scale))
}

fn entry(comparison: &Comparison, window: WindowKind) -> &PairEntry {
    let mut entries = comparison.pairs[0].entries.iter();
    entries
        .find(|e| e.quantity == FORCE && e.window == window)
        .unwrap()
}
