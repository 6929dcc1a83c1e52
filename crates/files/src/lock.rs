//! Lock of a folder that several runs of the program write in turn, such as the journal of a sweep.

use std::fs::{self, File, TryLockError};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use crate::draft::open_plain;
use crate::output::OutputError;

/// Name of the lock file, which marks a locked folder.
const LOCK: &str = ".lock";
/// Largest number of bytes of its text in a message.
const MOST_BYTES: u64 = 400;

/// Folder that only this process writes; the system releases the lock when the process ends in any way.
#[derive(Debug)]
pub struct Lock {
    folder: PathBuf,
    file: File,
}

impl Lock {
    /// Locks an existing folder: an empty one, or one that was locked before.
    ///
    /// # Errors
    /// The folder has files but no lock, is locked by another process, or cannot be written.
    pub fn take(folder: &Path, command: &str) -> Result<Self, OutputError> {
        let failed = |error: io::Error| OutputError::new(folder, &error);
        let refused = |reason: &str| Err(OutputError::new(folder, &reason));
        if !fs::symlink_metadata(folder).map_err(failed)?.is_dir() {
            return refused("it is a link or no folder");
        }
        let path = folder.join(LOCK);
        let mut options = File::options();
        options.read(true).write(true);
        let others = others(folder).map_err(failed)?;
        let (file, new) = match open_plain(&path, &mut options) {
            Ok(file) => (file, false),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                if let Some(name) = others.first() {
                    return refused(&format!(
                        "it holds `{name}` and no `{LOCK}` by which pinwheel knows its own"
                    ));
                }
                let created = options.create(true).truncate(false).open(&path);
                (created.map_err(failed)?, true)
            }
            Err(error) => return Err(failed(error)),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut who = String::new();
                let _ = (&file).take(MOST_BYTES).read_to_string(&mut who);
                return refused(&format!("{} writes it at present", who.trim_end()));
            }
            // Some file systems have no locks; a journal without one is better than none.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        let lock = Self {
            folder: folder.to_owned(),
            file,
        };
        let text = format!("process {} (`{command}`)\n", std::process::id());
        let cleared = lock.file.set_len(0);
        if let Err(error) = cleared.and_then(|()| (&lock.file).write_all(text.as_bytes())) {
            if new {
                lock.remove();
            }
            return Err(failed(error));
        }
        Ok(lock)
    }

    /// Removes the lock and its folder, unless it has other files.
    pub fn remove(self) {
        if others(&self.folder).is_ok_and(|others| others.is_empty()) {
            // Windows does not remove open files.
            drop(self.file);
            let _ = fs::remove_file(self.folder.join(LOCK));
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

/// Returns the names in a folder except the lock.
fn others(folder: &Path) -> io::Result<Vec<String>> {
    let names = fs::read_dir(folder)?;
    let names = names.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    let mut names = names.collect::<io::Result<Vec<String>>>()?;
    names.retain(|name| name != LOCK);
    names.sort();
    Ok(names)
}
