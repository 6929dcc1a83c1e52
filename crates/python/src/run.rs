//! Run of one scene on one engine.

use pinwheel::engines::Engine;
use pinwheel::pages;
use pinwheel::studies::{Control, StudyError, choice, single};
use pinwheel::time_series::Ending;
use pyo3::prelude::*;
use serde_json::to_string;

use crate::errors::{Raised, Raises, ended};
use crate::guests::Asked;
use crate::scene::Core;
use crate::supervise::{Desk, supervised};
use crate::time_series::Columns;

/// Run with its time series.
#[pyclass(frozen, get_all, module = "pinwheel._core")]
pub(crate) struct Ran {
    engine: String,
    version: String,
    track: &'static str,
    /// Cost, settings and notes, JSON.
    stats: String,
    /// Evidence of a run at twice the step, JSON; `None` without one.
    resolution: Option<String>,
    /// Numerical uncertainty stated by the engine, JSON.
    uncertainty: Option<String>,
    /// Results of the run with their uncertainty, JSON.
    results: String,
    /// Figures with other contact laws and fits, JSON; `None` if not computed.
    by_contact_law: Option<String>,
    /// Text for a terminal.
    text: String,
    columns: Py<Columns>,
}

impl Ran {
    fn of(py: Python<'_>, result: single::Outcome) -> Raises<Self> {
        let results = result.results();
        Ok(Self {
            results: to_string(&results)?,
            by_contact_law: result.bands.as_ref().map(to_string).transpose()?,
            text: pages::single::text(&result, &results, None),
            engine: result.engine,
            version: result.version,
            track: result.track.as_str(),
            stats: to_string(&result.run.stats)?,
            resolution: result.resolution.as_ref().map(to_string).transpose()?,
            uncertainty: result.run.uncertainty.as_ref().map(to_string).transpose()?,
            columns: Py::new(py, Columns(result.run.time_series))?,
        })
    }
}

/// Runs a scene; `check`: repeats a native run at twice its step, and computes figures with other contact laws.
#[pyfunction]
pub(crate) fn run(
    py: Python<'_>,
    scene: &Core,
    engine: &Bound<'_, PyAny>,
    check: bool,
    progress: Option<Py<PyAny>>,
) -> Raises<Ran> {
    let checked = &scene.checked;
    let desk = Desk::new();
    let asked = Asked::of(engine, Some(&desk))?;
    let named;
    let (engine, guest): (&dyn Engine, _) = match &asked {
        Asked::Name(name) => {
            named = choice::find(name, checked)?;
            (named.as_ref(), None)
        }
        Asked::Own(guest) => (guest, Some(guest)),
    };
    let work = |control: &Control<'_>| {
        let gearbox = pinwheel::compile(checked)?;
        let outcome = single::run(&gearbox, engine, check, control)?;
        match check {
            true => outcome.with_bands(&gearbox, control),
            false => Ok(outcome),
        }
    };
    let progress = progress.as_ref();
    let outcome = supervised(py, &desk, progress, |control| {
        Ok::<_, Raised>(work(control))
    })?;
    let outcome = outcome.map_err(|error| {
        let failed = |ending: &Ending| matches!(ending, Ending::Failed { .. });
        let broke = matches!(&error, StudyError::Ended { ending, .. } if failed(ending));
        let error = PyErr::from(Raised::from(error));
        let raised = guest.and_then(|guest| guest.raised.lock().ok()?.take());
        if broke {
            error.set_cause(py, raised);
        }
        error
    })?;
    let (engine, ending) = (outcome.engine.clone(), outcome.run.ending.clone());
    let ran = Ran::of(py, outcome)?;
    if !ending.is_finished() {
        let partial = Py::new(py, ran)?.into_any();
        return Err(ended(&engine, &ending, Some(partial)));
    }
    Ok(ran)
}
