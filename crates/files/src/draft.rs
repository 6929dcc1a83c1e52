//! Drafts: new folders and files of this process beside the place that they are renamed into.
//!
//! A draft has a random name and is made exclusively, so it is never anybody else's; it goes when it is dropped. A kill leaves it:
//! its name holds the process, so that [`leftovers`] can name it. Nothing ever deletes it but its own process.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile, TempDir};

/// Beginning of every draft's name; the process and random letters follow.
const PREFIX: &str = ".pinwheel-";

fn prefix() -> String {
    format!("{PREFIX}{}-", std::process::id())
}

/// Makes a folder in `beside` that only its owner may enter.
pub(crate) fn folder(beside: &Path) -> io::Result<TempDir> {
    made(beside, &prefix(), 0o700)
}

/// Makes a file for `path` in the nearest folder above it that exists.
pub(crate) fn file(path: &Path) -> io::Result<NamedTempFile> {
    let (prefix, mut builder) = (prefix(), Builder::new());
    builder.prefix(&prefix);
    // The user's umask decides.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let path = std::path::absolute(path)?;
    builder.tempfile_in(nearest_existing(path.parent().unwrap_or(&path)))
}

/// Makes an empty folder in `folder` whose name begins with `prefix`, with the mode of a plain mkdir; it goes when it is dropped.
///
/// # Errors
/// The folder cannot be written.
pub fn draft_in(folder: &Path, prefix: &str) -> io::Result<TempDir> {
    made(folder, prefix, 0o777)
}

/// Makes a folder with a mode, of which the user's umask takes away.
fn made(beside: &Path, prefix: &str, mode: u32) -> io::Result<TempDir> {
    let mut builder = Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder.tempdir_in(beside)
}

/// Lists the drafts in `folder` whose process is gone from this machine.
#[must_use]
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

/// Returns true if the process runs, and where that cannot be asked.
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

/// Returns the path itself or the nearest folder above it that exists.
pub(crate) fn nearest_existing(path: &Path) -> PathBuf {
    path.ancestors()
        .find(|part| part.exists())
        .unwrap_or(path)
        .to_owned()
}

/// Opens a plain file: follows no link and waits for no pipe.
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

/// Waits until the names in a folder are on the disk.
pub(crate) fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
