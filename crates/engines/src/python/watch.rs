//! Python run on its own thread, with progress and cancellation on the caller's.
//!
//! Python objects cannot borrow, and [`Control`] is a borrow. Therefore a channel carries times to the caller's thread, and
//! another one its answers.

use std::panic::resume_unwind;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, scope};
use std::time::Duration;

use cpu_time::ThreadTime;
use pinwheel_gearbox::Gearbox;
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict};

use super::convert;
use super::published::Published;
use crate::control::Control;
use crate::engine::{Ending, Halt, Run};

/// Stack size of the thread, bytes, for deep recursion of C++ and Python.
const STACK_BYTES: usize = 64 << 20;

/// Message of a run to the caller's thread: the time reached, s, and the CPU time of the run's thread; `None` at the end of
/// the run, also by a panic. The explicit end is necessary because Python may keep the other sender alive.
type Message = Option<(f64, Duration)>;

/// Channels of a run to its caller.
struct Watch {
    tell: SyncSender<Message>,
    hear: Receiver<bool>,
}

impl Watch {
    /// Returns the Python function `on_progress(time_s) -> stop`.
    fn into_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyCFunction>> {
        let line = Mutex::new(self);
        PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<bool> {
            let time_s: f64 = args.get_item(0)?.extract()?;
            // Other threads may run Python while the caller draws its progress.
            Ok(args.py().detach(|| {
                let line = line.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                let now = Some((time_s, ThreadTime::now().as_duration()));
                line.tell.send(now).is_err() || line.hear.recv().unwrap_or(true)
            }))
        })
    }
}

/// Sends the end of a run on drop.
struct End(SyncSender<Message>);

impl Drop for End {
    fn drop(&mut self) {
        let _ = self.0.send(None);
    }
}

/// Runs a Python solver on the scene of `gearbox`: `call` gets the common options, `on_progress` and `initial_states`, and
/// the law, which is closed afterwards. Also returns an exception of Python.
pub(super) fn hosted(
    gearbox: &Gearbox,
    control: &Control<'_>,
    law: Option<Published>,
    call: impl for<'py> FnOnce(&Bound<'py, PyDict>, Option<&Published>) -> PyResult<Bound<'py, PyAny>>
    + Send,
) -> (Result<Run, Halt>, Option<PyErr>) {
    // Equal start states for all engines.
    let states = gearbox.initial_states();
    let start: Vec<[f64; 6]> = states.iter().map(pinwheel_law::numbers).collect();
    let ran = watched(control, |watch| {
        Python::attach(|py| {
            let driven = || -> PyResult<Run> {
                let options = PyDict::new(py);
                options.set_item("on_progress", watch.into_python(py)?)?;
                options.set_item("initial_states", start)?;
                convert::run(&call(&options, law.as_ref())?)
            };
            match driven() {
                Ok(run) => (Ok(run), None),
                Err(error) => (convert::ended(py, &error), Some(error)),
            }
        })
    });
    // No callback may reach this run any more, whatever Python did.
    drop(law);
    ran.unwrap_or_else(|error| (Ok(Run::ended(Ending::failed(error))), None))
}

/// Runs `work` on its own thread; checks `control` at every time that `work` reports.
///
/// # Errors
/// No thread available.
fn watched<T: Send>(
    control: &Control<'_>,
    work: impl FnOnce(Watch) -> T + Send,
) -> std::io::Result<T> {
    let (tell, reported) = sync_channel(0);
    let (answer, hear) = sync_channel(1);
    let watch = Watch {
        tell: tell.clone(),
        hear,
    };
    scope(|scope| {
        let worker = Builder::new()
            .name("python engine".to_owned())
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, move || {
                let _end = End(tell);
                work(watch)
            })?;
        while let Ok(Some((time_s, cpu))) = reported.recv() {
            if answer.send(control.reached_elsewhere(time_s, cpu)).is_err() {
                break;
            }
        }
        // A worker that still reports is answered with a stop.
        drop((reported, answer));
        worker.join().or_else(|panic| resume_unwind(panic))
    })
}
