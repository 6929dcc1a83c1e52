//! Drafts: new folders and files of this process beside their final place.
//!
//! A draft has a random name and is created exclusively, so it never belongs to another program; it is deleted when dropped.
//! After a kill it remains: its name contains the process number, so that [`leftovers`] can list it. Only its own process
//! deletes it.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile, TempDir};

/// Prefix of every draft's name, followed by the process number and random letters.
const PREFIX: &str = ".pinwheel-";

fn prefix() -> String {
    format!("{PREFIX}{}-", std::process::id())
}

/// Creates a folder in `beside` that only its owner may enter.
pub(crate) fn folder(beside: &Path) -> io::Result<TempDir> {
    builder(&prefix(), 0o700).tempdir_in(beside)
}

/// Creates a file for `path` in the nearest existing folder above it.
pub(crate) fn file(path: &Path) -> io::Result<NamedTempFile> {
    let path = std::path::absolute(path)?;
    let beside = nearest_existing(path.parent().unwrap_or(&path));
    builder(&prefix(), 0o666).tempfile_in(beside)
}

/// Creates an empty folder in `folder` whose name begins with `prefix`, with the mode of a plain mkdir; it is deleted when
/// dropped.
///
/// # Errors
/// The folder cannot be written.
pub fn draft_in(folder: &Path, prefix: &str) -> io::Result<TempDir> {
    builder(prefix, 0o777).tempdir_in(folder)
}

/// Returns a builder of files and folders with a mode, which the user's umask reduces.
fn builder(prefix: &str, mode: u32) -> Builder<'_, '_> {
    let mut builder = Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

/// Lists the drafts in `folder` whose process no longer exists on this machine.
pub fn leftovers(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let left = entries.filter(|entry| {
        let name = entry.file_name();
        let rest = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        let process = rest.and_then(|rest| rest.split_once('-')?.0.parse().ok());
        process.is_some_and(|process| !is_alive(process))
    });
    let mut left: Vec<PathBuf> = left.map(|entry| entry.path()).collect();
    left.sort();
    left
}

/// True if the process runs, or if that cannot be determined.
fn is_alive(process: i32) -> bool {
    #[cfg(unix)]
    {
        use rustix::process::{Pid, test_kill_process};
        Pid::from_raw(process)
            .is_none_or(|process| test_kill_process(process) != Err(rustix::io::Errno::SRCH))
    }
    #[cfg(not(unix))]
    {
        let _ = process;
        true
    }
}

/// Returns the path or the nearest existing folder above it.
pub(crate) fn nearest_existing(path: &Path) -> PathBuf {
    let existing = path.ancestors().find(|part| part.exists());
    existing.unwrap_or(path).to_owned()
}

/// Opens a regular file; refuses links and pipes.
pub(crate) fn open_plain(path: &Path, options: &mut fs::OpenOptions) -> io::Result<File> {
    let wrong = || io::Error::new(io::ErrorKind::InvalidInput, "is no plain file");
    if !fs::symlink_metadata(path)?.is_file() {
        return Err(wrong());
    }
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed());
    }
    let file = options.open(path)?;
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(wrong()),
    }
}

/// Waits until the names in a folder are on disk.
pub(crate) fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
