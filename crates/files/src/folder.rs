//! Output folders: written completely or not at all, and never over foreign files.
//!
//! Output is written into a new folder beside the target, which then takes the target's name in one step. An earlier output is
//! replaced if its manifest lists every file in it with size and hash; anything else there stays.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let base = tempfile::tempdir()?;
//! use pinwheel_files::folder::{Folder, Request};
//!
//! let out = base.path().join("mine");
//! let folder = Folder::prepare(&out, Request::default())?;
//! std::fs::write(folder.path().join("notes.txt"), "1.4529 N m")?;
//! assert!(!out.exists(), "nothing is there until all of it is");
//! folder.publish()?;
//! assert!(out.join("notes.txt").is_file());
//! # Ok(())
//! # }
//! ```

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use tempfile::TempDir;

use crate::draft::{self, nearest_existing, sync};
pub use crate::draft::{draft_in, leftovers};
use crate::manifest::{Manifest, Stranger, stranger};
use crate::output::OutputError;

/// File name of an output folder's page.
pub const PAGE: &str = "index.html";

/// Reason why a folder cannot take an output.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FolderError {
    /// Empty name.
    #[error("the name of the output folder is empty")]
    Empty,
    /// Place that must not receive output.
    #[error("{}: {reason}", shown.display())]
    Refused {
        /// Folder as requested.
        shown: PathBuf,
        /// Fault of the place.
        reason: String,
    },
    /// Earlier output that only [`Request::force`] replaces.
    #[error("{}: {reason}", shown.display())]
    Kept {
        /// Folder as requested.
        shown: PathBuf,
        /// Reason why it is kept.
        reason: String,
    },
    /// Output that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Request for an output folder.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Command for the manifest, ready to be repeated.
    pub command: String,
    /// Scene or other subject of the results.
    pub of: String,
    /// Keeps an earlier output with another known subject.
    pub only_of: bool,
    /// Replaces modified files of this program, and outputs of another subject.
    pub force: bool,
    /// Requires a free place; the output gets no manifest.
    pub fresh: bool,
    /// Input files: an output folder that is or contains an input is refused.
    pub inputs: Vec<PathBuf>,
}

/// Output folder under construction. Dropped without [`publish`](Self::publish) it leaves nothing.
#[derive(Debug)]
pub struct Folder {
    /// Absolute path without links.
    target: PathBuf,
    /// Path as the user wrote it.
    shown: PathBuf,
    request: Request,
    /// Folder of the new output, and of the earlier one after an exchange; only the owner may enter it.
    draft: TempDir,
    /// Folder of the new output inside the draft, with the output's mode.
    content: PathBuf,
}

impl Folder {
    /// Checks that `out` may be written, before a long run.
    ///
    /// # Errors
    /// Place that must not receive output, or that cannot be written.
    pub fn prepare(out: &Path, request: Request) -> Result<Self, FolderError> {
        let target = resolved(out)?;
        inspect_surroundings(&target, out, &request)?;
        inspect(&target, out, &request)?;
        let beside = nearest_existing(target.parent().unwrap_or(&target));
        let failed = |error: io::Error| OutputError::new(&beside, &error);
        let draft = draft::folder(&beside).map_err(failed)?;
        let content = draft.path().join("new");
        fs::create_dir(&content).map_err(failed)?;
        Ok(Self {
            target,
            shown: out.to_owned(),
            request,
            draft,
            content,
        })
    }

    /// Returns the folder to write into.
    pub fn path(&self) -> &Path {
        &self.content
    }

    /// Returns the target as the user wrote it.
    pub fn place(&self) -> &Path {
        &self.shown
    }

    /// Returns the draft, which remains after a kill.
    pub fn draft(&self) -> &Path {
        self.draft.path()
    }

    /// Renames the folder to its target; returns the target as the user wrote it.
    ///
    /// # Errors
    /// The folder cannot be written, or its place now has something that must stay.
    pub fn publish(self) -> Result<PathBuf, FolderError> {
        self.finish(true)
    }

    /// Publishes after the user requested a stop, for studies whose results state their progress.
    ///
    /// A complete earlier output stays: the partial one is placed beside it, `out/bench.partial` for `out/bench`, or if that
    /// exists `out/bench.partial-2` and so on.
    ///
    /// # Errors
    /// Errors of [`publish`](Self::publish).
    pub fn publish_partial(mut self) -> Result<PathBuf, FolderError> {
        let numbered = (2..100).map(|number| format!(".partial-{number}"));
        let first = [String::new(), ".partial".to_owned()].into_iter();
        let mut endings = first.chain(numbered);
        let free = |ending: &String| {
            let place = beside(&self.target, ending);
            let complete = Manifest::of(&place).is_some_and(|manifest| manifest.complete);
            !complete && inspect(&place, &self.shown, &self.request).is_ok()
        };
        let ending = endings.find(free).unwrap_or_default();
        self.target = beside(&self.target, &ending);
        self.shown = beside(&self.shown, &ending);
        self.finish(false)
    }

    fn finish(self, complete: bool) -> Result<PathBuf, FolderError> {
        let (target, content) = (&self.target, &self.content);
        let failed = |error: io::Error| OutputError::new(&self.shown, &error);
        if !self.request.fresh {
            let manifest = Manifest::new(&self.request.command, &self.request.of, complete);
            manifest.seal(content).map_err(failed)?;
        }
        let parent = target.parent().unwrap_or(target);
        fs::create_dir_all(parent).map_err(failed)?;
        // A rename replaces only a free place or an empty folder.
        if let Err(error) = fs::rename(content, target) {
            if fs::symlink_metadata(target).is_err() {
                return Err(failed(error).into());
            }
            exchange(content, target).map_err(failed)?;
            // Inside the draft no other process can add to the earlier output, so it is inspected before it is deleted with the
            // draft.
            if let Err(refused) = inspect(content, &self.shown, &self.request) {
                if let Err(error) = exchange(content, target) {
                    let kept = self.draft.keep();
                    return Err(OutputError::new(&kept, &error).into());
                }
                return Err(refused);
            }
        }
        // The rename is done; if this fails, only a power loss could undo it.
        let _ = sync(parent);
        Ok(self.shown)
    }
}

fn refused(shown: &Path, reason: impl Into<String>) -> FolderError {
    FolderError::Refused {
        shown: shown.to_owned(),
        reason: reason.into(),
    }
}

/// Resolves `out` to an absolute path without links and `..`; its end may be missing.
fn resolved(out: &Path) -> Result<PathBuf, FolderError> {
    if out.as_os_str().is_empty() {
        return Err(FolderError::Empty);
    }
    let not_found = |error: io::Error| refused(out, format!("cannot be found: {error}"));
    let absolute = std::path::absolute(out).map_err(not_found)?;
    let existing = nearest_existing(&absolute);
    let rest = absolute.strip_prefix(&existing).unwrap_or(Path::new(""));
    let mut below = existing.clone();
    for part in rest.components() {
        if !matches!(part, Component::Normal(_)) {
            return Err(refused(out, "leads through a folder that does not exist"));
        }
        below.push(part);
        match fs::symlink_metadata(&below) {
            Ok(_) => return Err(refused(out, "is a link to nothing, or leads through one")),
            // Below a file the draft reports the fault.
            Err(error) if NOTHING.contains(&error.kind()) => {}
            // For example a name that is too long.
            Err(error) => return Err(not_found(error)),
        }
    }
    if rest.as_os_str().is_empty()
        && fs::symlink_metadata(&absolute).is_ok_and(|at| at.is_symlink())
    {
        return Err(refused(out, "is a link; name the folder itself"));
    }
    let root = existing.canonicalize().map_err(not_found)?;
    // Joining an empty path would add a slash.
    Ok(match rest.as_os_str().is_empty() {
        true => root,
        false => root.join(rest),
    })
}

/// Errors of a place without a file or folder.
const NOTHING: [io::ErrorKind; 2] = [io::ErrorKind::NotFound, io::ErrorKind::NotADirectory];

/// Refuses a target because of its location.
fn inspect_surroundings(target: &Path, shown: &Path, request: &Request) -> Result<(), FolderError> {
    let within = |path: &Path| {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        path.starts_with(target)
    };
    if std::env::current_dir().is_ok_and(|here| within(&here)) {
        let reason = "is a folder you are working in, and an output folder is replaced as a whole";
        return Err(refused(shown, reason));
    }
    let mut inputs = request.inputs.iter().filter(|_| target.is_dir());
    if let Some(input) = inputs.find(|path| within(path)) {
        let input = input.display();
        let suffix = "which is read, and an output folder is replaced as a whole";
        return Err(refused(shown, format!("holds {input}, {suffix}")));
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let device = |path: &Path| fs::metadata(path).map(|at| at.dev()).ok();
        let above = target.parent().unwrap_or(target);
        if target.exists() && device(target) != device(above) {
            let reason = "is a mount point, which cannot be replaced; name a folder in it";
            return Err(refused(shown, reason));
        }
    }
    Ok(())
}

/// Refuses a folder at `place` that this program must not replace.
fn inspect(place: &Path, shown: &Path, request: &Request) -> Result<(), FolderError> {
    let unread = |error: io::Error| refused(shown, format!("cannot be read: {error}"));
    match fs::symlink_metadata(place) {
        // Below a file the draft reports the fault with a better message.
        Err(error) if NOTHING.contains(&error.kind()) => return Ok(()),
        Err(error) => return Err(unread(error)),
        Ok(at) if !at.is_dir() => return Err(refused(shown, "is not a folder")),
        Ok(at) if at.permissions().readonly() => return Err(refused(shown, "may only be read")),
        #[cfg(unix)]
        Ok(at) => {
            use std::os::unix::fs::MetadataExt as _;
            let own = rustix::process::geteuid().as_raw();
            if own != 0 && own != at.uid() {
                return Err(refused(shown, "belongs to another user"));
            }
        }
        #[cfg(not(unix))]
        Ok(_) => {}
    }
    let kept = |reason: String| FolderError::Kept {
        shown: shown.to_owned(),
        reason,
    };
    if request.fresh && fs::read_dir(place).map_err(unread)?.next().is_some() {
        return Err(refused(shown, "is there already"));
    }
    match stranger(place).map_err(unread)? {
        Some(Stranger::Foreign(name)) => {
            let reason = format!("holds `{name}`, which is not known to be pinwheel's");
            Err(refused(shown, reason))
        }
        Some(Stranger::Changed(name)) if !request.force => Err(kept(format!(
            "holds `{name}`, which was changed after pinwheel wrote it"
        ))),
        _ => match Manifest::of(place).map(|manifest| manifest.of) {
            Some(of) if request.only_of && !request.force && !of.is_empty() && of != request.of => {
                Err(kept(format!("holds the results of {of}")))
            }
            _ => Ok(()),
        },
    }
}

/// Returns `path` with `ending` added to its name.
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// Exchanges two folders.
fn exchange(new: &Path, old: &Path) -> io::Result<()> {
    #[cfg(any(target_os = "linux", target_os = "macos"))]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        if renameat_with(CWD, new, CWD, old, RenameFlags::EXCHANGE).is_ok() {
            return Ok(());
        }
        // On file systems without an exchange, renames follow.
    }
    by_renames(new, old)
}

/// Exchanges two folders by three renames. A kill between the renames leaves the earlier output under a descriptive name.
#[doc(hidden)]
pub fn by_renames(new: &Path, old: &Path) -> io::Result<()> {
    let aside = beside(old, &format!(".earlier-{}", std::process::id()));
    fs::rename(old, &aside)?;
    if let Err(error) = fs::rename(new, old) {
        // Restores the earlier output.
        let _ = fs::rename(&aside, old);
        return Err(error);
    }
    fs::rename(&aside, new)
}

/// Lists the words that are files, and files named by TOML files among them: the base of a scene, the scene of a sweep.
pub fn named_files(words: impl IntoIterator<Item = PathBuf>) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut open: Vec<PathBuf> = words.into_iter().collect();
    while let Some(path) = open.pop() {
        if !path.is_file() || files.contains(&path) {
            continue;
        }
        let text = path
            .extension()
            .filter(|ending| ending.eq_ignore_ascii_case("toml"))
            .and_then(|_| crate::read_text(&path, "").ok());
        if let Some(Ok(table)) = text.map(|text| text.parse::<toml::Table>()) {
            let above = path.parent().unwrap_or(Path::new(""));
            // Top-level values; words that are no paths are no files.
            let words = table.values().filter_map(toml::Value::as_str);
            open.extend(words.flat_map(|word| [PathBuf::from(word), above.join(word)]));
        }
        files.push(path);
    }
    files
}

/// Returns a page, or the page in a folder.
pub fn page_at(place: &Path) -> Option<PathBuf> {
    let page = match place.is_dir() {
        true => place.join(PAGE),
        false => place.to_owned(),
    };
    page.is_file().then_some(page)
}

/// Returns the newest page in a folder of `outs`.
pub fn newest_page(outs: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(outs).into_iter().flatten().flatten();
    let pages = entries.map(|entry| entry.path().join(PAGE));
    let dated = pages.filter_map(|page| Some((page.metadata().ok()?.modified().ok()?, page)));
    dated.max().map(|(_, page)| page)
}
