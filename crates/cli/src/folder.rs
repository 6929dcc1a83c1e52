//! Output folders: written whole or not at all, and never over somebody else's files.
//!
//! Everything is written into a hidden folder beside the target, which then takes the target's
//! name in one step. An earlier output is replaced as a whole; anything else in its place stays.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use tempfile::TempDir;

use crate::failure::Failure;
use crate::interrupt;

/// Files this program writes, at the top or in an engine's folder.
const OURS: &[&str] = &[
    "results.csv",
    "results.parquet",
    "costs.csv",
    "sweep.toml",
    "run.json",
    "summary.json",
    "index.html",
    "courses.csv",
    "courses.partial.csv",
    "stability.csv",
    "bench.csv",
    "scaling.csv",
    "mechanisms.csv",
];

/// An output folder in the making. Dropped without [`publish`](Self::publish) it leaves nothing.
#[derive(Debug)]
pub(crate) struct Folder {
    target: PathBuf,
    shown: PathBuf,
    staging: TempDir,
    force: bool,
}

impl Folder {
    /// Checks that `out` may be written, before anything long is run.
    pub(crate) fn prepare(out: &Path, force: bool) -> Result<Self, Failure> {
        let target = resolve(out)?;
        inspect(&target, out, force)?;
        let beside = nearest_existing(target.parent().unwrap_or(&target));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".pinwheel-");
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
        Ok(Self {
            target,
            shown: out.to_owned(),
            staging,
            force,
        })
    }

    /// Where to write for now.
    pub(crate) fn path(&self) -> &Path {
        self.staging.path()
    }

    /// Gives the folder its name; returns it as the user wrote it.
    pub(crate) fn publish(self) -> Result<PathBuf, Failure> {
        interrupt::check()?;
        self.publish_unfinished()
    }

    /// The same although the user asked to stop: for studies whose results say how far they got.
    pub(crate) fn publish_unfinished(self) -> Result<PathBuf, Failure> {
        // Others may have written there while the engines ran.
        inspect(&self.target, &self.shown, self.force)?;
        let failed = |error: io::Error| Failure::unwritable(&self.shown, &error);
        if let Some(parent) = self.target.parent() {
            fs::create_dir_all(parent).map_err(failed)?;
        }
        if self.target.exists() {
            // Afterwards the staging folder holds the earlier output and goes with it.
            swap(self.staging.path(), &self.target).map_err(failed)?;
        } else {
            fs::rename(self.staging.path(), &self.target).map_err(failed)?;
        }
        interrupt::unfinished(None);
        Ok(self.shown)
    }
}

/// An absolute path without links and `..`, of which only the end may not exist yet.
fn resolve(out: &Path) -> Result<PathBuf, Failure> {
    let refuse = |what: &str| {
        Failure::input(format!(
            "--out {}: {what}; choose another --out",
            out.display()
        ))
    };
    if out.as_os_str().is_empty() {
        return Err(Failure::input("--out is empty; name a folder"));
    }
    let absolute =
        std::path::absolute(out).map_err(|error| refuse(&format!("cannot be found: {error}")))?;
    let existing = nearest_existing(&absolute);
    let rest = absolute.strip_prefix(&existing).unwrap_or(Path::new(""));
    if rest
        .components()
        .any(|part| !matches!(part, Component::Normal(_)))
    {
        return Err(refuse("leads through a folder that does not exist"));
    }
    let root = existing
        .canonicalize()
        .map_err(|error| refuse(&format!("cannot be found: {error}")))?;
    // Joining nothing would add a slash.
    Ok(if rest.as_os_str().is_empty() {
        root
    } else {
        root.join(rest)
    })
}

/// The path itself or the nearest folder above it that exists.
fn nearest_existing(path: &Path) -> PathBuf {
    path.ancestors()
        .find(|part| part.exists())
        .unwrap_or(path)
        .to_owned()
}

/// Refuses a target that is not ours to replace.
fn inspect(target: &Path, shown: &Path, force: bool) -> Result<(), Failure> {
    let shown = shown.display();
    if !target.exists() {
        return Ok(());
    }
    if !target.is_dir() {
        return Err(Failure::input(format!(
            "--out {shown}: is not a folder; choose another --out"
        )));
    }
    let within = |path: Option<PathBuf>| path.is_some_and(|path| path.starts_with(target));
    let home = std::env::var_os("HOME")
        .map(PathBuf::from)
        .filter(|home| home.is_absolute());
    if within(
        std::env::current_dir()
            .and_then(|path| path.canonicalize())
            .ok(),
    ) || within(home)
    {
        return Err(Failure::input(format!(
            "--out {shown}: is a folder you are working in, and an output folder is replaced as a whole; choose another --out"
        )));
    }
    if force {
        return Ok(());
    }
    match foreign(target) {
        Ok(None) => Ok(()),
        Ok(Some(name)) => Err(Failure::input(format!(
            "--out {shown}: holds `{name}`, which pinwheel did not write; choose another --out, or --force to replace the whole folder"
        ))),
        Err(error) => Err(Failure::input(format!(
            "--out {shown}: cannot be read: {error}; choose another --out"
        ))),
    }
}

/// Whether this program writes files of that name.
fn ours(name: &str) -> bool {
    // The runs of a sweep: `run-0007.json`, `run-0007.csv`.
    let number = name.strip_prefix("run-").and_then(|rest| {
        let (number, extension) = rest.split_once('.')?;
        ["json", "csv", "parquet"]
            .contains(&extension)
            .then_some(number)
    });
    OURS.contains(&name)
        || number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

/// The first thing in a folder that is not an earlier output; `None` for an output or an empty folder.
fn foreign(target: &Path) -> io::Result<Option<String>> {
    let mut written_by_us = false;
    let mut empty = true;
    for entry in fs::read_dir(target)? {
        let entry = entry?;
        empty = false;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.file_type()?.is_dir() {
            for inner in fs::read_dir(entry.path())? {
                let inner = inner?;
                let inner_name = inner.file_name().to_string_lossy().into_owned();
                if !inner.file_type()?.is_file() || !ours(&inner_name) {
                    return Ok(Some(format!("{name}/{inner_name}")));
                }
            }
            continue;
        }
        if !entry.file_type()?.is_file() || !ours(&name) {
            return Ok(Some(name));
        }
        written_by_us |= matches!(name.as_str(), "run.json" | "summary.json");
    }
    // Folders only, or a stray index.html: nothing says that we wrote it.
    Ok(if empty || written_by_us {
        None
    } else {
        Some("files without run.json".to_owned())
    })
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
    let aside = old.with_file_name(format!(
        ".pinwheel-old-{}-{}",
        std::process::id(),
        old.file_name().unwrap_or_default().to_string_lossy()
    ));
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
        assert_eq!(names(&out), ["run.json"]);
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
        fs::create_dir_all(out.join("native-reduced")).unwrap();
        fs::write(out.join("native-reduced/courses.csv"), "old").unwrap();
        fs::write(out.join("summary.json"), "old").unwrap();
        let folder = Folder::prepare(&out, false).unwrap();
        write(&folder, "run.json", "new");
        folder.publish().unwrap();
        assert_eq!(names(&out), ["run.json"]);
        assert_eq!(names(base.path()), ["x"]);
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
            (&["run.json", "notes.txt"], "`notes.txt`"),
            (&["run.json", "sub/thesis.tex"], "`sub/thesis.tex`"),
            (&["index.html"], "without run.json"),
            (&["sub/courses.csv"], "without run.json"),
            (&["summary.json", "runs/run-a.json"], "`runs/run-a.json`"),
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
