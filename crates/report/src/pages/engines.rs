//! Table of the engines of a build.

use std::collections::{BTreeMap, BTreeSet};

use crate::format::joined;
use crate::terminal::{self, paragraph};
use pinwheel_engines::{family, lacking, remedy};
use pinwheel_studies::choice::Listed;
use pinwheel_timeseries::table::Table;

/// Returns the engines by track, with the meaning of tracks.
#[must_use]
pub fn text(listed: &[Listed]) -> String {
    let mut listed: Vec<&Listed> = listed.iter().collect();
    listed.sort_by_key(|engine| engine.track);
    let table = Table::of("", listed)
        .text("", "engine", |engine| &engine.name)
        .text("", "shares", |engine| engine.track.shares())
        .text("", "what it is", |engine| {
            format!("{}: {}", engine.version, engine.summary)
        });
    let mut lacks: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for info in lacking() {
        let of = remedy(info).unwrap_or_default();
        lacks.entry(of).or_default().insert(family(info.name));
    }
    let lacks = lacks.into_iter().map(|(remedy, families)| {
        let families = joined(", ", families);
        paragraph(&format!("{families}: not here; {remedy}."))
    });
    let tracks = [
        "`native` stands for the native engine in the formulation that the scene asks for.",
        "shared-law engines share the contact law and check the multibody side to many digits;",
        "own-contact engines find contact themselves and check geometry and law to a few per cent.",
    ];
    format!(
        "{}\n{}{}",
        terminal::table(&table.done()),
        joined("", lacks),
        paragraph(&tracks.join(" "))
    )
}
