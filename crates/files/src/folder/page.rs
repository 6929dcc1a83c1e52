//! Where the pages of output folders are.

use std::fs;
use std::path::{Path, PathBuf};

/// File name of the page in an output folder.
pub const PAGE: &str = "index.html";

/// A page, or the one in a folder.
#[must_use]
pub fn page_at(place: &Path) -> Option<PathBuf> {
    let page = if place.is_dir() {
        place.join(PAGE)
    } else {
        place.to_owned()
    };
    page.is_file().then_some(page)
}

/// The page that was written last into a folder of `outs`.
#[must_use]
pub fn newest_page(outs: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(outs).into_iter().flatten().flatten();
    let pages = entries.map(|entry| entry.path().join(PAGE));
    let dated = pages.filter_map(|page| Some((page.metadata().ok()?.modified().ok()?, page)));
    dated.max().map(|(_, page)| page)
}
