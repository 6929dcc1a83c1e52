//! Where an output goes, and whether it may go there.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::{FolderError, Request};
use crate::ownership::{foreign_file, unlisted};

/// Where an output goes.
#[derive(Debug)]
pub(super) struct Target {
    /// Absolute, without links.
    pub(super) path: PathBuf,
    /// As the user wrote it.
    pub(super) shown: PathBuf,
    /// With its known files sorted.
    pub(super) request: Request,
}

impl Target {
    /// `out` resolved: an absolute path without links and `..`, of which only the end may not exist yet.
    pub(super) fn new(out: &Path, request: Request) -> Result<Self, FolderError> {
        let mut target = Self {
            path: PathBuf::new(),
            shown: out.to_owned(),
            request,
        };
        if out.as_os_str().is_empty() {
            return Err(FolderError::Empty);
        }
        let not_found = |error: io::Error| target.refuse(&format!("cannot be found: {error}"));
        let absolute = std::path::absolute(out).map_err(not_found)?;
        let existing = nearest_existing(&absolute);
        let rest = absolute.strip_prefix(&existing).unwrap_or(Path::new(""));
        let mut below = existing.clone();
        for part in rest.components() {
            if !matches!(part, Component::Normal(_)) {
                return Err(target.refuse("leads through a folder that does not exist"));
            }
            below.push(part);
            match fs::symlink_metadata(&below) {
                Ok(_) => return Err(target.refuse("is a link to nothing, or leads through one")),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                // Below a file it is told with what that file prevents.
                Err(error) if error.kind() == io::ErrorKind::NotADirectory => {}
                // A name too long, for example.
                Err(error) => return Err(not_found(error)),
            }
        }
        let root = existing.canonicalize().map_err(not_found)?;
        // Joining nothing would add a slash.
        target.path = if rest.as_os_str().is_empty() {
            root
        } else {
            root.join(rest)
        };
        Ok(target)
    }

    pub(super) fn refuse(&self, reason: &str) -> FolderError {
        FolderError::Refused {
            shown: self.shown.clone(),
            reason: reason.to_owned(),
        }
    }

    /// Refuses a target that is not ours to replace.
    pub(super) fn inspect(&self) -> Result<(), FolderError> {
        let target = &self.path;
        if !target.exists() {
            return Ok(());
        }
        if !target.is_dir() {
            return Err(self.refuse("is not a folder"));
        }
        let within = |path: &Path| {
            let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
            path.starts_with(target)
        };
        let home = std::env::home_dir().filter(|home| home.is_absolute());
        let here = std::env::current_dir().ok();
        if here.into_iter().chain(home).any(|path| within(&path)) {
            return Err(self.refuse(
                "is a folder you are working in, and an output folder is replaced as a whole",
            ));
        }
        if is_mount_point(target) {
            return Err(
                self.refuse("is a mount point, which cannot be replaced; name a folder in it")
            );
        }
        if let Some(input) = self.request.inputs.iter().find(|path| within(path)) {
            let input = input.display();
            return Err(self.refuse(&format!(
                "holds {input}, which is read, and an output folder is replaced as a whole"
            )));
        }
        if self.request.force {
            return Ok(());
        }
        let known = &self.request.known;
        let found = match known {
            Some(known) => unlisted(target, known).map(|names| names.into_iter().next()),
            None => foreign_file(target),
        };
        match found.map_err(|error| self.refuse(&format!("cannot be read: {error}")))? {
            None => Ok(()),
            Some(name) if known.is_some() => Err(self.refuse(&format!(
                "holds `{name}`, which pinwheel did not write; move it elsewhere"
            ))),
            Some(name) => Err(FolderError::ForeignFile {
                shown: self.shown.clone(),
                name,
            }),
        }
    }
}

/// Those of some words that are files, and those that TOML files among them name in turn: the base of a scene, the
/// scene of a sweep.
#[must_use]
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
pub(super) fn is_mount_point(path: &Path) -> bool {
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
pub(super) fn nearest_existing(path: &Path) -> PathBuf {
    path.ancestors()
        .find(|part| part.exists())
        .unwrap_or(path)
        .to_owned()
}
