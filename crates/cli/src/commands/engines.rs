//! `pinwheel engines`: what this build can compare.

use pinwheel::report::terminal::{Cell, TITLE, lines};
use pinwheel::studies::choice;

use crate::args::EnginesArgs;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn engines(args: &EnginesArgs) -> Result<u8, Failure> {
    let listed = choice::listed();
    if args.json {
        screen::show_json(&listed)?;
        return Ok(0);
    }
    let title = |text: &str| Cell::text(text).styled(TITLE);
    let mut rows = vec![vec![
        title("engine"),
        title("track"),
        title("version"),
        title(""),
    ]];
    rows.extend(listed.into_iter().map(|engine| {
        vec![
            Cell::text(engine.name),
            Cell::text(engine.track.as_str()),
            Cell::text(engine.version),
            Cell::text(engine.summary),
        ]
    }));
    screen::show(&format!(
        "{}\n`native` stands for the native engine in the formulation that the scene asks for.\nshared-law engines share the contact law and check the multibody side to many digits;\nown-contact engines find contact themselves and check geometry and law to a few per cent.",
        lines(&rows)
    ))?;
    Ok(0)
}
