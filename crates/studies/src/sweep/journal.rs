//! Finished runs on disk, one file each, so that an interrupted sweep resumes.
//!
//! A record is identified by all its inputs (scene, engine, versions, window), so a sweep may change between two attempts: runs
//! that it still contains are reused, others are computed.
//!
//! ```text
//!  out.unfinished/              one process writes, by its lock
//!    .lock  run-*.json          records; run-*.csv or .parquet: time_series
//! ```
//!
//! Records are written directly to their place, without waiting for the disk, which would cost as much as a short run. After a
//! kill or a power cut an incomplete record is invalid JSON, and its run is repeated. Time series are written beside their
//! place, synced and then renamed, because a record states that they exist. A record also contains their size and hash, and
//! its own: damaged or changed files are ignored.

use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::{fs, io};

use pinwheel_files::{Lock, fnv};
use pinwheel_timeseries::TimeSeries;
use serde_json::Value;
use tempfile::Builder;

use crate::StudyError;
use crate::folder::beside;
use crate::output::OutputError;
use crate::pool;
use crate::sweep::file::KeepTimeSeries;
use crate::sweep::record::RunRecord;
use crate::sweep::row::Row;
use crate::sweep::written::Written;

/// Prefix of files of runs.
const PREFIX: &str = "run-";
/// Prefix of unfinished files.
const UNFINISHED: &str = ".unfinished-";

/// Treatment of the runs of an earlier attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begin {
    /// Requires that there are none.
    Fresh,
    /// Uses these runs and the runs of earlier results.
    Resume,
    /// Deletes them.
    Over,
}

impl Begin {
    /// Returns the treatment by the two options of a sweep.
    pub fn of(resume: bool, force: bool) -> Self {
        match (resume, force) {
            (true, _) => Self::Resume,
            (_, true) => Self::Over,
            _ => Self::Fresh,
        }
    }
}

/// Folder of finished runs.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    /// Lock that excludes other writing processes.
    owner: Lock,
    /// Files of known records, its own and those of an earlier output, by the hash of their identity.
    known: Mutex<HashMap<u64, PathBuf>>,
}

impl Journal {
    /// Opens `folder`, created if missing, and reads its runs; those of `earlier` are read-only.
    ///
    /// Files that are no records, or of failed runs, are ignored.
    ///
    /// # Errors
    /// The folder cannot be created or read, is not a journal, or another process writes it.
    pub fn open(folder: &Path, earlier: Option<&Path>, command: &str) -> Result<Self, StudyError> {
        fs::create_dir_all(folder).map_err(at(folder))?;
        let owner = Lock::take(folder, command)?;
        for path in entries(folder)? {
            if name_of(&path).starts_with(UNFINISHED) {
                fs::remove_file(&path).map_err(at(&path))?;
            }
        }
        let earlier = earlier.filter(|place| place.is_dir());
        let mut known = earlier.map_or_else(|| Ok(HashMap::new()), records)?;
        known.extend(records(folder)?);
        Ok(Self {
            known: Mutex::new(known),
            folder: folder.to_owned(),
            owner,
        })
    }

    /// Opens the journal of a sweep with results in the folder `out`: `out.unfinished` beside it.
    ///
    /// # Errors
    /// Errors of [`open`](Self::open); runs without a choice of their treatment.
    pub fn begin(out: &Path, begin: Begin, command: &str) -> Result<Self, StudyError> {
        let place = Self::beside(out);
        let there = place.exists();
        let earlier = out.join("runs");
        let resumed = begin == Begin::Resume;
        let mut journal = Self::open(&place, resumed.then_some(earlier.as_path()), command)?;
        match begin {
            Begin::Fresh if there => return Err(StudyError::Begun { place }),
            Begin::Over if there => journal.clear()?,
            _ => (),
        }
        Ok(journal)
    }

    /// Returns the journal's folder for results in `out`.
    pub fn beside(out: &Path) -> PathBuf {
        beside(out, ".unfinished")
    }

    /// Returns the folder of time series.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the number of runs in its own folder, without those of an earlier output.
    pub fn in_its_folder(&self) -> usize {
        let known = pool::lock(&self.known);
        let own = known.values().filter(|path| path.starts_with(&self.folder));
        own.count()
    }

    /// Deletes the runs in its own folder.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn clear(&mut self) -> Result<(), StudyError> {
        pool::lock(&self.known).clear();
        for path in entries(&self.folder)? {
            let name = name_of(&path);
            if name.starts_with(PREFIX) || name.starts_with(UNFINISHED) {
                fs::remove_file(&path).map_err(at(&path))?;
            }
        }
        Ok(())
    }

    /// Deletes its own folder with the runs in it; a folder with other files stays.
    ///
    /// # Errors
    /// A run cannot be deleted.
    pub fn remove(mut self) -> Result<(), StudyError> {
        self.clear()?;
        self.owner.remove();
        Ok(())
    }

    /// Returns the file of a record by the hash of its identity.
    fn place(&self, identity: u64) -> PathBuf {
        let known = pool::lock(&self.known).get(&identity).cloned();
        known.unwrap_or_else(|| place(&self.folder, identity, "json"))
    }

    /// Returns the record of an identity, if its time series are stored in the requested form and unchanged.
    pub(crate) fn find(&self, identity: &str, time_series: KeepTimeSeries) -> Option<RunRecord> {
        let path = self.place(hash_of(identity));
        let record = record(&fs::read(&path).ok()?).filter(|r| r.identity() == identity)?;
        let file = extension(time_series).map(|extension| path.with_extension(extension));
        let written = &record.time_series;
        let intact = |file: PathBuf| written.is_some() && Written::of(&file).ok() == *written;
        let there = !record.ending.is_finished() || file.is_none_or(intact);
        (there && !record.ending.may_pass()).then_some(record)
    }

    /// Stores the record of a run whose time series, if requested, are already stored; that of a failed run for [`copy`](Self::copy)
    /// alone.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn keep(&self, record: &RunRecord) -> Result<(), StudyError> {
        let identity = hash_of(&record.identity());
        let path = place(&self.folder, identity, "json");
        // A new file, because the old one may be linked into an output.
        let _ = fs::remove_file(&path);
        fs::write(&path, json(record)).map_err(at(&path))?;
        if !record.ending.may_pass() {
            pool::lock(&self.known).insert(identity, path);
        }
        Ok(())
    }

    /// Adds a run's files to `folder` as `run-0007.*`; both places must not change them afterwards.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub fn copy(
        &self,
        row: Row<'_>,
        time_series: KeepTimeSeries,
        number: usize,
        folder: &Path,
    ) -> Result<(), StudyError> {
        let target = folder.join(format!("{PREFIX}{number:04}.json"));
        let Some(identity) = row.identity() else {
            return fs::write(&target, json(&row.record())).map_err(at(&target));
        };
        let path = self.place(identity);
        linked(&path, &target)?;
        if let Some(extension) = extension(time_series) {
            let from = path.with_extension(extension);
            if from.is_file() {
                linked(&from, &target.with_extension(extension))?;
            }
        }
        Ok(())
    }
}

/// Returns the files of a folder's valid records, without those of failed runs, by the hash of their identity.
fn records(folder: &Path) -> Result<HashMap<u64, PathBuf>, StudyError> {
    let mut known = HashMap::new();
    for path in entries(folder)? {
        let name = name_of(&path);
        if name.starts_with(PREFIX) && name.ends_with(".json") {
            let bytes = fs::read(&path).map_err(at(&path))?;
            let record = record(&bytes).filter(|r| !r.ending.may_pass());
            if let Some(record) = record {
                known.insert(hash_of(&record.identity()), path);
            }
        }
    }
    Ok(known)
}

/// Links a file under another name, cheaper than a copy; copies it if the file system has no links.
fn linked(from: &Path, to: &Path) -> Result<(), StudyError> {
    let copied = fs::hard_link(from, to).or_else(|_| fs::copy(from, to).map(|_| ()));
    copied.map_err(at(to))
}

fn at(path: &Path) -> impl Fn(io::Error) -> StudyError {
    |error| StudyError::Io(path.to_owned(), error)
}

/// Lists the entries of a folder.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let entries = fs::read_dir(folder).map_err(at(folder))?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path()));
    paths.collect::<io::Result<_>>().map_err(at(folder))
}

fn name_of(path: &Path) -> std::borrow::Cow<'_, str> {
    path.file_name().unwrap_or_default().to_string_lossy()
}

/// Key of a record's own hash in its file: of the remaining content as compact JSON.
const HASH: &str = "record_fnv";

fn hash(record: &Value) -> Value {
    format!("{:016x}", fnv(record.to_string().bytes())).into()
}

/// Returns a record in its file's form, with its hash.
fn json(record: &RunRecord) -> String {
    let mut value = serde_json::to_value(record).unwrap_or_default();
    let hash = hash(&value);
    if let Some(keys) = value.as_object_mut() {
        keys.insert(HASH.to_owned(), hash);
    }
    serde_json::to_string_pretty(&value).unwrap_or_default()
}

/// Returns the record of a file; `None` if it is invalid or was changed.
fn record(bytes: &[u8]) -> Option<RunRecord> {
    let mut value: Value = serde_json::from_slice(bytes).ok()?;
    let written = value.as_object_mut()?.remove(HASH)?;
    (written == hash(&value)).then(|| serde_json::from_value(value).ok())?
}

fn hash_of(identity: &str) -> u64 {
    fnv(identity.bytes())
}

/// Returns the file of a run in a journal's folder, by the hash of its identity.
fn place(folder: &Path, hash: u64, extension: &str) -> PathBuf {
    folder.join(format!("{PREFIX}{hash:016x}.{extension}"))
}

/// Stores the time series of a run in a journal's folder, synced before they are renamed. The record follows last, so that its
/// time series exist.
pub(crate) fn keep_time_series(
    folder: &Path,
    identity: &str,
    time_series: &TimeSeries,
    how: KeepTimeSeries,
) -> Result<Option<Written>, StudyError> {
    let Some(extension) = extension(how) else {
        return Ok(None);
    };
    let file = place(folder, hash_of(identity), extension);
    let unwritten = |fault: &dyn Display| OutputError::new(&file, fault);
    let sink = Builder::new().prefix(UNFINISHED).tempfile_in(folder);
    let mut sink = sink.map_err(at(&file))?;
    match how {
        #[cfg(feature = "parquet")]
        KeepTimeSeries::Parquet => {
            let written = pinwheel_timeseries::save_time_series(time_series, sink.path());
            written.map_err(|fault| unwritten(&fault))?;
        }
        _ => {
            let written = time_series.write_csv(sink.as_file_mut());
            written.map_err(|fault| unwritten(&fault))?;
        }
    }
    sink.as_file().sync_all().map_err(at(&file))?;
    let written = Written::of(sink.path()).map_err(at(&file))?;
    sink.persist(&file).map_err(|fault| unwritten(&fault))?;
    Ok(Some(written))
}

fn extension(time_series: KeepTimeSeries) -> Option<&'static str> {
    match time_series {
        KeepTimeSeries::None => None,
        KeepTimeSeries::Csv => Some("csv"),
        KeepTimeSeries::Parquet => Some("parquet"),
    }
}
