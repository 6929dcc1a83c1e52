//! Table of the engines of a build.

use crate::format::joined;
use crate::terminal::{self, paragraph};
use pinwheel_engines::{family, lacking, remedies};
use pinwheel_studies::choice::Listed;
use pinwheel_timeseries::table::{Mark, Table};

/// Returns the engines by track: those that run on this machine, the requirements of the others, and the meaning of each
/// track.
pub fn text(listed: &[Listed]) -> String {
    let mut needs = remedies();
    let mut rows = Vec::new();
    for engine in listed {
        let here = match &engine.needs {
            Some(_) => "no",
            None => "yes",
        };
        let about = format!("{}: {}", engine.version, engine.summary);
        rows.push((engine.track, &*engine.name, here, about));
        if let Some(what) = &engine.needs {
            let of = needs.entry(what.clone()).or_default();
            of.insert(family(&engine.name));
        }
    }
    for info in lacking() {
        rows.push((info.track, info.name, "no", info.summary.to_owned()));
    }
    rows.sort_by_key(|(track, ..)| *track);
    let table = Table::of("", rows)
        .text("", "engine", |(_, name, ..)| *name)
        .text("", "here", |(.., here, _)| *here)
        .marked(|(.., here, _)| Mark::warn(*here == "no"))
        .text("", "shares", |(track, ..)| track.shares())
        .text("", "what it is", |(.., about)| about.clone());
    let needs = needs.into_iter().map(|(what, families)| {
        let families = joined(", ", families);
        paragraph(&format!("{families}, not here yet: {what}.")) + "\n"
    });
    let tracks = [
        "Take `native-resolved`: it refines its own step until that no longer matters.",
        "`native` stands for the native engine in the formulation that the scene asks for.",
        "shared-law engines share the contact law and check the multibody side to many digits;",
        "own-contact engines find contact themselves and check geometry and law to a few per cent.",
    ];
    format!(
        "{}\n{}{}",
        terminal::table(&table.done()),
        joined("", needs),
        paragraph(&tracks.join(" "))
    )
}
