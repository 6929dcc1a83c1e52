//! `pinwheel open`: a page in the browser.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::args::OpenArgs;
use crate::failure::Failure;
use crate::folder::PAGE;
use crate::screen;

pub(crate) fn open(args: &OpenArgs) -> Result<u8, Failure> {
    let page = match &args.place {
        Some(place) => named(place)?,
        None => newest(Path::new("out"))?,
    };
    screen::show_with_page("", &page)?;
    if args.print {
        return Ok(0);
    }
    // Whatever the browser writes is none of ours.
    open::that_detached(&page).map_err(|error| {
        Failure::engine(format!(
            "no browser could be started: {error}; open {} yourself, or copy it to where there is one",
            page.display()
        ))
    })?;
    Ok(0)
}

/// A page, or the one in a folder.
fn named(place: &Path) -> Result<PathBuf, Failure> {
    let page = if place.is_dir() {
        place.join(PAGE)
    } else {
        place.to_owned()
    };
    if page.is_file() {
        return Ok(page);
    }
    Err(Failure::input(format!(
        "{} is no page; name an output folder, for example out/paper-compare",
        page.display()
    )))
}

/// The page that was written last.
fn newest(out: &Path) -> Result<PathBuf, Failure> {
    let entries = fs::read_dir(out).into_iter().flatten().flatten();
    let written = |page: &PathBuf| -> Option<SystemTime> { page.metadata().ok()?.modified().ok() };
    let pages = entries.map(|entry| entry.path().join(PAGE));
    let dated = pages.filter_map(|page| Some((written(&page)?, page)));
    dated.max().map(|(_, page)| page).ok_or_else(|| {
        Failure::input(
            "there is no page in out/; make one with `pinwheel compare paper`, or name an output folder",
        )
    })
}
