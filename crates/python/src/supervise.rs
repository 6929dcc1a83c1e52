//! Work on its own thread without the interpreter's lock, while the caller's thread checks for Ctrl-C, reports progress,
//! and runs Python code. Ctrl-C therefore raises an exception inside a user's solver, as in any function.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, scope};
use std::time::{Duration, Instant};

use pinwheel::studies::{Control, Progress};
use pyo3::exceptions::{PyException, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict};

use crate::errors::{Raised, Raises, plain};

/// Interval between two checks for signals and two reports of progress.
const EVERY: Duration = Duration::from_millis(50);
/// Stack size of the thread, bytes: that of a main thread.
const STACK_BYTES: usize = 8 << 20;

/// Progress of a study at its last report.
#[derive(Clone, Default)]
struct LastReport {
    done: usize,
    total: usize,
    piece: String,
    simulated_s: Option<[f64; 2]>,
}

/// Message to the caller's thread.
enum Item {
    /// Solver to run.
    Call(Call),
    /// End of the work.
    End,
}

/// Solver with its scene and options, and the channel for its result.
struct Call {
    drive: Py<PyAny>,
    scene: String,
    options: Py<PyDict>,
    answer: SyncSender<PyResult<Py<PyAny>>>,
}

/// Channel by which threads hand solvers to the caller's thread, which runs them.
pub(crate) struct Desk {
    bring: Sender<Item>,
    brought: Mutex<Receiver<Item>>,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let (bring, brought) = channel();
        Self {
            bring,
            brought: Mutex::new(brought),
        }
    }

    /// Wraps the callable `drive` so that the thread that called [`supervised`] runs it.
    pub(crate) fn at_caller(&self, py: Python<'_>, drive: Py<PyAny>) -> PyResult<Py<PyAny>> {
        let bring = self.bring.clone();
        Ok(Py::new(py, AtCaller { drive, bring })?.into_any())
    }
}

/// Solver that another thread runs.
#[pyclass(frozen, module = "pinwheel._core")]
struct AtCaller {
    drive: Py<PyAny>,
    bring: Sender<Item>,
}

#[pymethods]
impl AtCaller {
    fn __call__(&self, py: Python<'_>, scene: String, options: Py<PyDict>) -> PyResult<Py<PyAny>> {
        let (answer, answered) = sync_channel(1);
        let call = Call {
            drive: self.drive.clone_ref(py),
            scene,
            options,
            answer,
        };
        let gone = || PyRuntimeError::new_err("the process that runs this engine has ended");
        let sent = self.bring.send(Item::Call(call));
        sent.map_err(|_| gone())?;
        py.detach(move || answered.recv()).map_err(|_| gone())?
    }
}

/// Sends the end of the work when it is dropped, also after a panic.
struct Ending(Sender<Item>);

impl Drop for Ending {
    fn drop(&mut self) {
        // Without a receiver no thread waits.
        let _unheard = self.0.send(Item::End);
    }
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs `work`. Calls `progress(done, total, piece, simulated_s, of_s)` at intervals; an exception from it stops the work.
///
/// # Errors
/// `KeyboardInterrupt`, or an exception from `progress`, after the end of the work; or an error of the work.
pub(crate) fn supervised<T: Send, E: Into<Raised> + Send>(
    py: Python<'_>,
    desk: &Desk,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Control<'_>) -> Result<T, E> + Send,
) -> Raises<T> {
    let cancel = AtomicBool::new(false);
    let last = Arc::new(Mutex::new(LastReport::default()));
    let (done, raised) = py.detach(|| {
        let ending = Ending(desk.bring.clone());
        let report = |at: Progress<'_>| {
            let mut last = lock(&last);
            (last.done, last.total, last.simulated_s) = (at.done, at.total, at.simulated_s);
            if last.piece != at.piece {
                at.piece.clone_into(&mut last.piece);
            }
        };
        scope(|scope| {
            let control = Control::new(&cancel, &report);
            let started = Builder::new()
                .name("pinwheel".to_owned())
                .stack_size(STACK_BYTES)
                .spawn_scoped(scope, move || {
                    let _ending = ending;
                    work(&control)
                });
            let worker = match started {
                Ok(worker) => worker,
                Err(error) => return (Err(error), None),
            };
            let brought = lock(&desk.brought);
            let mut raised: Option<PyErr> = None;
            loop {
                let result = match brought.recv_timeout(EVERY) {
                    Ok(Item::End) | Err(RecvTimeoutError::Disconnected) => break,
                    Ok(Item::Call(call)) if raised.is_some() => {
                        Python::attach(|py| call.refuse(py));
                        continue;
                    }
                    Ok(Item::Call(call)) => {
                        Python::attach(|py| call.run(py, progress, Arc::clone(&last)))
                    }
                    Err(RecvTimeoutError::Timeout) if raised.is_some() => continue,
                    Err(RecvTimeoutError::Timeout) => {
                        let now = lock(&last).clone();
                        Python::attach(|py| tell(py, progress, &now))
                    }
                };
                if let Err(error) = result {
                    raised = Some(error);
                    cancel.store(true, Ordering::Relaxed);
                }
            }
            let done = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            (Ok(done), raised)
        })
    });
    if let Some(error) = raised {
        return Err(error.into());
    }
    if let Some(progress) = progress {
        let mut last = lock(&last).clone();
        last.done = last.total;
        call(py, progress, &last)?;
    }
    let done = done.map_err(|error| plain(format!("no thread is left: {error}")))?;
    done.map_err(E::into)
}

/// Returns the package's exception for a run that was stopped.
fn stopped(py: Python<'_>) -> PyErr {
    let errors = py.import("pinwheel_engines.errors");
    let exception = errors.and_then(|errors| errors.getattr("Cancelled")?.call0());
    exception.map_or_else(|broken| broken, PyErr::from_value)
}

impl Call {
    /// Answers the call with the exception of a stopped run.
    fn refuse(self, py: Python<'_>) {
        // The calling thread may be gone.
        let _unheard = self.answer.send(Err(stopped(py)));
    }

    /// Runs the solver; calls `progress` at its samples.
    ///
    /// # Errors
    /// Returns the error that ends all of the work and not only this run: Ctrl-C, or one that `progress` raised.
    fn run(
        self,
        py: Python<'_>,
        progress: Option<&Py<PyAny>>,
        last: Arc<Mutex<LastReport>>,
    ) -> PyResult<()> {
        let refused = Arc::new(Mutex::new(None));
        let ran = self.listen(py, progress, last, Arc::clone(&refused));
        let ran = ran.and_then(|()| self.drive.call1(py, (&self.scene, &self.options)));
        let error = lock(&refused).take();
        let stops = match &ran {
            Err(error) if !error.is_instance_of::<PyException>(py) => Some(error.clone_ref(py)),
            _ => error,
        };
        let answer = match stops {
            Some(_) => Err(stopped(py)),
            None => ran,
        };
        let _unheard = self.answer.send(answer);
        stops.map_or(Ok(()), Err)
    }

    /// Passes the solver's reports to `progress` too, which this thread cannot call while it runs the solver.
    fn listen(
        &self,
        py: Python<'_>,
        progress: Option<&Py<PyAny>>,
        last: Arc<Mutex<LastReport>>,
        refused: Arc<Mutex<Option<PyErr>>>,
    ) -> PyResult<()> {
        let Some(progress) = progress.map(|progress| progress.clone_ref(py)) else {
            return Ok(());
        };
        let options = self.options.bind(py);
        let Some(report) = options.get_item("on_progress")?.map(Bound::unbind) else {
            return Ok(());
        };
        let called = Mutex::new(Instant::now());
        let both = PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<bool> {
            let py = args.py();
            let stop: bool = report.call1(py, args)?.extract(py)?;
            if lock(&called).elapsed() < EVERY {
                return Ok(stop);
            }
            *lock(&called) = Instant::now();
            let now = lock(&last).clone();
            let result = tell(py, Some(&progress), &now);
            Ok(match result {
                Ok(()) => stop,
                Err(error) => {
                    *lock(&refused) = Some(error);
                    true
                }
            })
        })?;
        options.set_item("on_progress", both)
    }
}

fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, last: &LastReport) -> PyResult<()> {
    py.check_signals()?;
    match progress {
        Some(progress) if last.total > 0 => call(py, progress, last),
        _ => Ok(()),
    }
}

fn call(py: Python<'_>, progress: &Py<PyAny>, last: &LastReport) -> PyResult<()> {
    let [now, of] = last.simulated_s.unwrap_or([0.0; 2]);
    progress.call1(py, (last.done, last.total, last.piece.as_str(), now, of))?;
    Ok(())
}
