//! The embedded interpreter with the package `pinwheel_engines` loaded, once per process.
//!
//! Python is started without signal handlers, so Ctrl-C stays the program's own. Its search path
//! begins with our copy of the package and the environment's packages, so that nothing the user has
//! installed elsewhere takes their place.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use pyo3::prelude::*;

use super::convert::text_of;
use super::environment::{self, ENGINES, Environment};
use super::error::PythonError;
use super::host::{PACKAGE, package};
use super::pins::pins;
use crate::cache;

/// The package's files: path below its folder, text.
const SOURCES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/sources.rs"));
/// What the process knows of its Python so far. A failure is kept: asking pip again for every
/// engine of a comparison would only take time.
static READY: Mutex<Option<Result<(), PythonError>>> = Mutex::new(None);

/// Makes the environment if need be, starts Python and loads the package.
///
/// # Errors
/// See [`PythonError`]; the same one again at every later call, but for a stop by the user.
pub(super) fn ready(cancel: &AtomicBool) -> Result<(), PythonError> {
    let mut ready = READY
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some(known) = ready.as_ref() {
        return known.clone();
    }
    let outcome = environment::environment(ENGINES, cancel).and_then(|found| load(&found));
    if !outcome.as_ref().is_err_and(PythonError::is_stop) {
        *ready = Some(outcome.clone());
    }
    outcome
}

/// Starts Python on an environment and loads the package.
fn load(environment: &Environment) -> Result<(), PythonError> {
    let files: Vec<(String, &str)> = SOURCES
        .iter()
        .map(|&(name, text)| (format!("{PACKAGE}/{name}"), text))
        .collect();
    let sources = cache::laid_out("sources", &files)?;
    let failed = |reason: String| PythonError::Load {
        reason,
        folder: environment.folder.clone(),
        named: environment::is_named(),
    };
    Python::attach(|py| {
        let start = || -> PyResult<Result<(), String>> {
            let path = py.import("sys")?.getattr("path")?;
            // As text: the search path ignores path objects.
            path.call_method1("insert", (0, environment.packages.as_os_str()))?;
            path.call_method1("insert", (0, sources.as_os_str()))?;
            let metadata = py.import("importlib.metadata")?;
            for pin in pins() {
                let found: String = metadata
                    .call_method1("version", (pin.package,))
                    .and_then(|version| version.extract())?;
                if found != pin.version {
                    return Ok(Err(format!(
                        "it has {} {found}, and recorded time series and limits belong to {}",
                        pin.package, pin.version
                    )));
                }
            }
            package(py)?;
            Ok(Ok(()))
        };
        match start() {
            Ok(Ok(())) => Ok(()),
            Ok(Err(reason)) => Err(failed(reason)),
            Err(error) => Err(failed(text_of(py, &error))),
        }
    })
}
