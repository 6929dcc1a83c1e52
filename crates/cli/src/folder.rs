//! Output folders of commands: the library's, with the command line as their author and its files kept safe.

use std::path::{Path, PathBuf};

pub(crate) use pinwheel::studies::folder::Request;
use pinwheel::studies::folder::{self, PAGE};
use pinwheel::studies::output::write_text;

use crate::failure::Failure;
use crate::{args, interrupt, screen};

/// An output folder in the making. Dropped without [`publish`](Self::publish) it leaves nothing.
#[derive(Debug)]
pub(crate) struct Folder(folder::Folder);

impl Folder {
    /// Checks that `out` may be written, before anything long is run.
    pub(crate) fn prepare(out: &Path, force: bool) -> Result<Self, Failure> {
        let request = Request {
            force,
            ..Request::default()
        };
        Self::asked(out, request)
    }

    /// The same for a request of which the command and its files are not known.
    pub(crate) fn asked(out: &Path, mut request: Request) -> Result<Self, Failure> {
        request.command = args::typed();
        request.inputs.extend(named_files());
        let folder = folder::Folder::prepare(out, request)?;
        interrupt::unfinished(Some(folder.path()));
        Ok(Self(folder))
    }

    /// Where to write for now.
    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes the page.
    pub(crate) fn write_page(&self, html: &str) -> Result<(), Failure> {
        Ok(write_text(&self.path().join(PAGE), html)?)
    }

    /// Writes the page, gives the folder its name, and shows the text and where the page is.
    pub(crate) fn show(self, html: &str, text: &str) -> Result<(), Failure> {
        self.write_page(html)?;
        screen::show_with_page(text, &self.publish()?.join(PAGE))
    }

    /// Gives the folder its name; returns it as the user wrote it.
    pub(crate) fn publish(self) -> Result<PathBuf, Failure> {
        interrupt::check()?;
        let place = self.0.publish()?;
        interrupt::unfinished(None);
        Ok(place)
    }

    /// Writes the page and gives the folder its name although the user asked to stop; it never replaces what is complete.
    pub(crate) fn publish_partial(self, html: &str) -> Result<PathBuf, Failure> {
        self.write_page(html)?;
        let place = self.0.publish_partial()?;
        interrupt::unfinished(None);
        Ok(place)
    }
}

/// Files that the command line names, whatever they are for.
fn named_files() -> Vec<PathBuf> {
    let words = std::env::args_os().skip(1);
    folder::named_files(words.flat_map(|word| {
        // `--against=FILE`
        let value = word.to_str().and_then(|word| word.split_once('='));
        let value = value.map(|(_, value)| PathBuf::from(value));
        value.into_iter().chain([PathBuf::from(word)])
    }))
}

/// Writes a file by itself; what stops the program before leaves nothing, and once begun it comes to its end.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    interrupt::watched();
    interrupt::check()?;
    Ok(pinwheel::studies::folder::replace(path, bytes)?)
}
