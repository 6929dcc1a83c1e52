//! Solver of a user in Python as [`Engine`](crate::Engine).
//!
//! ```text
//!  drive(scene_toml, options) -> result        a Python callable
//!    options: on_progress(time_s) -> stop      asked at every sample
//!             initial_states                   (bodies, 6)
//!             loads(states, loads)             our contact law, into arrays of doubles: (bodies, 6) -> (bodies, 3)
//!    result:  columns, stats                   as those of the package's own engines
//! ```

use std::sync::{Arc, Mutex};

use pinwheel_gearbox::Gearbox;
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyCFunction;

use super::law::locked;
use super::published::Published;
use super::watch::hosted;
use crate::control::Control;
use crate::engine::{Ending, Engine, Halt, Prepared, Run, SharedModel, prepared};
use crate::info::{EngineInfo, Refinement};

/// Solver of the user.
#[derive(Debug)]
pub struct UserEngine {
    /// Name for users.
    pub name: String,
    /// Shared model, which selects the comparison of the engine.
    pub track: SharedModel,
    /// Version; results must not change within one.
    pub version: String,
    /// Summary in one line.
    pub summary: String,
    /// Differences from the native solver.
    pub differences: String,
    /// Order of convergence in `solver.step_s`; `None` for steps of its own.
    pub order: Option<f64>,
    /// Callable that runs a scene.
    pub drive: Py<PyAny>,
    /// Last exception that is not one of the package's errors, for a caller that shows a traceback.
    pub raised: Arc<Mutex<Option<PyErr>>>,
}

impl UserEngine {
    fn run(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, Halt> {
        let law = Published::new(gearbox)?;
        let scene_toml = gearbox.scene.at_work().to_toml();
        let (ran, raised) = hosted(gearbox, control, Some(law), |options, law| {
            let py = options.py();
            if let Some(law) = law {
                options.set_item("loads", loads(py, law)?)?;
            }
            self.drive.bind(py).call1((scene_toml, options))
        });
        if matches!(&ran, Ok(run) if matches!(run.ending, Ending::Failed { .. })) {
            *locked(&self.raised) = raised;
        }
        ran
    }
}

/// Returns the law as a Python function on the caller's arrays.
fn loads<'py>(py: Python<'py>, law: &Published) -> PyResult<Bound<'py, PyCFunction>> {
    let law = Arc::clone(&law.law);
    let bodies = law.bodies;
    PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<()> {
        let py = args.py();
        let states = PyBuffer::<f64>::get(&args.get_item(0)?)?;
        let loads = PyBuffer::<f64>::get(&args.get_item(1)?)?;
        if states.item_count() != 6 * bodies || loads.item_count() != 3 * bodies {
            return Err(PyValueError::new_err(format!(
                "states must be ({bodies}, 6) and loads ({bodies}, 3)"
            )));
        }
        let states = states.to_vec(py)?;
        let mut wrenches = vec![0.0; 3 * bodies];
        law.evaluate(&states, &mut wrenches);
        loads.copy_from_slice(py, &wrenches)
    })
}

impl Engine for UserEngine {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            brought: true,
            in_python: true,
            differences: &self.differences,
            refinement: self.order.map(Refinement::step),
            summary: &self.summary,
            ..EngineInfo::own(&self.name, self.track)
        }
    }

    fn version(&self) -> String {
        self.version.clone()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        Ok(prepared(gearbox.clone(), |gearbox, control| {
            self.run(gearbox, control)
        }))
    }
}
