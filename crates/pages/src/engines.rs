//! The engines of a build, as a table.

use pinwheel_report::terminal::{Cell, TITLE, lines, paragraph};
use pinwheel_studies::choice::Listed;

/// One line an engine, and what their tracks mean.
#[must_use]
pub fn text(listed: &[Listed]) -> String {
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let mut rows = vec![["engine", "track", "version", ""].map(title).to_vec()];
    rows.extend(listed.iter().map(|engine| {
        vec![
            Cell::text(&engine.name),
            Cell::text(engine.track.as_str()),
            Cell::text(&engine.version),
            Cell::text(&engine.summary),
        ]
    }));
    let tracks = [
        "`native` stands for the native engine in the formulation that the scene asks for.",
        "shared-law engines share the contact law and check the multibody side to many digits;",
        "own-contact engines find contact themselves and check geometry and law to a few per cent.",
    ];
    format!("{}\n{}", lines(&rows), paragraph(&tracks.join(" ")))
}
