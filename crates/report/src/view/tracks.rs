//! One section per track: figures, matrices, verdicts and details, never mixed with another's.

use pinwheel_compare::{Comparison, track};

use super::checks::{self, CheckRow, UnjudgedRow};
use super::figures::{self, FigureTable};
use super::matrices::{self, MatrixView};
use super::pairs::{self, PairView};

/// A track's part of the page.
pub(super) struct TrackSection {
    pub(super) title: String,
    pub(super) about: &'static str,
    pub(super) figures: Vec<FigureTable>,
    pub(super) matrices: Vec<MatrixView>,
    pub(super) checks: Vec<CheckRow>,
    pub(super) unjudged: Vec<UnjudgedRow>,
    pub(super) pairs: Vec<PairView>,
    pub(super) within: usize,
    pub(super) exceeded: usize,
}

/// Sections in the order native, shared law, own contact, others. A native section stands only
/// if it has something of its own to say.
pub(super) fn sections(comparison: &Comparison) -> Vec<TrackSection> {
    let finished = || comparison.engines.iter().filter(|e| e.status.is_finished());
    let mut names: Vec<&str> = Vec::new();
    for engine in finished() {
        if !names.contains(&engine.track.as_str()) {
            names.push(&engine.track);
        }
    }
    names.sort_by_key(|name| match *name {
        track::NATIVE => 0,
        track::SHARED_LAW => 1,
        track::OWN_CONTACT => 2,
        _ => 3,
    });
    let alone = names.len() == 1;
    names
        .into_iter()
        .map(|name| section(comparison, name, alone))
        .collect()
}

fn section(comparison: &Comparison, name: &str, alone: bool) -> TrackSection {
    let (title, about) = match name {
        track::NATIVE => (
            "Native".to_owned(),
            "Pinwheel's own solver: its runs against each other, and each against the load.",
        ),
        track::SHARED_LAW => (
            "Shared law".to_owned(),
            "Each engine supplies bodies, joints and time integration; all evaluate the same \
             contact law inside their steps. This checks the multibody side to many digits. It \
             cannot find an error in the law, which all sides share.",
        ),
        track::OWN_CONTACT => (
            "Own contact".to_owned(),
            "Each engine detects and resolves contact itself. This checks geometry and law \
             independently, to a few per cent.",
        ),
        other => (
            other.to_owned(),
            "Runs of this track against each other and native runs.",
        ),
    };
    let (checks, unjudged) = checks::rows(comparison, name);
    // Native figures stand beside those of every other track; repeat them only if there is none.
    let figures = if name == track::NATIVE && !alone {
        Vec::new()
    } else {
        figures::tables(comparison, name)
    };
    TrackSection {
        title,
        about,
        figures,
        matrices: matrices::of_track(comparison, name),
        within: checks
            .iter()
            .filter(|row| row.mark.class == "within")
            .count(),
        exceeded: checks
            .iter()
            .filter(|row| row.mark.class == "exceeded")
            .count(),
        checks,
        unjudged,
        pairs: pairs::of_track(comparison, name),
    }
}
