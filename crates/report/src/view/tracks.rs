//! One section per track: figures, matrices, verdicts and details, never mixed with another's.

use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::{Comparison, Track};

use super::figures::{self, FigureTable};
use super::matrices::{self, MatrixView};
use super::pairs::{self, PairGroup};

/// A track's part of the page.
pub(super) struct TrackSection {
    /// Anchor.
    pub(super) id: String,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    pub(super) figures: Vec<FigureTable>,
    pub(super) matrices: Vec<MatrixView>,
    pub(super) groups: Vec<PairGroup>,
    /// What was done to put measured data beside the others.
    pub(super) notes: Vec<String>,
    /// Says how cells and lines are read: the first track does.
    pub(super) explains: bool,
    /// Why limits are what they are.
    pub(super) reasons: Vec<String>,
}

/// Sections in the order measured, shared law, own contact, native: who has measured asks for that, and native runs stand in
/// the tables of all others, so that only what they say among themselves is left for the end.
pub(super) fn sections(comparison: &Comparison, styles: &[usize]) -> Vec<TrackSection> {
    let finished = || comparison.engines.iter().filter(|e| e.status.is_finished());
    let mut names: Vec<Track> = Vec::new();
    for engine in finished() {
        if !names.contains(&engine.track) {
            names.push(engine.track);
        }
    }
    names.sort_by_key(|&name| (name == Track::Native, name != Track::Measured, name));
    let alone = names.len() == 1;
    names
        .into_iter()
        .enumerate()
        .map(|(k, name)| section(comparison, name, k, alone, styles))
        .filter(|section| !section.figures.is_empty() || !section.groups.is_empty())
        .collect()
}

fn section(
    comparison: &Comparison,
    name: Track,
    place: usize,
    alone: bool,
    styles: &[usize],
) -> TrackSection {
    let (title, about) = match name {
        Track::Native => (
            "Native",
            "Pinwheel's own solver: its runs against each other, and each against the load.",
        ),
        Track::SharedLaw => (
            "Shared law",
            "Each engine supplies bodies, joints and time integration; all evaluate the same \
             contact law inside their steps. This checks the multibody side to many digits. It \
             cannot find an error in the law, which all sides share.",
        ),
        Track::OwnContact => (
            "Own contact",
            "Each engine detects and resolves contact itself. This checks geometry and law \
             independently, to a few per cent.",
        ),
        Track::Measured => (
            "Measured",
            "Data from elsewhere, another program's export or a test rig, by a map of its columns. \
             Model, parameters, units and sampling may differ. Only limits and uncertainties that the \
             map states are used.",
        ),
    };
    // Native figures stand beside those of every other track; repeat them only if there is none.
    let figures = if name == Track::Native && !alone {
        Vec::new()
    } else {
        figures::tables(comparison, name, styles)
    };
    let measured = comparison.engines.iter().filter(|e| e.track == name);
    let measured = measured.filter(|e| e.track == Track::Measured);
    let notes = |engine: &EngineSummary| {
        let of = engine.name.clone();
        let notes = engine.cost.notes.clone().into_iter();
        notes.map(move |note| format!("{of}: {note}"))
    };
    TrackSection {
        id: format!("track-{}", place + 1),
        title,
        about,
        figures,
        matrices: matrices::of_track(comparison, name),
        reasons: pairs::reasons(comparison, name),
        groups: pairs::of_track(comparison, name),
        notes: measured.flat_map(notes).collect(),
        explains: place == 0,
    }
}
