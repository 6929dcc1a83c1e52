//! External solvers as engines: a manifest describes the start, a job folder contains scene and results.
//!
//! ```text
//!  solver.toml ──read──> Solver (an Engine)
//!  scene ──> job folder: scene.json ──command──> courses.csv, result.json, exit status ──checked──> Run
//! ```
//! docs/solvers.md is the guide for authors. A manifest is a program that its user trusts, and is read only if the user names
//! it. Output of the program is not trusted.

mod library;
#[doc(hidden)] // for tests
pub mod log;
mod manifest;
mod result;
pub mod scaffold;

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{OnceLock, PoisonError, RwLock};
use std::time::{Duration, Instant};

use pinwheel_files::{FileError, Fnv};
use pinwheel_gearbox::Gearbox;
use pinwheel_law::job;

use crate::control::{Cancelled, Control};
use crate::engine::{Ending, Engine, Halt, Prepared, Run, RunStats, prepared, settled};
use crate::info::{AccuracySetting, EngineInfo};
pub use crate::process::end_all;
use crate::process::{self, End, Ended};
pub use library::{fmu_library, law_library};
use log::{Limits, SolverLog, WORDS, plain};
#[cfg(any(feature = "rapier", feature = "python"))]
pub(crate) use manifest::structure_at_contacts;
pub use manifest::{Honours, Manifest, Stated};
pub use pinwheel_law::job::{schema as job_schema, write as write_job};
use result::{JobFolder, Reply, Series};
use serde_json::Value;

/// Exit status of a diverged run.
const DIVERGED: i32 = 3;
/// Exit status of a solver that does not support a scene.
const UNSUPPORTED: i32 = 4;
/// Longest message, characters.
const MESSAGE: usize = 700;
/// Largest size of a run's output, bytes.
const FOLDER_BYTES: u64 = 1 << 30;
const LOG_BYTES: u64 = 64 << 20;

/// External solver.
#[derive(Debug, Clone)]
pub struct Solver {
    manifest: Manifest,
    /// Absolute path of the manifest's folder.
    here: PathBuf,
    /// Prefix of the names of job folders.
    prefix: &'static str,
    /// Value of `{python}`, if it is not the user's interpreter.
    python: Option<PathBuf>,
    /// Hash of the files of manifest and program, computed on first use.
    build: OnceLock<String>,
    #[doc(hidden)]
    pub limits: Limits,
}

impl Solver {
    /// Reads a manifest.
    ///
    /// # Errors
    /// Fault of the manifest.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let manifest = Manifest::read(path)?;
        let limits = Limits {
            longest: Duration::from_secs_f64(manifest.timeout_s),
            folder_bytes: FOLDER_BYTES,
            log_bytes: LOG_BYTES,
        };
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        Ok(Self {
            manifest,
            here: absolute.parent().unwrap_or(Path::new("/")).to_owned(),
            prefix: "pinwheel-job-",
            python: None,
            build: OnceLock::new(),
            limits,
        })
    }

    /// Returns the manifest of the solver.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Reduces the solver's time limit to `longest`.
    #[must_use]
    pub fn within(mut self, longest: Duration) -> Self {
        self.limits.longest = self.limits.longest.min(longest);
        self
    }

    /// Uses names with a space for job folders, for tests.
    #[must_use]
    pub fn with_spaces(mut self) -> Self {
        self.prefix = "pinwheel job ";
        self
    }

    /// Sets the engine's name, and an interpreter for `{python}` if the solver needs its own.
    #[cfg(feature = "crossval")]
    pub(crate) fn known_as(mut self, name: &str, python: Option<PathBuf>) -> Self {
        name.clone_into(&mut self.manifest.name);
        self.python = python;
        self
    }

    /// Returns the path of the law's library; fails only if the command needs it.
    fn library(&self) -> Result<Option<PathBuf>, Halt> {
        match law_library() {
            Ok(path) => Ok(Some(path)),
            Err(remedy) if self.manifest.wants("law") => Err(failed(remedy)),
            Err(_) => Ok(None),
        }
    }

    /// Returns the hash of the command and of every file named in it: program, script.
    fn hash(&self) -> u64 {
        let here = self.here.to_string_lossy();
        let mut hash = Fnv::default();
        for word in &self.manifest.command {
            hash.add_part(word.as_bytes());
            // In a word such as `--input={here}/gear.dat` the file begins after the sign.
            let word = word.replace("{here}", &here);
            let names = [
                Some(word.as_str()),
                word.split_once('=').map(|(_, name)| name),
            ];
            let mut paths = names.into_iter().flatten().map(Path::new);
            let file = paths.find(|path| path.is_absolute() && path.is_file());
            if let Some(content) = file.and_then(|path| std::fs::read(path).ok()) {
                hash.add_part(&content);
            }
        }
        hash.value()
    }

    /// Runs the solver in a job folder with content by `fill`.
    fn drive(
        &self,
        gearbox: &Gearbox,
        control: &Control<'_>,
        fill: impl FnOnce(&Path, Option<&Path>) -> Result<(), job::JobError>,
    ) -> Result<Run, Halt> {
        let io = |error: std::io::Error| failed(format!("its job folder: {error}"));
        let library = self.library()?;
        let folder = tempfile::Builder::new()
            .prefix(self.prefix)
            .tempdir()
            .map_err(io)?;
        fill(folder.path(), library.as_deref()).map_err(failed)?;
        let handle = JobFolder::open(folder.path()).map_err(io)?;
        let python = self.python.clone().unwrap_or_else(manifest::python);
        let nothing = Path::new("");
        let argv = self.manifest.argv(&[
            ("here", self.here.as_path()),
            ("job", folder.path()),
            ("law", library.as_deref().unwrap_or(nothing)),
            ("python", python.as_path()),
        ]);
        let Some((program, arguments)) = argv.split_first() else {
            return Err(failed("its command is empty"));
        };
        let mut command = Command::new(program);
        command
            .args(arguments)
            .current_dir(folder.path())
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .env("PYTHONUNBUFFERED", "1")
            .envs(library.as_deref().and_then(library_path));
        let (begun, mut log) = (Instant::now(), SolverLog::default());
        let mut looked = begun;
        let ended = process::run(&mut command, Some(folder.path()), &mut |piece| {
            if let Some(piece) = piece {
                log.take(piece);
                return None;
            }
            if control.reached(log.reached_s.unwrap_or(0.0)) {
                return Some(End::Cancelled);
            }
            self.limits.passed(&log, folder.path(), begun, &mut looked)
        });
        let ended = ended.map_err(|error| failed(self.does_not_start(program, &error)))?;
        let message = log.last();
        // The solver may have ended before its log was read.
        if let Some(time) = log.reached_s {
            let _ = control.reached(time);
        }
        self.judge(gearbox, &handle, &ended, &log, message)
    }

    /// Runs the solver on a job file that `text` derives from the scene's.
    ///
    /// # Errors
    /// A stop.
    pub fn run_job(
        &self,
        gearbox: &Gearbox,
        text: impl FnOnce(Value) -> String,
        control: &Control<'_>,
    ) -> Result<Run, Cancelled> {
        let ran = self.drive(gearbox, control, |folder, library| {
            let text = text(job::job(gearbox, library)?);
            Ok(std::fs::write(folder.join(pinwheel_law::JOB_FILE), text)?)
        });
        settled(ran)
    }

    fn does_not_start(&self, program: &OsStr, error: &std::io::Error) -> String {
        let remedy = match &self.manifest.build {
            Some(build) => format!("build it: {}", plain(build, WORDS)),
            None => "build it, or correct `command` in its manifest".to_owned(),
        };
        format!("{} does not start: {error}; {remedy}", program.display())
    }

    fn judge(
        &self,
        gearbox: &Gearbox,
        folder: &JobFolder,
        ended: &Ended,
        log: &SolverLog,
        message: Option<String>,
    ) -> Result<Run, Halt> {
        let message_in = |before: &str, after: &str| match &message {
            Some(line) => format!("{before}{line}{after}"),
            None => String::new(),
        };
        let (and_said, last_words) = (message_in(": ", ""), message_in(" (its last words: ", ")"));
        let status = match &ended.end {
            End::Cancelled => return Err(Cancelled.into()),
            End::Stopped(why) => return Err(failed(format!("{why}{last_words}"))),
            End::TooLong(why) => {
                return Err(Ending::TimedOut {
                    time_s: log.reached_s.unwrap_or(0.0),
                    reason: format!("{why}{last_words}"),
                }
                .into());
            }
            End::Status(status) => *status,
        };
        match status.code() {
            Some(0 | DIVERGED) => {}
            Some(UNSUPPORTED) => {
                let reason = message.unwrap_or_else(|| "it gives no reason".to_owned());
                return Err(Ending::Unsupported { reason }.into());
            }
            Some(code) => return Err(failed(format!("it ended with status {code}{and_said}"))),
            None => {
                return Err(failed(format!(
                    "it was ended by {}{and_said}",
                    killer(status)
                )));
            }
        }
        let diverged = status.code() == Some(DIVERGED);
        let reply = folder.reply().map_err(failed)?;
        let checked = match folder.time_series(gearbox, !diverged) {
            Ok(checked) => checked,
            // A run may diverge before its first row.
            Err(_) if diverged => Series::default(),
            Err(what) => return Err(failed(format!("{what}{last_words}"))),
        };
        let mut run = Run::new(
            checked.time_series,
            self.stats(gearbox, folder, ended, log, &reply),
        );
        run.stats.notes.extend(checked.notes);
        let stated = diverged.then(|| {
            let time = run.time_series.time_s().last().copied().unwrap_or(0.0);
            let time = log.reached_s.map_or(time, |reached| reached.max(time));
            let end = gearbox.scene.solver.duration_s;
            (
                time.min(end),
                message.unwrap_or_else(|| "it says so itself".to_owned()),
            )
        });
        Ok(match checked.diverged.or(stated) {
            None => run,
            Some((time_s, quantity)) => run.with_ending(Ending::Diverged { time_s, quantity }),
        })
    }

    fn stats(
        &self,
        gearbox: &Gearbox,
        folder: &JobFolder,
        ended: &Ended,
        log: &SolverLog,
        reply: &Reply,
    ) -> RunStats {
        let solver = &gearbox.scene.solver;
        let refine = self.manifest.refine;
        let by_step = refine.is_some_and(|refine| refine.knob == AccuracySetting::Step);
        let mean = solver.duration_s / reply.steps.max(1) as f64;
        let mut notes = log.notes.clone();
        notes.extend(reply.notes.iter().take(20).map(|note| plain(note, WORDS)));
        RunStats {
            wall_s: ended.wall_s,
            cpu_s: ended.cpu_s.or(reply.cpu_s).unwrap_or(ended.wall_s),
            // A solver with its own law may open the library for the scene only.
            rhs_calls: folder.law_calls().unwrap_or(0).max(reply.right_hand_sides),
            steps: reply.steps,
            rejected_steps: reply.rejected_steps,
            degrees_of_freedom: reply.degrees_of_freedom,
            bodies: gearbox.layout.bodies(),
            step_s: match reply.steps {
                0 if by_step => solver.step_s,
                0 => 0.0,
                _ => mean,
            },
            settings: plain(&reply.settings, WORDS),
            notes,
            joint_drift_m: reply.joint_drift_m,
            ..RunStats::default()
        }
    }
}

impl Engine for Solver {
    fn info(&self) -> EngineInfo<'_> {
        let manifest = &self.manifest;
        EngineInfo {
            differences: &manifest.differences,
            refinement: manifest.refine,
            outside: true,
            brought: true,
            summary: &manifest.summary,
            ..EngineInfo::own(&manifest.name, manifest.track)
        }
    }

    fn version(&self) -> String {
        format!(
            "{} (solver from outside)",
            plain(&self.manifest.version, 60)
        )
    }

    fn build(&self) -> String {
        let hashed = || format!("{:016x}", self.hash());
        self.build.get_or_init(hashed).clone()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        if let Some(reason) = self.manifest.refuses(&gearbox.scene) {
            return Err(Ending::Unsupported { reason }.into());
        }
        self.library()?;
        Ok(prepared(gearbox.clone(), |gearbox, control| {
            self.drive(gearbox, control, |folder, library| {
                job::write(gearbox, folder, library)
            })
        }))
    }
}

/// Returns the variable with the search path of libraries, and its value with `library` first.
fn library_path(library: &Path) -> Option<(&'static str, OsString)> {
    let variable = if cfg!(windows) {
        "PATH"
    } else if cfg!(target_os = "macos") {
        "DYLD_LIBRARY_PATH"
    } else {
        "LD_LIBRARY_PATH"
    };
    let before = std::env::var_os(variable).unwrap_or_default();
    let others: Vec<PathBuf> = std::env::split_paths(&before)
        .filter(|path| !path.as_os_str().is_empty())
        .collect();
    let paths = std::iter::once(library.parent()?.to_owned()).chain(others);
    Some((variable, std::env::join_paths(paths).ok()?))
}

/// Returns the halt of a run that failed with this reason.
fn failed(reason: impl ToString) -> Halt {
    Ending::failed(plain(&reason.to_string(), MESSAGE)).into()
}

/// Describes the external cause of a program's end.
fn killer(status: std::process::ExitStatus) -> String {
    #[cfg(unix)]
    {
        use std::os::unix::process::ExitStatusExt as _;
        let signal = status.signal().unwrap_or(0);
        let name = match signal {
            4 => " (illegal instruction)",
            6 => " (abort)",
            8 => " (arithmetic fault)",
            9 => " (kill; perhaps there was not enough memory)",
            11 => " (segmentation fault)",
            _ => "",
        };
        format!("signal {signal}{name}")
    }
    #[cfg(not(unix))]
    format!("the system ({status})")
}

/// Solvers named by the user, engines of this process like the built-in ones until it ends.
static ADMITTED: RwLock<Vec<&'static Solver>> = RwLock::new(Vec::new());

/// Reads a manifest and adds its solver to the [`registry`](fn@crate::registry). Returns its name.
///
/// # Errors
/// Fault of the manifest, or another solver of that name.
pub fn admit(path: &Path) -> Result<String, FileError> {
    let solver = Solver::open(path)?;
    let name = solver.manifest.name.clone();
    let mut admitted = ADMITTED.write().unwrap_or_else(PoisonError::into_inner);
    if admitted.iter().any(|other| other.manifest.name == name) {
        return Err(FileError::new(
            &path.display().to_string(),
            format!("there is another solver of the name {name:?}"),
            "name each --solver once, and give them different names",
        ));
    }
    // Computes the hash before the solver is copied.
    solver.build();
    admitted.push(Box::leak(Box::new(solver)));
    Ok(name)
}

/// Returns the added solvers as engines.
pub(crate) fn admitted() -> impl Iterator<Item = Box<dyn Engine>> {
    let solvers = joined().into_iter();
    solvers.map(|solver| Box::new(solver.clone()) as Box<dyn Engine>)
}

/// Returns the added solvers.
pub fn joined() -> Vec<&'static Solver> {
    ADMITTED
        .read()
        .unwrap_or_else(PoisonError::into_inner)
        .clone()
}
