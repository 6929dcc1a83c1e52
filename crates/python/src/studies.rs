//! Comparison, bench, explanation, and the list of engines.

use std::path::PathBuf;

use pinwheel::engines::Engine;
use pinwheel::pages;
use pinwheel::studies::comparison::{Effort, Lanes, foreign};
use pinwheel::studies::{Provenance, bench as benches, choice, comparison, explained};
use pyo3::prelude::*;

use crate::errors::{Raises, ended, plain};
use crate::guests::{self, Asked};
use crate::scene::Core;
use crate::supervise::{Desk, supervised};
use crate::time_series::Columns;

/// Returns the origin for pages, with the command of the Python package.
pub(crate) fn origin() -> Provenance {
    Provenance::here("python: import pinwheel")
}

/// Result of a comparison.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Compared {
    outcome: comparison::Outcome,
    /// True if the caller named the engines.
    asked: bool,
    /// Exception of the caller's first engine that raised one.
    failure: Option<PyErr>,
    /// Remarks on runs that were not kept.
    messages: Vec<String>,
}

#[pymethods]
impl Compared {
    /// Returns figures, distances and verdicts, like the program's `summary.json`.
    fn json(&self) -> Raises<String> {
        Ok(serde_json::to_string(&self.outcome.comparison)?)
    }

    /// Returns name and time series of every participant that ran.
    fn time_series(&self, py: Python<'_>) -> PyResult<Vec<(String, Py<Columns>)>> {
        let each = self.outcome.participants.iter().map(|participant| {
            let columns = Columns(participant.time_series.clone());
            Ok((participant.name.clone(), Py::new(py, columns)?))
        });
        each.collect()
    }

    /// True if the program would end with 0: the requested comparison has a result, and every named engine finished.
    fn passed(&self) -> bool {
        self.outcome.exit_status() == 0 && self.outcome.broken(self.asked).is_none()
    }

    /// Returns the exception of a failed engine of the caller, with the raised one as its cause.
    fn failure(&self, py: Python<'_>) -> Option<PyErr> {
        self.failure.as_ref().map(|error| error.clone_ref(py))
    }

    fn messages(&self) -> Vec<String> {
        self.messages.clone()
    }

    /// Returns the page, which needs no network.
    fn page(&self) -> String {
        pages::comparison::page(&self.outcome, &origin())
    }

    /// Returns the text for a terminal.
    fn text(&self) -> String {
        pages::comparison::text(&self.outcome.gearbox.scene, &self.outcome)
    }

    /// Returns the text for a terminal with `--verbose`.
    fn details(&self) -> String {
        pages::comparison::details(&self.outcome)
    }
}

/// Runs a scene on the named engines, or on all available ones, and compares the runs. `lanes`: number of engines at a
/// time, and true to ignore stored runs.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    scene: &Core,
    engines: Vec<Bound<'_, PyAny>>,
    against: Vec<(PathBuf, PathBuf)>,
    effort: (f64, f64),
    lanes: (usize, bool),
    progress: Option<Py<PyAny>>,
) -> Raises<Compared> {
    let checked = &scene.checked;
    let desk = Desk::new();
    let asked = Asked::each(&engines, Some(&desk))?;
    let raised: Vec<_> = asked
        .iter()
        .filter_map(|engine| match engine {
            Asked::Own(guest) => Some((guest.name.clone(), guest.raised.clone())),
            Asked::Name(_) => None,
        })
        .collect();
    let named = !asked.is_empty();
    let mut engines = guests::engines(asked, checked)?;
    let (jobs, fresh) = lanes;
    let mut messages = Vec::new();
    let store = comparison::store(fresh).unwrap_or_else(|error| {
        messages.push(format!("runs are not kept: {error}"));
        None
    });
    if let Some(store) = &store {
        engines = store.around(engines);
    }
    let pairs = against.iter().map(|(file, map)| (&**file, &**map));
    let data = foreign::open(pairs)?;
    let (longest_s, resolution) = effort;
    let effort = Effort::asked(checked, "", &[], longest_s, resolution)?;
    let outcome = supervised(py, &desk, progress.as_ref(), |control| {
        let gearbox = foreign::with_channels(&data, pinwheel::compile(checked)?)?;
        let input = comparison::Input {
            gearbox: &gearbox,
            engines: &engines,
            data: &data,
        };
        let lanes = Lanes {
            jobs,
            store: store.as_deref(),
            ahead: None,
        };
        comparison::run_on(&input, effort, &lanes, control)
    })?;
    messages.extend(store.iter().flat_map(|store| store.messages()));
    let failure = raised.iter().find_map(|(name, raised)| {
        let mut all = outcome.participants.iter();
        let failed = all.find(|one| {
            one.name == *name && matches!(one.status, pinwheel::time_series::Ending::Failed { .. })
        })?;
        let error = PyErr::from(ended(name, &failed.status, None));
        error.set_cause(py, raised.lock().ok()?.take());
        Some(error)
    });
    Ok(Compared {
        outcome,
        asked: named,
        failure,
        messages,
    })
}

/// Cost of accuracy.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Benched(benches::WorkPrecision);

#[pymethods]
impl Benched {
    /// Returns the rows of the program's `bench.csv`.
    fn csv(&self) -> Raises<Vec<u8>> {
        let mut rows = Vec::new();
        self.0.table().write_csv(&mut rows).map_err(plain)?;
        Ok(rows)
    }

    fn page(&self) -> String {
        pages::bench::page(&self.0, &origin())
    }

    fn text(&self) -> String {
        pages::bench::text(&self.0)
    }
}

/// Measures the cost of accuracy of the named engines on one scene.
#[pyfunction]
pub(crate) fn bench(
    py: Python<'_>,
    scene: &Core,
    engines: Vec<Bound<'_, PyAny>>,
    options: (f64, usize, f64),
    methods: Vec<String>,
    progress: Option<Py<PyAny>>,
) -> Raises<Benched> {
    let checked = &scene.checked;
    let (target, repeats, longest_s) = options;
    let options = benches::Options::asked(target, repeats, longest_s, methods)?;
    let (mut names, mut own) = (Vec::new(), Vec::<Box<dyn Engine>>::new());
    let desk = Desk::new();
    for engine in Asked::each(&engines, Some(&desk))? {
        match engine {
            Asked::Name(name) => names.push(name),
            Asked::Own(guest) => own.push(Box::new(guest)),
        }
    }
    if !names.is_empty() || own.is_empty() {
        own.splice(..0, benches::engines(&names, checked)?);
    }
    let study = supervised(py, &desk, progress.as_ref(), |control| {
        benches::run(checked, &own, &options, control)
    })?;
    Ok(Benched(study))
}

/// Returns model and assumptions of a scene: (JSON, text).
#[pyfunction]
pub(crate) fn explain(scene: &Core) -> Raises<(String, String)> {
    let gearbox = pinwheel::compile(&scene.checked)?;
    let explained = explained::explain(&gearbox);
    let json = serde_json::to_string(&explained)?;
    Ok((json, pages::explain::text(&explained)))
}

/// Returns the available engines, like the program's `engines --json`.
#[pyfunction]
pub(crate) fn engines() -> Raises<String> {
    Ok(serde_json::to_string(&choice::listed())?)
}
