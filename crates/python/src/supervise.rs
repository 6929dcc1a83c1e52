//! Work on a thread of its own while the interpreter's lock is free: the caller's thread looks for Ctrl-C and tells the
//! progress.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, scope};
use std::time::Duration;

use pinwheel::studies::{Control, Progress};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often signals are looked for and progress is told.
const EVERY: Duration = Duration::from_millis(50);
/// As deep as a main thread's.
const STACK_BYTES: usize = 8 << 20;

/// Where a study is, last told.
#[derive(Clone, Default)]
struct Seen {
    done: usize,
    total: usize,
    piece: String,
    simulated_s: Option<[f64; 2]>,
}

/// Does `work`. `progress(done, total, piece, simulated_s, of_s)` is called now and then; what it raises stops the work.
///
/// # Errors
/// `KeyboardInterrupt`, or what `progress` raised; the work has ended by then.
pub(crate) fn supervised<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Control<'_>) -> T + Send,
) -> PyResult<T> {
    let cancel = AtomicBool::new(false);
    let seen = Mutex::new(Seen::default());
    let (ending, ended) = sync_channel::<()>(0);
    let (done, raised) = py.detach(|| {
        let ended = ended;
        let report = |at: Progress<'_>| {
            let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
            (seen.done, seen.total, seen.simulated_s) = (at.done, at.total, at.simulated_s);
            if seen.piece != at.piece {
                at.piece.clone_into(&mut seen.piece);
            }
        };
        scope(|scope| {
            let control = Control::new(&cancel, &report);
            let started = Builder::new()
                .name("pinwheel".to_owned())
                .stack_size(STACK_BYTES)
                .spawn_scoped(scope, move || {
                    // Dropped at the end, however it comes.
                    let _ending = ending;
                    work(&control)
                });
            let worker = match started {
                Ok(worker) => worker,
                Err(error) => return (Err(error), None),
            };
            let mut raised: Option<PyErr> = None;
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(EVERY) {
                if raised.is_some() {
                    continue;
                }
                let now = seen.lock().unwrap_or_else(PoisonError::into_inner).clone();
                let told = Python::attach(|py| tell(py, progress, &now));
                if let Err(error) = told {
                    raised = Some(error);
                    cancel.store(true, Ordering::Relaxed);
                }
            }
            (
                Ok(worker.join().unwrap_or_else(|panic| resume_unwind(panic))),
                raised,
            )
        })
    });
    if let Some(error) = raised {
        return Err(error);
    }
    if let Some(progress) = progress {
        let mut last = seen.into_inner().unwrap_or_else(PoisonError::into_inner);
        last.done = last.total;
        call(py, progress, &last)?;
    }
    done.map_err(|error| PyRuntimeError::new_err(format!("no thread is left: {error}")))
}

fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, seen: &Seen) -> PyResult<()> {
    py.check_signals()?;
    match progress {
        Some(progress) if seen.total > 0 => call(py, progress, seen),
        _ => Ok(()),
    }
}

fn call(py: Python<'_>, progress: &Py<PyAny>, seen: &Seen) -> PyResult<()> {
    let [now, of] = seen.simulated_s.unwrap_or([0.0; 2]);
    progress.call1(py, (seen.done, seen.total, seen.piece.as_str(), now, of))?;
    Ok(())
}
