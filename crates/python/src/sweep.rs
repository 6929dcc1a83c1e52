//! Sweeps: planned and stored here, run by threads of this process or, in batches, by other processes.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

use pinwheel::pages;
use pinwheel::scene::Scene;
use pinwheel::studies::folder::{Folder, Request};
use pinwheel::studies::output::{file_name, write_text};
use pinwheel::studies::sweep::{
    self as sweeps, Begin, Guests, Journal, KeepTimeSeries, Plan, PlannedRun, Row, Rows, RunRecord,
};
use pinwheel::time_series::table::{Table, Values};
use pyo3::prelude::*;

use crate::errors::{Raised, Raises, input, plain};
use crate::guests::{self, Asked};
use crate::scene::overrides;
use crate::studies::origin;
use crate::supervise::{Desk, lock, supervised};

/// Command in the manifest of a folder.
const COMMAND: &str = "pinwheel.sweep in Python";

/// Sweep with its journal, from its plan to its files.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Sweep {
    plan: Plan,
    desk: Desk,
    out: PathBuf,
    request: Request,
    /// `None` after the results are written.
    journal: Mutex<Option<Journal>>,
    /// Index of the first run without a worker.
    next: AtomicUsize,
    rows: Mutex<Rows>,
    /// Complete rows, with their table.
    results: OnceLock<(Rows, Table)>,
}

/// Returns the error of a call after the results were written.
fn over() -> Raised {
    plain("the results of this sweep are written")
}

/// Returns the error of a call before all runs are done.
fn undone() -> Raised {
    plain("this sweep has runs that are not done")
}

#[pymethods]
impl Sweep {
    /// Plans a sweep from the text of the file `path`, checks its output folder, and opens its journal.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        text: &str,
        path: &str,
        sets: Vec<(String, String)>,
        engines: Vec<Bound<'_, PyAny>>,
        out: Option<PathBuf>,
        resume: bool,
        force: bool,
    ) -> Raises<Self> {
        let mut sweep = sweeps::Sweep::from_toml(text, Path::new(path))?;
        let desk = Desk::new();
        let (names, own) = guests::split(Asked::each(&engines, Some(&desk))?);
        if !names.is_empty() {
            sweep.engines = names;
        }
        let (sets, never) = (overrides(&sets), AtomicBool::new(false));
        let plan = py.detach(|| Plan::within(sweep, &sets, Guests(own), &never))?;
        let stem = Path::new(path).file_stem().unwrap_or_default();
        let name = format!("{}-sweep", file_name(&stem.to_string_lossy()));
        let request = Request {
            command: COMMAND.to_owned(),
            of: path.to_owned(),
            only_of: out.is_none(),
            force,
            ..Request::default()
        };
        let out = out.unwrap_or_else(|| Path::new("out").join(name));
        drop(Folder::prepare(&out, request.clone())?);
        let journal = Journal::begin(&out, Begin::of(resume, force), COMMAND)?;
        let rows = Mutex::new(Rows::new(plan.len()));
        Ok(Self {
            plan,
            desk,
            out,
            request,
            journal: Mutex::new(Some(journal)),
            next: AtomicUsize::new(0),
            rows,
            results: OnceLock::new(),
        })
    }

    fn __len__(&self) -> usize {
        self.plan.len()
    }

    /// Name of the sweep.
    fn name(&self) -> &str {
        &self.plan.sweep.name
    }

    /// Returns the path of the results folder.
    fn out(&self) -> String {
        self.out.display().to_string()
    }

    /// Returns the varied keys.
    fn keys(&self) -> Vec<&str> {
        self.plan.keys().collect()
    }

    /// Runs all that the journal lacks on `jobs` threads.
    fn execute(&self, py: Python<'_>, jobs: usize, progress: Option<Py<PyAny>>) -> Raises<()> {
        let rows = supervised(py, &self.desk, progress.as_ref(), |control| {
            let journal = lock(&self.journal);
            let journal = journal.as_ref().ok_or_else(over)?;
            Ok::<_, Raised>(sweeps::execute(&self.plan, journal, jobs, control)?)
        })?;
        *lock(&self.rows) = rows;
        Ok(())
    }

    /// Returns the next runs for workers, at most `count` (number, engine, complete scene, window), and how many are left after
    /// them. Runs that the journal has need none.
    fn take(&self, count: usize) -> Raises<(Vec<Task>, usize)> {
        let journal = lock(&self.journal);
        let journal = journal.as_ref().ok_or_else(over)?;
        let mut tasks = Vec::new();
        let mut next = self.next.load(Ordering::Relaxed);
        while next < self.plan.len() && tasks.len() < count {
            let planned = self.plan.run(next)?;
            let (scene, identity) = sweeps::wanted_of(&planned);
            match sweeps::find(&self.plan, &planned, journal, &identity) {
                Some(record) => lock(&self.rows).put(next, record),
                None => {
                    let engine = planned.engine.name().to_owned();
                    tasks.push((planned.number, engine, scene, planned.window_s));
                }
            }
            next += 1;
        }
        self.next.store(next, Ordering::Relaxed);
        Ok((tasks, self.plan.len() - next))
    }

    /// Returns folder and format of the workers' time series; `None` if no series are stored.
    fn time_series(&self) -> Option<(String, &'static str)> {
        let how = match self.plan.sweep.time_series {
            KeepTimeSeries::None => return None,
            KeepTimeSeries::Csv => "csv",
            KeepTimeSeries::Parquet => "parquet",
        };
        let journal = lock(&self.journal);
        let place = std::path::absolute(journal.as_ref()?.folder()).ok()?;
        Some((place.display().to_string(), how))
    }

    /// Stores the record of the run `number` from a worker.
    fn accept(&self, number: usize, record: &str) -> Raises<()> {
        let mut record: RunRecord = serde_json::from_str(record)?;
        let place = number - 1;
        let (scene, ours) = sweeps::wanted_of(&self.plan.run(place)?);
        record.scene = scene;
        if record.identity() != ours {
            return Err(input(
                "a worker has another build of pinwheel, or of an engine, than this process; install the same on all machines",
            ));
        }
        let journal = lock(&self.journal);
        let journal = journal.as_ref().ok_or_else(over)?;
        journal.keep(&record)?;
        lock(&self.rows).put(place, record);
        Ok(())
    }

    /// Writes the output folder, as the program does, and removes the journal.
    fn finish(&self) -> Raises<()> {
        let done = std::mem::take(&mut *lock(&self.rows));
        let rows = done.all().ok_or_else(undone)?;
        let mut journal = lock(&self.journal);
        let held = journal.as_ref().ok_or_else(over)?;
        let target = Folder::prepare(&self.out, self.request.clone())?;
        let (table, origin) = (sweeps::results(&self.plan, &rows), origin());
        sweeps::write(target.path(), &self.plan, &rows, &table, held, &origin)?;
        let page = pages::sweep::page(&self.plan, &rows, &table, &origin);
        write_text(&target.path().join("index.html"), &page)?;
        target.publish()?;
        drop(rows);
        self.results.get_or_init(|| (done, table));
        journal
            .take()
            .map_or(Ok(()), |journal| Ok(journal.remove()?))
    }

    /// Closes the journal with its runs, or removes an empty one. Returns the number of its runs.
    fn close(&self) -> Raises<usize> {
        let Some(journal) = lock(&self.journal).take() else {
            return Ok(0);
        };
        let kept = journal.in_its_folder();
        if kept == 0 {
            journal.remove()?;
        }
        Ok(kept)
    }

    /// Returns the results as columns: (name, values), numbers or texts, `None` without a value.
    fn columns<'py>(&self, py: Python<'py>) -> Raises<Vec<(String, Bound<'py, PyAny>)>> {
        let columns = self.results()?.1.columns.iter();
        let each = columns.map(|column| {
            let values = match &column.values {
                Values::Number(values) => values.into_pyobject(py)?,
                Values::Integers(values) => values.into_pyobject(py)?,
                Values::Text(values) => values.into_pyobject(py)?,
            };
            Ok((column.name.clone(), values.into_any()))
        });
        each.collect()
    }

    /// Returns the number of unfinished runs, and engine and reason of the first.
    fn broken(&self) -> Raises<(usize, Option<(String, String)>)> {
        let (rows, _) = self.results()?;
        let broken = sweeps::broken(&rows);
        let first = broken.clone().next();
        let first = first.map(|row| (row.engine()[0].to_owned(), row.reason()));
        Ok((broken.count(), first))
    }

    /// Returns the results of a sample, JSON: a list, empty without one.
    fn tolerances(&self) -> Raises<String> {
        let samples = sweeps::tolerances(&self.plan, self.results()?.1);
        Ok(serde_json::to_string(&samples)?)
    }

    /// Returns the text for a terminal.
    fn text(&self) -> Raises<String> {
        let files = [("results", "results.csv"), ("report", "index.html")]
            .map(|(word, name)| (word, self.out.join(name).display().to_string()));
        let (rows, table) = self.results()?;
        Ok(pages::sweep::text(&self.plan, &rows, table, &files))
    }

    /// Returns the CPU time of all runs, s.
    fn cpu_s(&self) -> Raises<f64> {
        Ok(self.results()?.0.iter().map(|row| row.cpu_s).sum())
    }
}

impl Sweep {
    /// Returns all rows with their table.
    fn results(&self) -> Raises<(Vec<Row<'_>>, &Table)> {
        let (rows, table) = self.results.get().ok_or_else(undone)?;
        Ok((rows.all().ok_or_else(undone)?, table))
    }
}

/// Run for a worker: number, engine, complete scene as TOML, window.
type Task = (usize, String, String, [f64; 2]);

/// Runs tasks of another process, and returns their records as JSON, without the scenes; `time_series`: folder and format
/// of the series.
#[pyfunction]
pub(crate) fn perform(
    py: Python<'_>,
    tasks: Vec<Task>,
    engines: Vec<Bound<'_, PyAny>>,
    time_series: Option<(PathBuf, String)>,
) -> Raises<Vec<String>> {
    let keep = match time_series.as_ref().map(|(_, how)| how.as_str()) {
        None => KeepTimeSeries::None,
        Some("csv") => KeepTimeSeries::Csv,
        Some(_) => KeepTimeSeries::Parquet,
    };
    let place = time_series.map(|(folder, _)| folder).unwrap_or_default();
    let (_, own) = guests::split(Asked::each(&engines, None)?);
    let guests = Guests(own);
    let mut last = None;
    let each = tasks.into_iter().map(|(number, engine, scene, window_s)| {
        let checked = Scene::from_complete(&scene)?;
        let Some(engine) = guests.engine(&engine, &checked) else {
            let text = format!("this machine has no engine `{engine}`");
            return Err(input(text));
        };
        let planned = PlannedRun {
            number,
            engine,
            values: Vec::new(),
            scene: checked,
            window_s,
            refused: None,
        };
        let record = py.detach(|| {
            let control = pinwheel::Control::quiet();
            let place = (place.as_path(), keep);
            sweeps::perform(&planned, &scene, place, &mut last, &control)
        });
        let mut record = record?;
        record.scene = String::new();
        Ok(serde_json::to_string(&record)?)
    });
    each.collect()
}
