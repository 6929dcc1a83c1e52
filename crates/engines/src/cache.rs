//! What is made once and kept: folders below the user's cache folder, whole or not there.
//!
//! A folder is built beside its place and renamed when it is whole; a lock lets one process build while others wait. What
//! an interrupted build leaves is removed by the next.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pinwheel_files::folder::{draft_in, replace};

pub(crate) mod process;

pub(crate) use process::{Note, call};

/// Names another folder than the user's cache folder.
pub(crate) const CACHE: &str = "PINWHEEL_CACHE";

/// Why something cannot be kept.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CacheError {
    /// The file system refused.
    #[error("{path}: {reason}; make room there, or choose another folder with {CACHE}")]
    Storage {
        /// Where.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The user asked to stop.
    #[error("stopped")]
    Stopped,
}

impl CacheError {
    pub(crate) fn storage(path: &Path, reason: impl ToString) -> Self {
        Self::Storage {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}

/// The folder of all that is made once and kept.
pub(crate) fn folder() -> Result<PathBuf, CacheError> {
    let named = std::env::var_os(CACHE).filter(|value| !value.is_empty());
    let folder = match named {
        Some(folder) => PathBuf::from(folder),
        None => match dirs::cache_dir() {
            Some(folder) => folder.join("pinwheel"),
            None => {
                return Err(CacheError::storage(
                    Path::new("~"),
                    "there is no home folder",
                ));
            }
        },
    };
    fs::create_dir_all(&folder).map_err(|error| CacheError::storage(&folder, error))?;
    fs::canonicalize(&folder).map_err(|error| CacheError::storage(&folder, error))
}

/// A folder with these files (name, text), kept under a name that depends on them.
pub(crate) fn laid_out<N: AsRef<str>>(
    name: &str,
    files: &[(N, &str)],
) -> Result<PathBuf, CacheError> {
    let texts = files.iter().flat_map(|(name, text)| [name.as_ref(), *text]);
    let texts: Vec<&str> = texts.collect();
    let folder = folder()?.join(format!("{name}-{:016x}", fingerprint(&texts)));
    for (name, text) in files {
        let path = folder.join(name.as_ref());
        if fs::read_to_string(&path).is_ok_and(|there| there == *text) {
            continue;
        }
        // Whole or not at all, also for a process that reads at this moment.
        replace(&path, text.as_bytes())
            .map_err(|error| CacheError::storage(&path, error.reason))?;
    }
    Ok(folder)
}

/// Something to make.
pub(crate) struct Made<'a, T, E> {
    /// Its folder's name, which depends on all it is made of.
    pub(crate) name: &'a str,
    /// For whoever waits.
    pub(crate) title: &'static str,
    /// What is in a folder that is whole.
    pub(crate) whole: &'a dyn Fn(&Path) -> Option<T>,
    /// Fills an empty folder.
    pub(crate) build: &'a dyn Fn(&Path, &Note) -> Result<(), E>,
}

impl<T, E: From<CacheError>> Made<'_, T, E> {
    /// Finds it below `cache`, or makes it under a lock.
    ///
    /// # Errors
    /// The build's; [`CacheError`].
    pub(crate) fn once(&self, cache: &Path, cancel: &AtomicBool) -> Result<T, E> {
        let folder = cache.join(self.name);
        if let Some(found) = (self.whole)(&folder) {
            return Ok(found);
        }
        let _lock = lock(&cache.join(format!("{}.lock", self.name)), cancel)?;
        // Another process may have made it meanwhile.
        if let Some(found) = (self.whole)(&folder) {
            return Ok(found);
        }
        remove_leftovers(cache, self.name);
        let storage = |error| CacheError::storage(&folder, error);
        let draft = draft_in(cache, &drafts_of(self.name)).map_err(storage)?;
        let note = Note::new(self.title);
        let built = (self.build)(draft.path(), &note);
        drop(note);
        let stopped = || cancel.load(Ordering::Relaxed);
        if let Err(error) = built {
            return Err(if stopped() {
                CacheError::Stopped.into()
            } else {
                error
            });
        }
        if folder.exists() {
            fs::remove_dir_all(&folder).map_err(storage)?;
        }
        fs::rename(draft.keep(), &folder).map_err(storage)?;
        (self.whole)(&folder).ok_or_else(|| {
            if stopped() {
                CacheError::Stopped.into()
            } else {
                let reason = "what was just made does not start, or lacks what was asked for";
                CacheError::storage(&folder, reason).into()
            }
        })
    }
}

/// How folders begin in which something is built; a prefix of its own tells them from what is whole.
fn drafts_of(name: &str) -> String {
    format!(".{name}.")
}

/// Drafts of builds that were cut off: nobody else builds while we hold the lock.
fn remove_leftovers(cache: &Path, name: &str) {
    let prefix = drafts_of(name);
    for entry in fs::read_dir(cache).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// An exclusive lock, held as long as the file lives; the system frees it when a process dies.
pub(crate) fn lock(path: &Path, cancel: &AtomicBool) -> Result<File, CacheError> {
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path)
        .map_err(|error| CacheError::storage(path, error))?;
    let mut note = None;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) => {
                note.get_or_insert_with(|| Note::new("waiting"))
                    .say("another process makes what this one needs");
                if cancel.load(Ordering::Relaxed) {
                    return Err(CacheError::Stopped);
                }
                thread::sleep(Duration::from_millis(100));
            }
            Err(TryLockError::Error(error)) => return Err(CacheError::storage(path, error)),
        }
    }
}

/// FNV-1a, 64 bits: tells versions of a text apart in a name; stable across compilers, unlike std's.
pub(crate) fn fingerprint(parts: &[&str]) -> u64 {
    let mut hash = pinwheel_files::Fnv::default();
    parts.iter().for_each(|part| hash.add_part(part.as_bytes()));
    hash.value()
}
