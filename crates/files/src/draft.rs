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
    made(beside, &prefix(), 0o700)
}

/// Creates a file for `path` in the nearest existing folder above it.
pub(crate) fn file(path: &Path) -> io::Result<NamedTempFile> {
    let (prefix, mut builder) = (prefix(), Builder::new());
    builder.prefix(&prefix);
    // Subject to the user's umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let path = std::path::absolute(path)?;
    builder.tempfile_in(nearest_existing(path.parent().unwrap_or(&path)))
}

/// Creates an empty folder in `folder` whose name begins with `prefix`, with the mode of a plain mkdir; it is deleted when
/// dropped.
///
/// # Errors
/// The folder cannot be written.
pub fn draft_in(folder: &Path, prefix: &str) -> io::Result<TempDir> {
    made(folder, prefix, 0o777)
}

/// Creates a folder with a mode, reduced by the user's umask.
fn made(beside: &Path, prefix: &str, mode: u32) -> io::Result<TempDir> {
    let mut builder = Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder.tempdir_in(beside)
}

/// Lists the drafts in `folder` whose process no longer exists on this machine.
pub fn leftovers(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let left = entries.filter(|entry| {
        let name = entry.file_name();
        let process = name
            .to_str()
            .and_then(|name| name.strip_prefix(PREFIX)?.split_once('-'))
            .and_then(|(process, _)| process.parse().ok());
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
    path.ancestors()
        .find(|part| part.exists())
        .unwrap_or(path)
        .to_owned()
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
