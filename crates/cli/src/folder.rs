//! Outputs of commands: folders and files of the library with the command line as their origin.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use pinwheel::scene::preset;
use pinwheel::studies::Provenance;
use pinwheel::studies::file::{self, Ours};
pub(crate) use pinwheel::studies::folder::Request;
use pinwheel::studies::folder::{self, PAGE, leftovers};
use pinwheel::studies::junit;
use pinwheel::studies::output::{OutputError, write_text};

use crate::args::{self, OutArgs, label, quoted};
use crate::failure::Failure;
use crate::{interrupt, screen, words};

/// Output folder under construction, removed unless [published](Self::publish).
#[derive(Debug)]
pub(crate) struct Folder(folder::Folder);

impl Folder {
    /// Prepares the requested folder, or `out/NAME`, for the results of `of`; `out/NAME` never replaces results of another
    /// subject.
    pub(crate) fn of(out: &OutArgs, name: impl AsRef<Path>, of: &str) -> Result<Self, Failure> {
        let request = Request {
            of: of.to_owned(),
            only_of: out.out.is_none(),
            force: out.force,
            ..Request::default()
        };
        Self::asked(&out.or(name), request)
    }

    /// Prepares the requested folder, or one in `out` with the names of the scenes' files or presets.
    pub(crate) fn of_scenes(out: &OutArgs, specs: &[&str], command: &str) -> Result<Self, Failure> {
        let labels: Vec<String> = specs.iter().map(|spec| label(spec)).collect();
        let name = format!("{}-{command}", labels.join("-and-"));
        let of = specs.iter().map(|spec| match preset(spec) {
            Some(_) => (*spec).to_owned(),
            None => relative(Path::new(spec)),
        });
        Self::of(out, name, &of.collect::<Vec<_>>().join(" and "))
    }

    /// Prepares a new folder without a manifest, for files that belong to the user.
    pub(crate) fn fresh(out: &Path) -> Result<Self, Failure> {
        let request = Request {
            fresh: true,
            ..Request::default()
        };
        let failed = |failure: Failure| {
            let message = failure.message.trim_start_matches("--out ");
            Failure::input(message.replace("choose another --out", "choose another name"))
        };
        Self::asked(out, request).map_err(failed)
    }

    /// Checks that `out` may be written, before any long run; adds command and files to the request.
    pub(crate) fn asked(out: &Path, mut request: Request) -> Result<Self, Failure> {
        request.command = args::typed();
        request.inputs.extend(named_files());
        let folder = folder::Folder::prepare(out, request)?;
        interrupt::unfinished(Some(folder.draft()));
        name_leftovers(folder.draft());
        Ok(Self(folder))
    }

    /// Returns the folder to write into until it is published.
    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Returns the target as typed.
    pub(crate) fn place(&self) -> &Path {
        self.0.place()
    }

    /// Writes the files of a result by `write`; returns their origin for pages and files.
    pub(crate) fn write<E: Into<Failure>>(
        &self,
        write: impl FnOnce(&Path, &Provenance) -> Result<(), E>,
    ) -> Result<Provenance, Failure> {
        let origin = Provenance::here(args::typed());
        write(self.path(), &origin).map_err(E::into)?;
        Ok(origin)
    }

    /// Writes the page.
    pub(crate) fn write_page(&self, html: &str) -> Result<(), Failure> {
        Ok(write_text(&self.path().join(PAGE), html)?)
    }

    /// Writes the page, publishes the folder, and shows the text and the page's path.
    pub(crate) fn show(self, html: &str, text: &str) -> Result<(), Failure> {
        self.write_page(html)?;
        screen::show_with_page(text, &self.publish()?.join(PAGE))
    }

    /// Publishes the folder; returns it as typed.
    pub(crate) fn publish(self) -> Result<PathBuf, Failure> {
        interrupt::check()?;
        // The draft may be the earlier output by now, which a second signal must not delete.
        interrupt::unfinished(None);
        Ok(self.0.publish()?)
    }

    /// Writes the page and publishes the folder in spite of a stop; it never replaces a complete output.
    pub(crate) fn publish_partial(self, html: &str) -> Result<PathBuf, Failure> {
        self.write_page(html)?;
        interrupt::unfinished(None);
        Ok(self.0.publish_partial()?)
    }
}

/// Returns a file relative to the working folder, so that two spellings of it are equal.
pub(crate) fn relative(file: &Path) -> String {
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let here = std::env::current_dir().unwrap_or_default();
    let inside = absolute.strip_prefix(here).unwrap_or(&absolute);
    inside.display().to_string()
}

/// Names the scenes of a study that has default scenes.
pub(crate) fn all_or(scenes: &[String]) -> String {
    match scenes {
        [] => "all its scenes".to_owned(),
        scenes => scenes.join(" and "),
    }
}

/// Returns all existing files on the command line.
fn named_files() -> Vec<PathBuf> {
    folder::named_files(words::typed().flat_map(|word| {
        // `--against=FILE`
        let value = word.to_str().and_then(|word| word.split_once('='));
        let value = value.map(|(_, value)| PathBuf::from(value));
        value.into_iter().chain([PathBuf::from(word)])
    }))
}

/// Reports the drafts of killed commands beside `path`, each once, and the command that removes them.
pub(crate) fn name_leftovers(path: &Path) {
    // Further drafts are reported after the removal of these.
    const MOST: usize = 100;
    static NAMED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let absolute = std::path::absolute(path).unwrap_or_default();
    let here = std::env::current_dir().unwrap_or_default();
    let mut folders = absolute.ancestors().skip(1);
    let beside = folders.next();
    // A draft is in a parent folder if the folder did not exist.
    let above = folders.take_while(|folder| folder.starts_with(&here));
    let folders = beside.into_iter().chain(above);
    let mut left: Vec<PathBuf> = folders.flat_map(leftovers).collect();
    if let Ok(mut named) = NAMED.lock() {
        left.retain(|path| named.insert(path.clone()));
    }
    if left.is_empty() {
        return;
    }
    let words = left.iter().take(MOST).map(|path| {
        let short = path.strip_prefix(&here).unwrap_or(path);
        quoted(&short.display().to_string())
    });
    let words = words.collect::<Vec<_>>().join(" ");
    screen::show_on_stderr(&format!(
        "note: a command that was killed left what `rm -r {words}` removes"
    ));
}

fn refused(error: &OutputError) -> Failure {
    Failure::input(format!("{error}; name another file"))
}

/// Checks that a single file may be written, before any long run.
pub(crate) fn check(path: &Path, ours: Ours<'_>) -> Result<(), Failure> {
    file::check(path, ours).map_err(|error| refused(&error))
}

/// Writes a single file, replacing only one that is `ours`; after an earlier stop writes nothing.
pub(crate) fn replace(path: &Path, bytes: &[u8], ours: Ours<'_>) -> Result<(), Failure> {
    interrupt::watched();
    interrupt::check()?;
    name_leftovers(path);
    file::replace(path, bytes, ours).map_err(|error| refused(&error))
}

/// Checks that verdicts may be written as a JUnit file, before any long run.
pub(crate) fn check_junit(path: Option<&Path>, out: &Path) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    let absolute = |path| std::path::absolute(path).unwrap_or_default();
    if absolute(path).starts_with(absolute(out)) {
        let path = path.display();
        return Err(Failure::input(format!(
            "--junit {path} is in the output folder, which is replaced as a whole; name a file outside of it"
        )));
    }
    name_leftovers(path);
    junit::check(path).map_err(|error| refused(&error))
}
