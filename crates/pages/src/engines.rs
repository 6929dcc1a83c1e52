//! The engines of a build, as a table.

use pinwheel_report::terminal::{Cell, TITLE, lines, paragraph};
use pinwheel_studies::choice::Listed;

/// The engines by track, and what tracks mean.
#[must_use]
pub fn text(listed: &[Listed]) -> String {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let mut track = None;
    let mut listed: Vec<&Listed> = listed.iter().collect();
    listed.sort_by_key(|engine| engine.track);
    for engine in listed {
        if track != Some(engine.track) {
            track = Some(engine.track);
            rows.push(vec![Cell::text(engine.track.as_str()).styled(TITLE)]);
        }
        rows.push(vec![
            Cell::text(&engine.name),
            Cell::text(format!("{}: {}", engine.version, engine.summary)),
        ]);
    }
    let tracks = [
        "`native` stands for the native engine in the formulation that the scene asks for.",
        "shared-law engines share the contact law and check the multibody side to many digits;",
        "own-contact engines find contact themselves and check geometry and law to a few per cent.",
    ];
    format!("{}\n{}", lines(&rows), paragraph(&tracks.join(" ")))
}
