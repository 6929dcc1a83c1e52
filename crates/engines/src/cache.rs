//! Cache of builds: folders in the user's cache folder, complete or absent.
//!
//! A folder is built beside its place and renamed when complete; a lock lets one process build while others wait. The next
//! build removes the remains of an interrupted one.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pinwheel_files::file::replace;
use pinwheel_files::folder::draft_in;

use crate::control::Cancelled;
use crate::engine::{Ending, Halt};
use crate::env::{CACHE, cache};

mod call;

pub use call::{Note, call, kept_away};

/// Returns the ending of a run whose resources cannot be stored.
pub fn storage(path: &Path, reason: impl ToString) -> Halt {
    let (path, reason) = (path.display(), reason.to_string());
    Ending::Absent {
        reason: format!("{path}: {reason}; make room there, or choose another folder with {CACHE}"),
    }
    .into()
}

/// Returns the failure, or the cancellation if the user requested a stop.
pub fn unless_stopped(cancel: &AtomicBool, failure: Halt) -> Halt {
    if cancel.load(Ordering::Relaxed) {
        Cancelled.into()
    } else {
        failure
    }
}

/// Caches a resource, or the reason why it is unavailable, for the life of the process, so that not every engine of a
/// comparison retries. A stop by the user is not cached.
pub struct Memo<T>(Mutex<Option<Result<T, Halt>>>);

impl<T: Clone> Memo<T> {
    pub const fn empty() -> Self {
        Self(Mutex::new(None))
    }

    pub fn get(&self, make: impl FnOnce() -> Result<T, Halt>) -> Result<T, Halt> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let result = kept.take().unwrap_or_else(make);
        if !matches!(result, Err(Halt::Cancelled(_))) {
            *kept = Some(result.clone());
        }
        result
    }
}

/// Returns the folder of all cached builds.
pub fn folder() -> Result<PathBuf, Halt> {
    let folder = cache().ok_or_else(|| storage(Path::new("~"), "there is no home folder"))?;
    fs::create_dir_all(&folder).map_err(|error| storage(&folder, error))?;
    fs::canonicalize(&folder).map_err(|error| storage(&folder, error))
}

/// Returns a cached folder with these files (name, text); its name depends on them.
pub fn laid_out<N: AsRef<str>>(name: &str, files: &[(N, &str)]) -> Result<PathBuf, Halt> {
    let texts = files.iter().flat_map(|(name, text)| [name.as_ref(), *text]);
    let texts: Vec<&str> = texts.collect();
    let folder = folder()?.join(format!("{name}-{:016x}", fingerprint(&texts)));
    for (name, text) in files {
        let path = folder.join(name.as_ref());
        if fs::read_to_string(&path).is_ok_and(|there| there == *text) {
            continue;
        }
        // Complete or absent, also for a process that reads at this moment.
        replace(&path, text.as_bytes(), &|_| true).map_err(|error| storage(&path, error.reason))?;
    }
    Ok(folder)
}

/// Build that is made once and cached.
pub struct CachedBuild<'a, T> {
    /// Name of the folder, which depends on all inputs of the build.
    pub name: &'a str,
    /// Title of the progress note.
    pub title: &'static str,
    /// Reads a folder; `None` unless the build in it is complete.
    pub read: &'a dyn Fn(&Path) -> Option<T>,
    /// Fills an empty folder.
    pub build: &'a dyn Fn(&Path, &Note) -> Result<(), Halt>,
}

impl<T> CachedBuild<'_, T> {
    /// Returns the build from the folder `cache`, or makes it under a lock.
    ///
    /// # Errors
    /// Errors of the build; a folder that cannot be written; a stop.
    pub fn once(&self, cache: &Path, cancel: &AtomicBool) -> Result<T, Halt> {
        let folder = cache.join(self.name);
        if let Some(content) = (self.read)(&folder) {
            return Ok(content);
        }
        let _lock = lock(&cache.join(format!("{}.lock", self.name)), cancel)?;
        // Another process may have built it meanwhile.
        if let Some(content) = (self.read)(&folder) {
            return Ok(content);
        }
        remove_leftovers(cache, self.name);
        let refused = |error: io::Error| storage(&folder, error);
        let draft = draft_in(cache, &drafts_of(self.name)).map_err(refused)?;
        let note = Note::new(self.title);
        let built = (self.build)(draft.path(), &note);
        drop(note);
        // After a stop any failure counts as the stop.
        built.map_err(|failure| unless_stopped(cancel, failure))?;
        if folder.exists() {
            fs::remove_dir_all(&folder).map_err(refused)?;
        }
        fs::rename(draft.keep(), &folder).map_err(refused)?;
        (self.read)(&folder).ok_or_else(|| {
            let reason = "the new build does not start, or lacks a required part";
            unless_stopped(cancel, storage(&folder, reason))
        })
    }
}

/// Returns the prefix of folders under construction, which complete folders do not have.
fn drafts_of(name: &str) -> String {
    format!(".{name}.")
}

/// Removes drafts of interrupted builds; the lock excludes other builds.
fn remove_leftovers(cache: &Path, name: &str) {
    let prefix = drafts_of(name);
    for entry in fs::read_dir(cache).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// Takes an exclusive lock for the life of the returned file; the system releases it when the process ends.
pub fn lock(path: &Path, cancel: &AtomicBool) -> Result<File, Halt> {
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path)
        .map_err(|error| storage(path, error))?;
    let mut note = None;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) => {
                note.get_or_insert_with(|| Note::new("waiting"))
                    .say("another process builds the required parts");
                if cancel.load(Ordering::Relaxed) {
                    return Err(Cancelled.into());
                }
                thread::sleep(Duration::from_millis(100));
            }
            Err(TryLockError::Error(error)) => return Err(storage(path, error)),
        }
    }
}

/// Returns the FNV-1a hash, 64 bits, of texts for use in a name; independent of the compiler, unlike std's.
pub fn fingerprint(parts: &[&str]) -> u64 {
    let mut hash = pinwheel_files::Fnv::default();
    parts.iter().for_each(|part| hash.add_part(part.as_bytes()));
    hash.value()
}
