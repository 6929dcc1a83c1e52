//! Stored runs of other projects' engines, for later comparisons.
//!
//! ```text
//!  engine, version, sources of this program, checked scene with its settings ──> name of a file
//!  file: hash, description (TOML: a [`Recording`], and the ending of the run), columns of samples
//! ```
//! A stored run is a complete recording without rounding, so that a comparison with it gives the original results. Its name
//! does not depend on the machine: folders may be copied. Native runs are not stored, because they are fast, and neither are
//! runs of a user's solver.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::iter::once;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use pinwheel_files::file::replace;
use pinwheel_files::folder::leftovers;
use pinwheel_files::{Fnv, fnv};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pinwheel_timeseries::{TimeSeries, columns};
use serde::{Deserialize, Serialize};

use crate::engine::{Ending, Engine, Halt, Prepared, Run, SharedModel};
use crate::env::cache;
use crate::info::EngineInfo;
use crate::recorded::{Recording, bare};

/// Variable with the folder of stored runs; empty to store none.
pub const RUNS: &str = "PINWHEEL_RUNS";
/// First bytes of every file.
const MAGIC: &str = "pinwheel run 2 ";
/// Ending of every file's name.
const ENDING: &str = ".run";
/// Largest total size of all files, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// Returns the folder of stored runs, by default in the user's cache folder; `None` if none are stored.
pub fn folder() -> Option<PathBuf> {
    let named = |name: OsString| (!name.is_empty()).then(|| name.into());
    let own = || Some(cache()?.join("runs"));
    std::env::var_os(RUNS).map_or_else(own, named)
}

/// Store of runs in a folder, which several processes may use at once.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    /// Hash of the sources that affect results.
    program: String,
    /// Machine and day of new runs.
    machine: String,
    date: String,
    /// True if only runs since [`opened`](Self::opened) are used.
    fresh: bool,
    opened: SystemTime,
    messages: Mutex<Vec<String>>,
}

/// Description of a stored run.
#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    /// All inputs of the run except the scene.
    identity: String,
    /// CPU time limit of the run, s, if there was one.
    limit_s: Option<f64>,
    ending: Ending,
    run: Recording,
}

impl Store {
    /// Opens a folder, created if missing. `fresh`: only runs from now on are used.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn open(
        folder: &Path,
        fresh: bool,
        program: &str,
        (machine, date): (String, String),
    ) -> std::io::Result<Self> {
        fs::create_dir_all(folder)?;
        for draft in leftovers(folder) {
            let _ = fs::remove_file(draft);
        }
        // Time by the clock of the file system.
        let stamp = tempfile::NamedTempFile::new_in(folder)?;
        Ok(Self {
            opened: stamp.as_file().metadata()?.modified()?,
            folder: folder.to_owned(),
            program: program.to_owned(),
            machine,
            date,
            fresh,
            messages: Mutex::default(),
        })
    }

    /// Returns the engines, with stores for those whose runs are stored.
    pub fn around(self: &Arc<Self>, engines: Vec<Box<dyn Engine>>) -> Vec<Box<dyn Engine>> {
        let around = |engine: Box<dyn Engine>| -> Box<dyn Engine> {
            let info = engine.info();
            if info.brought || info.track == SharedModel::Native {
                return engine;
            }
            let parts = [
                &self.program,
                engine.name(),
                &engine.version(),
                &engine.build(),
            ];
            Box::new(Keeper {
                identity: parts.join("\n"),
                store: Arc::clone(self),
                engine,
            })
        };
        engines.into_iter().map(around).collect()
    }

    /// Returns a message for each unusable file.
    pub fn messages(&self) -> Vec<String> {
        let messages = self.messages.lock();
        messages.unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn report(&self, line: String) {
        let mut messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        if !messages.contains(&line) {
            messages.push(line);
        }
    }

    /// Returns the number of new runs since the store was opened.
    pub fn added(&self) -> usize {
        let files = self.files("").into_iter();
        files.filter(|(at, ..)| *at >= self.opened).count()
    }

    /// Returns the CPU time of the latest runs of an engine on a scene, s; `None` if there are none.
    pub fn cost_s(&self, engine: &str, scene: &Scene) -> Option<f64> {
        let stem = stem(engine, scene);
        let mut of_setting = BTreeMap::new();
        for (_, path, _) in self.files(&stem) {
            let name = path.file_name()?.to_string_lossy().into_owned();
            let setting = name[stem.len()..].split('-').next()?.to_owned();
            if let Some(kept) = fs::read(&path).ok().and_then(|bytes| unpacked(&bytes)) {
                of_setting.insert(setting, kept.run.stats.cpu_s);
            }
        }
        (!of_setting.is_empty()).then(|| of_setting.values().sum())
    }

    /// Returns time, path and size of files whose names begin with `stem`, the oldest first.
    fn files(&self, stem: &str) -> Vec<(SystemTime, PathBuf, u64)> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let files = entries.filter(|entry| {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            name.starts_with(stem) && name.ends_with(ENDING)
        });
        let files = files.filter_map(|entry| {
            let about = entry.metadata().ok()?;
            Some((about.modified().ok()?, entry.path(), about.len()))
        });
        let mut files: Vec<_> = files.collect();
        files.sort();
        files
    }

    /// Removes the oldest files until `room` bytes are free.
    fn trim(&self, room: u64) {
        let files = self.files("");
        let mut bytes: u64 = files.iter().map(|(.., bytes)| bytes).sum();
        for (_, path, of) in files {
            if bytes <= room {
                break;
            }
            // Another process may have removed it.
            let _ = fs::remove_file(path);
            bytes -= of;
        }
    }
}

/// Returns the prefix of files with runs of an engine on a scene, at any setting.
fn stem(engine: &str, scene: &Scene) -> String {
    let mut alike = bare(scene);
    (alike.solver.step_s, alike.solver.tolerance) = (0.0, 0.0);
    format!("{engine}-{:016x}-", fnv(alike.to_toml().into_bytes()))
}

/// Engine with a store of its runs.
struct Keeper {
    engine: Box<dyn Engine>,
    store: Arc<Store>,
    /// Hash of program, engine, version and build.
    identity: String,
}

impl Keeper {
    fn path(&self, scene: &Scene) -> PathBuf {
        let solver = &scene.solver;
        let mut hash = Fnv::default();
        hash.add_part(self.identity.as_bytes());
        hash.add_part(bare(scene).to_toml().as_bytes());
        let (stem, setting) = (stem(self.name(), scene), [solver.step_s, solver.tolerance]);
        let setting = fnv(setting.into_iter().flat_map(f64::to_le_bytes));
        let name = format!("{stem}{setting:016x}-{:016x}{ENDING}", hash.value());
        self.store.folder.join(name)
    }
}

impl Engine for Keeper {
    fn info(&self) -> EngineInfo<'_> {
        self.engine.info()
    }

    fn version(&self) -> String {
        self.engine.version()
    }

    fn build(&self) -> String {
        self.engine.build()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        self.engine.prepare(gearbox)
    }

    fn kept(&self, gearbox: &Gearbox, most: Option<Duration>) -> Option<Run> {
        let (store, path) = (&self.store, self.path(&gearbox.scene));
        let about = fs::metadata(&path).ok()?;
        let written = about.modified().ok()?;
        let is_older = store.fresh && written < store.opened;
        if is_older || !about.is_file() || about.len() > MOST_BYTES {
            return None;
        }
        let bytes = fs::read(&path).ok()?;
        let of_this = |kept: &Kept| {
            kept.identity == self.identity && bare(&kept.run.scene) == bare(&gearbox.scene)
        };
        let Some(kept) = unpacked(&bytes).filter(of_this) else {
            let name = self.name();
            store.report(format!(
                "a kept run of {name} was damaged or not ours; it is made anew"
            ));
            return None;
        };
        // More time might complete it.
        let limit_s = most.map_or(f64::MAX, |most| most.as_secs_f64());
        if matches!(kept.ending, Ending::TimedOut { .. })
            && kept.limit_s.is_none_or(|s| s < limit_s)
        {
            return None;
        }
        let Recording {
            date,
            machine,
            time_series,
            mut stats,
            ..
        } = kept.run;
        stats.kept = (written < store.opened).then(|| format!("{date} on {machine}"));
        Some(Run::new(time_series, stats).with_ending(kept.ending))
    }

    fn keep(&self, gearbox: &Gearbox, run: &Run, most: Option<Duration>) {
        let passes = matches!(run.ending, Ending::Absent { .. } | Ending::Failed { .. });
        if passes || run.stats.recorded.is_some() {
            return;
        }
        let store = &self.store;
        let (stats, series) = (run.stats.clone(), run.time_series.clone());
        let mut recording = Recording::new(self, &gearbox.scene, stats, series, Vec::new());
        recording.date.clone_from(&store.date);
        recording.machine.clone_from(&store.machine);
        let kept = Kept {
            identity: self.identity.clone(),
            limit_s: most.map(|most| most.as_secs_f64()),
            ending: run.ending.clone(),
            run: recording,
        };
        let path = self.path(&gearbox.scene);
        if let Some(bytes) = packed(&kept)
            && let Err(reason) = replace(&path, &bytes, &|_| true)
        {
            store.report(format!("runs are not kept: {reason}"));
        }
        store.trim(MOST_BYTES);
    }
}

/// Returns a stored run as the bytes of its file; `None` if it cannot be written.
fn packed(kept: &Kept) -> Option<Vec<u8>> {
    let series = &kept.run.time_series;
    let channels = series
        .channels()
        .iter()
        .map(|one| (&*one.name, &*one.values));
    let columns: Vec<(&str, &[f64])> = once((columns::TIME, series.time_s()))
        .chain(channels)
        .collect();
    let mut body = postcard::to_allocvec(&(toml::to_string(kept).ok()?, columns)).ok()?;
    let mut bytes = format!("{MAGIC}{:016x}\n", fnv(body.iter().copied())).into_bytes();
    bytes.append(&mut body);
    Some(bytes)
}

/// Reads the output of [`packed`]; `None` if a bit differs.
fn unpacked(bytes: &[u8]) -> Option<Kept> {
    let rest = bytes.strip_prefix(MAGIC.as_bytes())?;
    let (hash, body) = rest.split_at_checked(17)?;
    let expected = format!("{:016x}\n", fnv(body.iter().copied()));
    (hash == expected.as_bytes()).then(|| read(body))?
}

/// Reads description and samples.
fn read(body: &[u8]) -> Option<Kept> {
    let (about, columns): (&str, Vec<(String, Vec<f64>)>) = postcard::from_bytes(body).ok()?;
    let mut kept: Kept = pinwheel_files::parse(about).ok()?;
    kept.run.time_series = TimeSeries::of_columns(columns).ok()?;
    Some(kept)
}

/// Private items that tests reach; no part of the interface.
#[doc(hidden)]
pub mod internals {
    use super::*;

    /// Returns a file's body, without its hash.
    pub fn body(run: Recording) -> Vec<u8> {
        let kept = Kept {
            identity: "x".to_owned(),
            limit_s: Some(1.0),
            ending: Ending::Finished,
            run,
        };
        let bytes = packed(&kept).unwrap_or_default();
        bytes[bytes.len().min(MAGIC.len() + 17)..].to_vec()
    }

    /// True if a file's body can be read.
    pub fn reads(body: &[u8]) -> bool {
        read(body).is_some()
    }

    /// Removes the oldest files of a store until `room` bytes are free.
    pub fn trim(store: &Store, room: u64) {
        store.trim(room);
    }

    /// Returns the paths of the files.
    pub fn files(folder: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect()
    }
}
