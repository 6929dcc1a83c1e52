//! Output folders: written whole or not at all, and never over somebody else's files.
//!
//! Everything is written into a hidden folder beside the target, which then takes the target's
//! name in one step. An earlier output, known by its marker, is replaced as a whole; anything else in its place stays.
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
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::output::OutputError;
use crate::ownership::{MARKER, Mark, Owner, abandoned, foreign_file, sync};

mod page;
mod target;

pub use page::{PAGE, newest_page, page_at};
pub use target::named_files;
use target::{Target, nearest_existing};

/// Why a folder cannot take an output.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FolderError {
    /// No name.
    #[error("the name of the output folder is empty")]
    Empty,
    /// A place where no output may go.
    #[error("{}: {reason}", shown.display())]
    Refused {
        /// The folder as it was asked for.
        shown: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// It holds a file that we did not write; [`Request::force`] replaces the folder all the same.
    #[error("{}: holds `{name}`, which is not in its list of pinwheel's files ({MARKER})", shown.display())]
    ForeignFile {
        /// The folder as it was asked for.
        shown: PathBuf,
        /// The file, relative to it.
        name: String,
    },
    /// It cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// How a folder is asked for.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// What the marker names as its author: a command that one can type again.
    pub command: String,
    /// Replace a folder that holds files of other origin.
    pub force: bool,
    /// Files that are read: a folder that is or holds one of them is refused.
    pub inputs: Vec<PathBuf>,
    /// Files that are ours there without a marker; such a folder gets none.
    pub known: Option<Vec<String>>,
}

/// How folders in the making begin.
const STAGING: &str = ".pinwheel-";

/// An output folder in the making. Dropped without [`publish`](Self::publish) it leaves nothing.
#[derive(Debug)]
pub struct Folder {
    target: Target,
    drafts: Drafts,
}

impl Folder {
    /// Checks that `out` may be written, before anything long is run.
    ///
    /// # Errors
    /// A place where no output may go, or that cannot be written.
    pub fn prepare(out: &Path, mut request: Request) -> Result<Self, FolderError> {
        if let Some(known) = &mut request.known {
            known.sort();
        }
        let target = Target::new(out, request)?;
        target.inspect()?;
        let beside = nearest_existing(target.path.parent().unwrap_or(&target.path));
        let drafts = Drafts::in_folder(&beside, &target.request.command)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt as _;
            let owner = |path: &Path| fs::metadata(path).map(|data| data.uid());
            // Whoever made the staging folder is us.
            if let (Ok(ours), Ok(theirs)) = (owner(drafts.path()), owner(&target.path))
                && ours != theirs
                && ours != 0
            {
                return Err(target.refuse("belongs to another user"));
            }
        }
        Ok(Self { target, drafts })
    }

    /// Where to write for now.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.drafts.path()
    }

    /// Gives the folder its name; returns it as the user wrote it.
    ///
    /// # Errors
    /// The folder cannot be written, or holds by now what must stay.
    pub fn publish(self) -> Result<PathBuf, FolderError> {
        self.finish(true)
    }

    /// The same although the user asked to stop, for studies whose results say how far they got.
    ///
    /// An earlier output that is complete stays: the part goes beside it, `out/bench.partial` for `out/bench`, or where
    /// that is taken `out/bench.partial-2` and so on.
    ///
    /// # Errors
    /// As [`publish`](Self::publish).
    pub fn publish_partial(mut self) -> Result<PathBuf, FolderError> {
        let target = &self.target.path;
        let replaceable = Mark::of(target).is_some_and(|mark| !mark.complete);
        let empty = fs::read_dir(target).map_or(true, |mut entries| entries.next().is_none());
        if !replaceable && !empty {
            // Beside what others have put in its place: a part is not lost either.
            let endings = std::iter::once(".partial".to_owned())
                .chain((2..100).map(|number| format!(".partial-{number}")));
            let free = |ending: &String| {
                let place = beside(target, ending);
                fs::symlink_metadata(&place).is_err()
                    || Mark::of(&place).is_some_and(|mark| !mark.complete)
                        && foreign_file(&place).is_ok_and(|name| name.is_none())
            };
            let ending = endings.into_iter().find(free).unwrap_or_default();
            self.target.path = beside(target, &ending);
            self.target.shown = beside(&self.target.shown, &ending);
        }
        self.finish(false)
    }

    fn finish(mut self, complete: bool) -> Result<PathBuf, FolderError> {
        let Target { path, shown, .. } = &self.target;
        // Others may have written there while the engines ran.
        self.target.inspect()?;
        let failed = |error: io::Error| OutputError::new(shown, &error);
        self.drafts
            .owner
            .seal(self.drafts.staging.path(), complete)?;
        if self.target.request.known.is_some() {
            fs::remove_file(self.drafts.path().join(MARKER)).map_err(failed)?;
        }
        let parent = path.parent().unwrap_or(path);
        fs::create_dir_all(parent).map_err(failed)?;
        let Drafts { owner, staging } = self.drafts;
        // Windows renames no folder with an open file in it.
        let held = cfg!(unix).then_some(owner);
        if path.exists() {
            // Afterwards the staging folder holds the earlier output and goes with it.
            swap(staging.path(), path).map_err(failed)?;
        } else {
            fs::rename(staging.path(), path).map_err(failed)?;
        }
        drop(held);
        // The name is there; should this fail, only a loss of power could take it away.
        let _ = sync(parent);
        Ok(self.target.shown)
    }
}

/// A hidden folder for files that are made whole before they get their place nearby. Goes with its owner; where that was killed,
/// the next one in the same place removes it.
#[derive(Debug)]
pub struct Drafts {
    owner: Owner,
    staging: Staging,
}

impl Drafts {
    /// Makes one in `folder`, which exists; `command` is its author.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn in_folder(folder: &Path, command: &str) -> Result<Self, OutputError> {
        remove_abandoned(folder);
        let mut attempts = 3;
        loop {
            let staging = draft_in(folder, STAGING);
            let staging = Staging(staging.map_err(|error| OutputError::new(folder, &error))?);
            let owner = Owner::take(staging.path(), command);
            attempts -= 1;
            // Before it had its marker another program may have taken it for what a kill left.
            let ours = owner.is_ok() && staging.path().join(MARKER).exists();
            if ours || attempts == 0 {
                return Ok(Self {
                    owner: owner?,
                    staging,
                });
            }
        }
    }

    /// Where to write.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.staging.path()
    }
}

/// An empty folder in `folder` whose name begins with `prefix`, as a plain mkdir would make it; goes when it is dropped.
///
/// # Errors
/// The folder cannot be written.
pub fn draft_in(folder: &Path, prefix: &str) -> io::Result<TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // The user's umask decides.
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    builder.tempdir_in(folder)
}

/// Writes a file by itself: what was there is replaced as a whole or not at all, and a kill leaves nothing for good. Folders
/// above it are made. A link stays and what it names is replaced; a pipe or a device is written to.
///
/// # Errors
/// The file cannot be written.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let failed = |error: io::Error| OutputError::new(path, &error);
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let there = fs::metadata(&place);
    if there.is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return fs::write(&place, bytes).map_err(failed);
    }
    let above = place.parent().filter(|above| !above.as_os_str().is_empty());
    let above = std::path::absolute(above.unwrap_or(Path::new("."))).map_err(failed)?;
    let drafts = Drafts::in_folder(&nearest_existing(&above), "file")?;
    let draft = drafts.path().join("draft");
    let mut file = fs::File::create(&draft).map_err(failed)?;
    file.write_all(bytes)
        .and_then(|()| file.sync_all())
        .map_err(failed)?;
    drop(file);
    // Only now: what fails before leaves no folder.
    fs::create_dir_all(above).map_err(failed)?;
    fs::rename(&draft, &place).map_err(failed)
}

/// Folders of programs that were killed, in the folder `beside`.
fn remove_abandoned(beside: &Path) {
    for entry in fs::read_dir(beside).into_iter().flatten().flatten() {
        let path = entry.path();
        if !entry.file_name().to_string_lossy().starts_with(STAGING) {
            continue;
        }
        if abandoned(&path) {
            remove(&path);
        } else {
            remove_unmarked(&path);
        }
    }
}

/// Removes what a kill leaves between a folder and its marker: nothing in it, or an unwritten marker that nobody holds.
fn remove_unmarked(folder: &Path) {
    let names = fs::read_dir(folder).map(|entries| entries.flatten().map(|e| e.file_name()));
    let alone = names.is_ok_and(|mut names| names.all(|name| name == MARKER));
    let marker = folder.join(MARKER);
    if alone
        && Mark::of(folder).is_none()
        && let Ok(file) = fs::File::options().write(true).open(&marker)
        && file.try_lock().is_ok()
    {
        // Locked while it goes: an owner that comes too late sees that.
        let _ = fs::remove_file(&marker);
    }
    // Takes none but an empty one.
    let _ = fs::remove_dir(folder);
}

/// Removes a folder in the making, as far as possible. Its marker goes last: what a kill leaves is still known as ours.
pub fn remove(folder: &Path) {
    clear(folder);
    let _ = fs::remove_dir_all(folder);
}

/// Removes everything in a folder but the marker.
fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name() != MARKER {
            let _ = match entry.file_type() {
                Ok(kind) if kind.is_dir() => fs::remove_dir_all(entry.path()),
                _ => fs::remove_file(entry.path()),
            };
        }
    }
}

/// The folder in the making, which goes when it is dropped.
#[derive(Debug)]
struct Staging(TempDir);

impl Staging {
    fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        clear(self.path());
    }
}

/// `path` with something added to its name.
#[must_use]
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// Exchanges two folders.
fn swap(new: &Path, old: &Path) -> io::Result<()> {
    #[cfg(target_os = "linux")]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        if renameat_with(CWD, new, CWD, old, RenameFlags::EXCHANGE).is_ok() {
            return Ok(());
        }
        // Some file systems cannot exchange; two renames can.
    }
    // Not a name of staging folders: a kill between the two renames must leave the earlier output.
    let aside = beside(old, &format!(".earlier-{}", std::process::id()));
    fs::rename(old, &aside)?;
    if let Err(error) = fs::rename(new, old) {
        // Better the earlier output than none.
        let _ = fs::rename(&aside, old);
        return Err(error);
    }
    fs::rename(&aside, new)
}

#[cfg(test)]
mod tests {
    use super::target::is_mount_point;
    use super::*;

    fn plain(out: &Path) -> Result<Folder, FolderError> {
        Folder::prepare(out, Request::default())
    }

    fn forced(out: &Path) -> Result<Folder, FolderError> {
        let request = Request::default();
        Folder::prepare(
            out,
            Request {
                force: true,
                ..request
            },
        )
    }

    #[test]
    fn what_a_kill_leaves_before_the_marker_goes_too() {
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        for name in ["empty", "unwritten", "held", "foreign"] {
            fs::create_dir(at(&format!("{STAGING}{name}"))).unwrap();
        }
        let marker = |name: &str| at(&format!("{STAGING}{name}")).join(MARKER);
        fs::write(marker("unwritten"), "").unwrap();
        let held = fs::File::create(marker("held")).unwrap();
        held.try_lock().unwrap();
        fs::write(marker("foreign").with_file_name("letter"), "precious").unwrap();
        let drafts = Drafts::in_folder(base.path(), "test").unwrap();
        assert!(drafts.path().join(MARKER).exists());
        drop(drafts);
        let kept = ["foreign", "held"].map(|name| format!("{STAGING}{name}"));
        assert_eq!(names(base.path()), kept);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_by_itself_is_replaced() {
        use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        replace(&at("deep/a"), b"one").unwrap();
        let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode();
        fs::write(at("plain"), "").unwrap();
        assert_eq!(mode("deep/a"), mode("plain"), "as any new file");
        symlink("deep/a", at("link")).unwrap();
        replace(&at("link"), b"two").unwrap();
        assert!(at("link").is_symlink());
        assert_eq!(fs::read(at("deep/a")).unwrap(), b"two");
        assert_eq!(names(&at("deep")), ["a"]);
        // A device stays what it is.
        symlink("/dev/null", at("null")).unwrap();
        replace(&at("null"), b"gone").unwrap();
        let null = fs::metadata(at("null")).unwrap();
        assert!(null.file_type().is_char_device());
        let error = replace(&at("deep"), b"x").unwrap_err().to_string();
        assert!(error.contains("deep") && !error.contains('\n'), "{error}");
    }

    fn write(folder: &Folder, name: &str, text: &str) {
        fs::write(folder.path().join(name), text).unwrap();
    }

    fn names(path: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(path)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_new_folder_appears_whole_and_nothing_beside_it() {
        let base = tempfile::tempdir().unwrap();
        let out = base.path().join("a/b");
        let folder = plain(&out).unwrap();
        write(&folder, "run.json", "{}");
        assert!(
            !base.path().join("a").exists(),
            "parents come with the result"
        );
        assert_eq!(folder.publish().unwrap(), out);
        assert_eq!(names(base.path()), ["a"]);
        assert_eq!(names(&out), [".pinwheel", "run.json"]);
        let mark = Mark::of(&out).unwrap();
        assert!(mark.complete && mark.files == ["run.json"]);
    }

    #[test]
    fn dropped_it_leaves_nothing() {
        let base = tempfile::tempdir().unwrap();
        let folder = plain(&base.path().join("x")).unwrap();
        write(&folder, "run.json", "{}");
        drop(folder);
        assert!(names(base.path()).is_empty());
    }

    #[test]
    fn an_earlier_output_is_replaced_as_a_whole() {
        let base = tempfile::tempdir().unwrap();
        let out = base.path().join("x");
        let folder = plain(&out).unwrap();
        fs::create_dir(folder.path().join("native-reduced")).unwrap();
        write(&folder, "native-reduced/courses.csv", "old");
        write(&folder, "summary.json", "old");
        folder.publish().unwrap();
        let folder = plain(&out).unwrap();
        write(&folder, "run.json", "new");
        folder.publish().unwrap();
        assert_eq!(names(&out), [".pinwheel", "run.json"]);
        assert_eq!(names(base.path()), ["x"]);
    }

    #[test]
    fn a_part_never_replaces_what_is_complete() {
        let base = tempfile::tempdir().unwrap();
        let (out, part) = (base.path().join("x"), base.path().join("x.partial"));
        let one = |text: &str, whole: bool| {
            let folder = plain(&out).unwrap();
            write(&folder, "summary.json", text);
            let place = if whole {
                folder.publish()
            } else {
                folder.publish_partial()
            };
            place.unwrap()
        };
        let at = |place: &Path| fs::read_to_string(place.join("summary.json")).unwrap();
        assert_eq!(one("a", false), out);
        assert_eq!(one("b", false), out, "a part replaces a part");
        assert_eq!(one("c", true), out);
        assert_eq!(one("d", false), part);
        assert_eq!((at(&out), at(&part)), ("c".to_owned(), "d".to_owned()));
        assert_eq!(names(base.path()), ["x", "x.partial"]);
        // What others put in its place stays, and costs nothing.
        fs::write(part.join("notes.txt"), "precious").unwrap();
        let next = base.path().join("x.partial-2");
        #[cfg(unix)]
        std::os::unix::fs::symlink("nowhere", &next).unwrap();
        #[cfg(unix)]
        let next = base.path().join("x.partial-3");
        assert_eq!(one("e", false), next);
        assert_eq!((at(&part), at(&next)), ("d".to_owned(), "e".to_owned()));
    }

    #[test]
    fn the_marker_goes_last() {
        let base = tempfile::tempdir().unwrap();
        let folder = plain(&base.path().join("x")).unwrap();
        write(&folder, "summary.json", "{}");
        fs::create_dir(folder.path().join("a")).unwrap();
        write(&folder, "a/courses.csv", "");
        clear(folder.path());
        assert_eq!(names(folder.path()), [MARKER]);
        assert!(Mark::of(folder.path()).is_some());
        remove(folder.path());
        assert!(names(base.path()).is_empty());
    }

    #[test]
    fn a_known_folder_gets_no_marker() {
        let base = tempfile::tempdir().unwrap();
        let out = base.path().join("x");
        let known = |out: &Path| {
            let known = Some(vec!["b.toml".to_owned(), "a.toml".to_owned()]);
            let request = Request::default();
            Folder::prepare(out, Request { known, ..request })
        };
        for _ in 0..2 {
            let folder = known(&out).unwrap();
            write(&folder, "b.toml", "");
            folder.publish().unwrap();
            assert_eq!(names(&out), ["b.toml"]);
        }
        fs::write(out.join("notes.txt"), "precious").unwrap();
        let failure = known(&out).unwrap_err();
        assert!(failure.to_string().contains("`notes.txt`"), "{failure}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn mount_points_are_seen() {
        assert!(is_mount_point(Path::new("/proc")));
        let base = tempfile::tempdir().unwrap();
        assert!(!is_mount_point(&base.path().canonicalize().unwrap()));
        let failure = forced(Path::new("/proc")).unwrap_err();
        assert!(failure.to_string().contains("mount point"), "{failure}");
    }

    #[test]
    fn the_fallback_swaps_too() {
        let base = tempfile::tempdir().unwrap();
        for (name, text) in [("new", "1"), ("old", "2")] {
            fs::create_dir(base.path().join(name)).unwrap();
            fs::write(base.path().join(name).join("f"), text).unwrap();
        }
        swap(&base.path().join("new"), &base.path().join("old")).unwrap();
        assert_eq!(fs::read_to_string(base.path().join("old/f")).unwrap(), "1");
        assert_eq!(fs::read_to_string(base.path().join("new/f")).unwrap(), "2");
        assert_eq!(names(base.path()), ["new", "old"]);
    }

    #[test]
    fn others_files_are_safe() {
        let base = tempfile::tempdir().unwrap();
        for (files, part) in [
            (&["notes.txt"][..], "`notes.txt`"),
            (&["run.json", "summary.json"], "`run.json`"),
            (&["index.html"], "`index.html`"),
            (&["sub/courses.csv"], "`sub/courses.csv`"),
            (&[".pinwheel", "run.json"], "`.pinwheel`"),
        ] {
            let out = base.path().join("x");
            for file in files {
                let file = out.join(file);
                fs::create_dir_all(file.parent().unwrap()).unwrap();
                fs::write(file, "precious").unwrap();
            }
            let failure = plain(&out).unwrap_err();
            assert!(failure.to_string().contains(part), "{failure}");
            assert!(
                matches!(failure, FolderError::ForeignFile { .. }),
                "{failure}"
            );
            assert_eq!(names(base.path()), ["x"]);
            forced(&out).unwrap();
            fs::remove_dir_all(out).unwrap();
        }
    }

    #[test]
    fn files_links_and_the_working_folder_are_refused() {
        let base = tempfile::tempdir().unwrap();
        let file = base.path().join("file");
        fs::write(&file, "").unwrap();
        for (out, part) in [
            (file.as_path(), "not a folder"),
            (&file.join("below"), "cannot be written"),
            (Path::new("."), "working in"),
            (Path::new("/"), "working in"),
            (&base.path().join("no/../x"), "does not exist"),
            (Path::new(""), "empty"),
        ] {
            let failure = forced(out).unwrap_err();
            assert!(
                failure.to_string().contains(part),
                "{}: {}",
                out.display(),
                failure
            );
        }
    }
}
