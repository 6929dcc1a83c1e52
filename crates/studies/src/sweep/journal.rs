//! Finished runs on disk, one file each, so that a sweep that was killed goes on where it stopped.
//!
//! A record is written beside its place and then renamed: it is there whole or not at all. What a
//! record belongs to is its whole content (scene, engine, versions, window), so a sweep may be changed
//! between two attempts: runs it still asks for are found again, others are run.

use std::collections::HashMap;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use pinwheel_courses::{Courses, Ending};

use crate::ownership::{MARKER, Owner, unlisted};
use crate::sweep::SweepError;
use crate::sweep::file::KeepCourses;
use crate::sweep::record::RunRecord;

/// How files of runs begin.
const PREFIX: &str = "run-";
/// How unfinished files begin.
const UNFINISHED: &str = ".unfinished-";

/// A folder of finished runs.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    /// Keeps other processes from writing the same runs.
    _owner: Owner,
    /// Where each identity's record and courses stand.
    known: Mutex<HashMap<String, (RunRecord, PathBuf)>>,
}

impl Journal {
    /// Opens `folder`, made if it is not there, and reads its runs; those of `earlier` too, for reading only.
    ///
    /// Files that are no records, or of runs that failed, are passed over.
    ///
    /// # Errors
    /// The folder cannot be made or read, is not a journal, or another process writes it.
    pub fn open(folder: &Path, earlier: Option<&Path>, command: &str) -> Result<Self, SweepError> {
        let at = |path: &Path| {
            let path = path.to_owned();
            move |source| SweepError::Io { path, source }
        };
        fs::create_dir_all(folder).map_err(at(folder))?;
        let owner = Owner::take(folder, command)?;
        let mut known = HashMap::new();
        for place in earlier
            .into_iter()
            .filter(|place| place.is_dir())
            .chain([folder])
        {
            for entry in fs::read_dir(place).map_err(at(place))? {
                let path = entry.map_err(at(place))?.path();
                let name = path
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned();
                if name.starts_with(UNFINISHED) && place == folder {
                    fs::remove_file(&path).map_err(at(&path))?;
                } else if name.starts_with(PREFIX) && name.ends_with(".json") {
                    let text = fs::read_to_string(&path).map_err(at(&path))?;
                    let record: Option<RunRecord> = serde_json::from_str(&text).ok();
                    if let Some(record) =
                        record.filter(|r| !matches!(r.ending, Ending::Failed { .. }))
                    {
                        known.insert(record.identity(), (record, path));
                    }
                }
            }
        }
        Ok(Self {
            folder: folder.to_owned(),
            _owner: owner,
            known: Mutex::new(known),
        })
    }

    /// Runs it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lock().len()
    }

    /// True without any.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Runs in its own folder, those of an earlier output not counted.
    #[must_use]
    pub fn in_its_folder(&self) -> usize {
        let own = |(_, path): &&(RunRecord, PathBuf)| path.starts_with(&self.folder);
        self.lock().values().filter(own).count()
    }

    /// Forgets the runs in its own folder.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn clear(&self) -> Result<(), SweepError> {
        self.lock()
            .retain(|_, (_, path)| !path.starts_with(&self.folder));
        let io = |source| SweepError::Io {
            path: self.folder.clone(),
            source,
        };
        for entry in fs::read_dir(&self.folder).map_err(io)? {
            let entry = entry.map_err(io)?;
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(PREFIX) || name.starts_with(UNFINISHED) {
                fs::remove_file(entry.path()).map_err(io)?;
            }
        }
        Ok(())
    }

    /// Removes its own folder with the runs in it; what else is in it stays, and the folder with it.
    ///
    /// # Errors
    /// A run cannot be removed.
    pub fn remove(self) -> Result<(), SweepError> {
        self.clear()?;
        if unlisted(&self.folder, &[]).is_ok_and(|others| others.is_empty()) {
            let _ = fs::remove_file(self.folder.join(MARKER));
            let _ = fs::remove_dir(&self.folder);
        }
        Ok(())
    }

    /// The record of an identity, if its courses are kept as wanted.
    pub(crate) fn find(&self, identity: &str, courses: KeepCourses) -> Option<RunRecord> {
        let known = self.lock();
        let (record, path) = known.get(identity)?;
        let file = extension(courses).map(|extension| path.with_extension(extension));
        let there = !record.ending.is_finished() || file.is_none_or(|file| file.is_file());
        there.then(|| record.clone())
    }

    /// Keeps a run; of one that failed nothing.
    pub(crate) fn keep(
        &self,
        record: &RunRecord,
        courses: &Courses,
        how: KeepCourses,
    ) -> Result<(), SweepError> {
        if matches!(record.ending, Ending::Failed { .. }) {
            return Ok(());
        }
        let identity = record.identity();
        let path = self
            .folder
            .join(format!("{PREFIX}{:016x}.json", fnv(&identity)));
        if let Some(extension) = extension(how) {
            // The record comes last: where it is, its courses are.
            let file = path.with_extension(extension);
            self.whole(&file, |sink| {
                #[cfg(feature = "parquet")]
                if how == KeepCourses::Parquet {
                    let written = crate::sweep::save_courses(courses, sink.path());
                    return written.map_err(|fault| SweepError::Io {
                        path: file.clone(),
                        source: std::io::Error::other(fault),
                    });
                }
                let written = courses.write_csv(sink.as_file_mut());
                written.map_err(|source| SweepError::Courses {
                    path: file.clone(),
                    source,
                })
            })?;
        }
        let text = serde_json::to_string_pretty(record).unwrap_or_default();
        self.whole(&path, |sink| {
            sink.write_all(text.as_bytes())
                .map_err(|source| SweepError::Io {
                    path: path.clone(),
                    source,
                })
        })?;
        self.lock().insert(identity, (record.clone(), path));
        Ok(())
    }

    /// Copies a run's files into `folder` as `run-0007.*`.
    ///
    /// # Errors
    /// A file cannot be read or written. A record that is not kept (a run that failed) is written anew.
    pub fn copy(&self, record: &RunRecord, number: usize, folder: &Path) -> Result<(), SweepError> {
        let target = folder.join(format!("{PREFIX}{number:04}.json"));
        let at = |path: &Path| {
            let path = path.to_owned();
            move |source| SweepError::Io { path, source }
        };
        let place = self
            .lock()
            .get(&record.identity())
            .map(|(_, path)| path.clone());
        let Some(path) = place else {
            let text = serde_json::to_string_pretty(record).unwrap_or_default();
            return fs::write(&target, text).map_err(at(&target));
        };
        fs::copy(&path, &target).map_err(at(&target))?;
        for extension in ["csv", "parquet"] {
            let (from, to) = (
                path.with_extension(extension),
                target.with_extension(extension),
            );
            if from.is_file() {
                fs::copy(&from, &to).map_err(at(&to))?;
            }
        }
        Ok(())
    }

    /// Writes a file beside its place and renames it.
    fn whole(
        &self,
        path: &Path,
        write: impl FnOnce(&mut tempfile::NamedTempFile) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let io = |source| SweepError::Io {
            path: path.to_owned(),
            source,
        };
        let mut builder = tempfile::Builder::new();
        let mut sink = builder
            .prefix(UNFINISHED)
            .tempfile_in(&self.folder)
            .map_err(io)?;
        write(&mut sink)?;
        // On the disk before it has its name.
        sink.as_file().sync_all().map_err(io)?;
        sink.persist(path).map_err(|error| io(error.error))?;
        Ok(())
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, HashMap<String, (RunRecord, PathBuf)>> {
        // A thread that panicked while it held the map has not left it half changed.
        self.known
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

fn extension(courses: KeepCourses) -> Option<&'static str> {
    match courses {
        KeepCourses::None => None,
        KeepCourses::Csv => Some("csv"),
        KeepCourses::Parquet => Some("parquet"),
    }
}

/// FNV-1a, 64 bits [Fowler, Noll, Vo 1991]: names files; contents decide.
fn fnv(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
