//! `pinwheel open`: opens a page in the browser.

use std::path::Path;

use pinwheel::studies::folder;

use crate::args::OpenArgs;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn open(args: &OpenArgs) -> Result<(), Failure> {
    let page = match &args.place {
        Some(place) => folder::page_at(place).ok_or_else(|| {
            Failure::input(format!(
                "{} holds no page; name an output folder, for example out/paper-compare",
                place.display()
            ))
        })?,
        None => folder::newest_page(Path::new("out")).ok_or_else(|| {
            Failure::input(
                "there is no page in out/; make one with `pinwheel compare paper`, or name an output folder",
            )
        })?,
    };
    screen::show_with_page("", &page)?;
    if args.print {
        return Ok(());
    }
    // Output of the browser is irrelevant.
    open::that_detached(&page).map_err(|error| {
        Failure::engine(format!(
            "no browser could be started: {error}; open {} yourself, or copy it to a machine with a browser",
            page.display()
        ))
    })
}
