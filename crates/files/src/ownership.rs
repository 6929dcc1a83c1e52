//! Whose folder is it: a marker file by which outputs of this program are known, locked while they are written.
//!
//! Names of files prove nothing: other tools write a `summary.json` too. A folder is ours if it holds [`MARKER`] with
//! our name and format, and of what is in it only the files that the marker lists are.

use std::fs::{self, File, TryLockError};
use std::io::{self, Seek as _, Write as _};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::output::OutputError;

/// Name of the marker.
pub const MARKER: &str = ".pinwheel";
const PROGRAM: &str = "pinwheel";
/// From this many files on it is cheaper to wait for the whole disk once: each file alone takes milliseconds.
const MANY: usize = 64;
/// Version of the marker's layout.
const FORMAT: u32 = 1;

/// The marker's content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mark {
    program: String,
    format: u32,
    /// The command that wrote the folder.
    pub command: String,
    /// Number of the process that wrote it.
    pub process: u32,
    /// False if the command was stopped: what there is is a part.
    pub complete: bool,
    /// All files below the folder but the marker, with `/` between parts, sorted; empty while it is written.
    pub files: Vec<String>,
}

impl Mark {
    /// The marker of a folder; `None` if there is none or it is not ours.
    #[must_use]
    pub fn of(folder: &Path) -> Option<Self> {
        let text = fs::read_to_string(folder.join(MARKER)).ok()?;
        let mark: Self = serde_json::from_str(&text).ok()?;
        (mark.program == PROGRAM && mark.format == FORMAT).then_some(mark)
    }
}

/// The first file in a folder that is not of an output of ours; `None` for such an output and for an empty folder.
///
/// # Errors
/// The folder cannot be read.
pub fn foreign_file(folder: &Path) -> io::Result<Option<String>> {
    let known = Mark::of(folder).map(|mark| mark.files).unwrap_or_default();
    Ok(unlisted(folder, &known)?.into_iter().next())
}

/// Files below `folder`, and empty folders, that `known` does not list; the marker of a folder of ours is left out.
///
/// # Errors
/// The folder cannot be read.
pub fn unlisted(folder: &Path, known: &[String]) -> io::Result<Vec<String>> {
    let ours = Mark::of(folder).is_some();
    let mut names = below(folder)?;
    names.retain(|name| known.binary_search(name).is_err() && !(ours && name == MARKER));
    Ok(names)
}

/// Everything below a folder that is no folder, and folders without anything in them (ending in `/`), sorted.
fn below(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    let mut open = vec![(folder.to_owned(), String::new())];
    while let Some((place, prefix)) = open.pop() {
        let mut empty = true;
        for entry in fs::read_dir(&place)? {
            let entry = entry?;
            empty = false;
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            if entry.file_type()?.is_dir() {
                open.push((entry.path(), format!("{name}/")));
            } else {
                names.push(name);
            }
        }
        if empty && !prefix.is_empty() {
            names.push(prefix);
        }
    }
    names.sort();
    Ok(names)
}

/// A folder that this process writes; the system frees it when the process ends, however it ends.
#[derive(Debug)]
pub struct Owner {
    file: File,
    mark: Mark,
}

impl Owner {
    /// Takes a folder: an empty one, or one with our marker.
    ///
    /// # Errors
    /// It holds files but no marker of ours; another process writes it, which is named; it cannot be written.
    pub fn take(folder: &Path, command: &str) -> Result<Self, OutputError> {
        let failed = |error: io::Error| OutputError::new(folder, &error);
        if Mark::of(folder).is_none()
            && let Some(name) = below(folder).map_err(failed)?.first()
        {
            let reason = if folder.join(MARKER).exists() {
                format!(
                    "its `{MARKER}`, by which pinwheel knows its own, is damaged or not pinwheel's; move the folder elsewhere"
                )
            } else {
                format!("it holds `{name}` and no `{MARKER}` by which pinwheel knows its own")
            };
            return Err(OutputError::new(folder, &reason));
        }
        let mut options = File::options();
        let options = options.create(true).truncate(false).read(true).write(true);
        let file = options.open(folder.join(MARKER)).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let who = Mark::of(folder).map_or_else(
                    || "another process".to_owned(),
                    |mark| format!("process {} (`{}`)", mark.process, mark.command),
                );
                return Err(OutputError::new(
                    folder,
                    &format!("{who} writes it at present"),
                ));
            }
            // Some file systems have no locks: better an output without one than none.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        let mark = Mark {
            program: PROGRAM.to_owned(),
            format: FORMAT,
            command: command.to_owned(),
            process: std::process::id(),
            complete: false,
            files: Vec::new(),
        };
        let mut owner = Self { file, mark };
        owner.write().map_err(failed)?;
        Ok(owner)
    }

    /// Lists what is in the folder and waits until all of it is on the disk.
    ///
    /// # Errors
    /// The folder cannot be read or written.
    pub fn seal(&mut self, folder: &Path, complete: bool) -> Result<(), OutputError> {
        let failed = |error: io::Error| OutputError::new(folder, &error);
        let mut files = below(folder).map_err(failed)?;
        files.retain(|name| name != MARKER);
        if files.len() < MANY || !sync_all(folder) {
            for name in &files {
                sync(&folder.join(name)).map_err(failed)?;
            }
        }
        self.mark.files = files;
        self.mark.complete = complete;
        self.write().map_err(failed)?;
        self.file.sync_all().map_err(failed)?;
        sync(folder).map_err(failed)
    }

    fn write(&mut self) -> io::Result<()> {
        let mut text = serde_json::to_string_pretty(&self.mark)?;
        text.push('\n');
        self.file.set_len(0)?;
        self.file.rewind()?;
        self.file.write_all(text.as_bytes())
    }
}

/// Waits until all of a file system is on the disk; false where the system cannot do that.
fn sync_all(folder: &Path) -> bool {
    #[cfg(target_os = "linux")]
    return File::open(folder).is_ok_and(|folder| rustix::fs::syncfs(folder).is_ok());
    #[cfg(not(target_os = "linux"))]
    {
        let _ = folder;
        false
    }
}

/// Waits until a file, or the names in a folder, are on the disk.
///
/// # Errors
/// The system's; a full disk is often only told here.
pub fn sync(path: &Path) -> io::Result<()> {
    if cfg!(unix) || path.is_file() {
        // Windows writes out only what is open for writing.
        let mut options = File::options();
        options.read(true).write(!cfg!(unix));
        options.open(path)?.sync_all()?;
    }
    Ok(())
}

/// Whether a folder was being written by a process of ours that is gone.
#[must_use]
pub fn abandoned(folder: &Path) -> bool {
    Mark::of(folder).is_some()
        && File::options()
            .write(true)
            .open(folder.join(MARKER))
            .is_ok_and(|file| file.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_owner_is_alone_and_known() {
        let dir = tempfile::tempdir().unwrap();
        let mut first = Owner::take(dir.path(), "pinwheel first").unwrap();
        assert!(!abandoned(dir.path()), "its owner lives");
        let refused = Owner::take(dir.path(), "pinwheel second").unwrap_err();
        for part in [&std::process::id().to_string(), "`pinwheel first`"] {
            assert!(refused.reason.contains(part), "{refused}");
        }
        fs::create_dir(dir.path().join("runs")).unwrap();
        fs::write(dir.path().join("runs/a"), "").unwrap();
        first.seal(dir.path(), true).unwrap();
        drop(first);
        assert!(abandoned(dir.path()));
        assert_eq!(foreign_file(dir.path()).unwrap(), None);
        fs::write(dir.path().join("runs/b"), "").unwrap();
        assert_eq!(foreign_file(dir.path()).unwrap().as_deref(), Some("runs/b"));
        assert!(Mark::of(dir.path()).is_some_and(|mark| mark.complete));
    }

    #[test]
    fn no_other_marker_is_ours() {
        let dir = tempfile::tempdir().unwrap();
        for text in ["", "{}", "{\"program\":\"other\",\"format\":1}"] {
            fs::write(dir.path().join(MARKER), text).unwrap();
            assert!(Mark::of(dir.path()).is_none() && !abandoned(dir.path()));
            assert_eq!(foreign_file(dir.path()).unwrap().as_deref(), Some(MARKER));
            let error = Owner::take(dir.path(), "").unwrap_err().to_string();
            assert!(error.contains("damaged or not pinwheel's"), "{error}");
        }
    }
}
