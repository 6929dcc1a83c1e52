//! Output folders: written whole or not at all, and never over somebody else's files.
//!
//! Everything is written into a hidden folder beside the target, which then takes the target's
//! name in one step. An earlier output, known by its marker, is replaced as a whole; anything else in its place stays.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use pinwheel::studies::ownership::{MARKER, Mark, Owner, abandoned, stranger, sync, unlisted};
use tempfile::TempDir;

use crate::failure::Failure;
use crate::{args, interrupt};

/// How folders in the making begin.
const STAGING: &str = ".pinwheel-";

/// An output folder in the making. Dropped without [`publish`](Self::publish) it leaves nothing.
#[derive(Debug)]
pub(crate) struct Folder {
    place: Place,
    owner: Owner,
    staging: TempDir,
}

/// Where an output goes.
#[derive(Debug)]
struct Place {
    /// Absolute, without links.
    target: PathBuf,
    /// As the user wrote it.
    shown: PathBuf,
    force: bool,
    /// Files that are ours there without a marker, sorted; such a folder gets none.
    known: Option<Vec<String>>,
}

impl Folder {
    /// Checks that `out` may be written, before anything long is run.
    pub(crate) fn prepare(out: &Path, force: bool) -> Result<Self, Failure> {
        Self::at(Place::new(out, force, None)?)
    }

    /// The same for a folder that a file of its own tells from others: `known` names what may be replaced.
    pub(crate) fn prepare_known(out: &Path, mut known: Vec<String>) -> Result<Self, Failure> {
        known.sort();
        Self::at(Place::new(out, false, Some(known))?)
    }

    fn at(place: Place) -> Result<Self, Failure> {
        place.inspect()?;
        let beside = nearest_existing(place.target.parent().unwrap_or(&place.target));
        remove_abandoned(&beside);
        let mut builder = tempfile::Builder::new();
        builder.prefix(STAGING);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // As a plain mkdir would: the user's umask decides.
            builder.permissions(fs::Permissions::from_mode(0o777));
        }
        let staging = builder
            .tempdir_in(&beside)
            .map_err(|error| Failure::unwritable(&beside, &error))?;
        interrupt::unfinished(Some(staging.path()));
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt as _;
            let owner = |path: &Path| fs::metadata(path).map(|data| data.uid());
            // Whoever made the staging folder is us.
            if let (Ok(ours), Ok(theirs)) = (owner(staging.path()), owner(&place.target))
                && ours != theirs
                && ours != 0
            {
                return Err(place.refuse("belongs to another user"));
            }
        }
        let owner = Owner::take(staging.path(), &args::typed())?;
        Ok(Self {
            place,
            owner,
            staging,
        })
    }

    /// Where to write for now.
    pub(crate) fn path(&self) -> &Path {
        self.staging.path()
    }

    /// Gives the folder its name; returns it as the user wrote it.
    pub(crate) fn publish(self) -> Result<PathBuf, Failure> {
        interrupt::check()?;
        self.finish(true)
    }

    /// The same although the user asked to stop, for studies whose results say how far they got.
    ///
    /// An earlier output that is complete stays: the part goes beside it, `out/bench.partial` for `out/bench`, or where
    /// that is taken `out/bench.partial-2` and so on.
    pub(crate) fn publish_partial(mut self) -> Result<PathBuf, Failure> {
        let target = &self.place.target;
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
                        && stranger(&place).is_ok_and(|name| name.is_none())
            };
            let ending = endings.into_iter().find(free).unwrap_or_default();
            self.place.target = beside(target, &ending);
            self.place.shown = beside(&self.place.shown, &ending);
        }
        self.finish(false)
    }

    fn finish(mut self, complete: bool) -> Result<PathBuf, Failure> {
        let Place { target, shown, .. } = &self.place;
        // Others may have written there while the engines ran.
        self.place.inspect()?;
        let failed = |error: io::Error| Failure::unwritable(shown, &error);
        self.owner.seal(self.staging.path(), complete)?;
        if self.place.known.is_some() {
            fs::remove_file(self.staging.path().join(MARKER)).map_err(failed)?;
        }
        let parent = target.parent().unwrap_or(target);
        fs::create_dir_all(parent).map_err(failed)?;
        // Windows renames no folder with an open file in it.
        let held = cfg!(unix).then_some(self.owner);
        if target.exists() {
            // Afterwards the staging folder holds the earlier output and goes with it.
            swap(self.staging.path(), target).map_err(failed)?;
        } else {
            fs::rename(self.staging.path(), target).map_err(failed)?;
        }
        drop(held);
        // The name is there; should this fail, only a loss of power could take it away.
        let _ = sync(parent);
        interrupt::unfinished(None);
        Ok(self.place.shown)
    }
}

/// Refuses an output folder that is, or holds, one of these inputs.
pub(crate) fn protect(out: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    Place::new(out, true, None)?.protects(inputs.iter().copied())
}

/// Folders of programs that were killed, in the folder `beside`.
fn remove_abandoned(beside: &Path) {
    for entry in fs::read_dir(beside).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(STAGING) && abandoned(&entry.path()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// `path` with something added to its name.
pub(crate) fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

impl Place {
    /// `out` resolved: an absolute path without links and `..`, of which only the end may not exist yet.
    fn new(out: &Path, force: bool, known: Option<Vec<String>>) -> Result<Self, Failure> {
        let mut place = Self {
            target: PathBuf::new(),
            shown: out.to_owned(),
            force,
            known,
        };
        if out.as_os_str().is_empty() {
            return Err(Failure::input("--out is empty; name a folder"));
        }
        let not_found = |error: io::Error| place.refuse(&format!("cannot be found: {error}"));
        let absolute = std::path::absolute(out).map_err(not_found)?;
        let existing = nearest_existing(&absolute);
        let rest = absolute.strip_prefix(&existing).unwrap_or(Path::new(""));
        let mut below = existing.clone();
        for part in rest.components() {
            if !matches!(part, Component::Normal(_)) {
                return Err(place.refuse("leads through a folder that does not exist"));
            }
            below.push(part);
            match fs::symlink_metadata(&below) {
                Ok(_) => return Err(place.refuse("is a link to nothing, or leads through one")),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                // Below a file it is told with what that file prevents.
                Err(error) if error.kind() == io::ErrorKind::NotADirectory => {}
                // A name too long, for example.
                Err(error) => return Err(not_found(error)),
            }
        }
        let root = existing.canonicalize().map_err(not_found)?;
        // Joining nothing would add a slash.
        place.target = if rest.as_os_str().is_empty() {
            root
        } else {
            root.join(rest)
        };
        Ok(place)
    }

    fn refuse(&self, what: &str) -> Failure {
        let shown = self.shown.display();
        Failure::input(format!("--out {shown}: {what}; choose another --out"))
    }

    /// Refuses a target that is not ours to replace.
    fn inspect(&self) -> Result<(), Failure> {
        let target = &self.target;
        if !target.exists() {
            return Ok(());
        }
        if !target.is_dir() {
            return Err(self.refuse("is not a folder"));
        }
        let home = std::env::var_os("HOME")
            .map(PathBuf::from)
            .filter(|home| home.is_absolute());
        let here = std::env::current_dir().ok();
        let within = |path: PathBuf| path.canonicalize().unwrap_or(path).starts_with(target);
        if here.into_iter().chain(home).any(within) {
            return Err(self.refuse(
                "is a folder you are working in, and an output folder is replaced as a whole",
            ));
        }
        if is_mount_point(target) {
            return Err(
                self.refuse("is a mount point, which cannot be replaced; name a folder in it")
            );
        }
        self.protects(named_files().iter().map(PathBuf::as_path))?;
        if self.force {
            return Ok(());
        }
        let found = match &self.known {
            Some(known) => unlisted(target, known).map(|names| names.into_iter().next()),
            None => stranger(target),
        };
        match found {
            Ok(None) => Ok(()),
            Ok(Some(name)) if self.known.is_some() => Err(self.refuse(&format!(
                "holds `{name}`, which pinwheel did not write; move it elsewhere"
            ))),
            Ok(Some(name)) => Err(Failure::input(format!(
                "--out {}: holds `{name}`, which is not in its list of pinwheel's files ({MARKER}); choose another --out, or --force to replace the whole folder",
                self.shown.display()
            ))),
            Err(error) => Err(self.refuse(&format!("cannot be read: {error}"))),
        }
    }

    /// Refuses a target that holds an input.
    fn protects<'a>(&self, mut inputs: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
        let within = |path: &&Path| {
            path.canonicalize()
                .is_ok_and(|path| path.starts_with(&self.target))
        };
        match inputs.find(within) {
            Some(input) => Err(self.refuse(&format!(
                "holds {}, which is read, and an output folder is replaced as a whole",
                input.display()
            ))),
            None => Ok(()),
        }
    }
}

/// Files that the command line names, whatever they are for, and those that TOML files among them name in turn: the
/// base of a scene, the scene of a sweep.
fn named_files() -> Vec<PathBuf> {
    let mut files = Vec::new();
    let words = std::env::args_os().skip(1);
    let mut open: Vec<PathBuf> = words
        .flat_map(|word| {
            // `--against=FILE`
            let value = word
                .to_str()
                .and_then(|word| word.split_once('='))
                .map(|(_, value)| PathBuf::from(value));
            value.into_iter().chain([PathBuf::from(word)])
        })
        .collect();
    while let Some(path) = open.pop() {
        if !path.is_file() || files.contains(&path) {
            continue;
        }
        let text = path
            .extension()
            .filter(|ending| ending.eq_ignore_ascii_case("toml"))
            .and_then(|_| fs::read_to_string(&path).ok());
        if let Some(Ok(table)) = text.map(|text| text.parse::<toml::Table>()) {
            let above = path.parent().unwrap_or(Path::new(""));
            // At the top, where they stand; a word that is no path is no file either.
            let words = table.values().filter_map(toml::Value::as_str);
            open.extend(words.flat_map(|word| [PathBuf::from(word), above.join(word)]));
        }
        files.push(path);
    }
    files
}

/// Whether another file system, or another part of one, begins at an absolute path.
fn is_mount_point(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let device = |path: &Path| fs::metadata(path).map(|data| data.dev()).ok();
        if path
            .parent()
            .is_some_and(|parent| device(parent) != device(path))
        {
            return true;
        }
    }
    // A folder mounted from the same device is only told here; blanks and such are written in octal.
    let shown = path.display().to_string();
    let shown = shown.replace('\\', "\\134").replace(' ', "\\040");
    fs::read_to_string("/proc/self/mountinfo").is_ok_and(|list| {
        list.lines()
            .any(|line| line.split(' ').nth(4) == Some(&shown))
    })
}

/// The path itself or the nearest folder above it that exists.
fn nearest_existing(path: &Path) -> PathBuf {
    path.ancestors()
        .find(|part| part.exists())
        .unwrap_or(path)
        .to_owned()
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
    use super::*;

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
        let folder = Folder::prepare(&out, false).unwrap();
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
        let folder = Folder::prepare(&base.path().join("x"), false).unwrap();
        write(&folder, "run.json", "{}");
        drop(folder);
        assert!(names(base.path()).is_empty());
    }

    #[test]
    fn an_earlier_output_is_replaced_as_a_whole() {
        let base = tempfile::tempdir().unwrap();
        let out = base.path().join("x");
        let folder = Folder::prepare(&out, false).unwrap();
        fs::create_dir(folder.path().join("native-reduced")).unwrap();
        write(&folder, "native-reduced/courses.csv", "old");
        write(&folder, "summary.json", "old");
        folder.publish().unwrap();
        let folder = Folder::prepare(&out, false).unwrap();
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
            let folder = Folder::prepare(&out, false).unwrap();
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
    fn a_known_folder_gets_no_marker() {
        let base = tempfile::tempdir().unwrap();
        let out = base.path().join("x");
        let known = || vec!["b.toml".to_owned(), "a.toml".to_owned()];
        for _ in 0..2 {
            let folder = Folder::prepare_known(&out, known()).unwrap();
            write(&folder, "b.toml", "");
            folder.publish().unwrap();
            assert_eq!(names(&out), ["b.toml"]);
        }
        fs::write(out.join("notes.txt"), "precious").unwrap();
        let failure = Folder::prepare_known(&out, known()).unwrap_err();
        assert!(failure.message.contains("`notes.txt`"), "{failure:?}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn mount_points_are_seen() {
        assert!(is_mount_point(Path::new("/proc")));
        let base = tempfile::tempdir().unwrap();
        assert!(!is_mount_point(&base.path().canonicalize().unwrap()));
        let failure = Folder::prepare(Path::new("/proc"), true).unwrap_err();
        assert!(failure.message.contains("mount point"), "{failure:?}");
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
            let failure = Folder::prepare(&out, false).unwrap_err();
            assert_eq!(failure.code, 2);
            assert!(failure.message.contains(part), "{}", failure.message);
            assert!(failure.message.contains("--force"), "{}", failure.message);
            assert_eq!(names(base.path()), ["x"]);
            Folder::prepare(&out, true).unwrap();
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
            let failure = Folder::prepare(out, true).unwrap_err();
            assert!(
                failure.message.contains(part),
                "{}: {}",
                out.display(),
                failure.message
            );
        }
    }
}
