//! Embedded interpreter with the package `pinwheel_engines`, loaded once a process.
//!
//! Python starts without signal handlers, so Ctrl-C remains the program's. The search path begins with the embedded copy of
//! the package and the environment's packages, so that other installations cannot replace them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use pyo3::prelude::*;

use super::environment::{ENGINES, Environment, environment};
use super::interpreter::ENVIRONMENT;
use super::package::{PACKAGE, package, text_of};
use super::pins::{LIST, installed, pins};
use crate::cache::{self, Memo};
use crate::engine::{Ending, Halt};

/// Files of the package: path below its folder, text.
const SOURCES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/sources.rs"));
static READY: Memo<()> = Memo::empty();

/// Makes a missing environment, starts Python and loads the package, once a process.
///
/// # Errors
/// The reason for the failure with the remedy; a stop.
pub fn ready(cancel: &AtomicBool) -> Result<(), Halt> {
    READY.get(|| load(&environment(ENGINES, cancel)?))
}

/// Returns the ending for an environment whose package cannot be loaded. The user has to repair an environment that was
/// `named`.
pub fn unusable(folder: &Path, named: bool, reason: &str) -> Halt {
    let folder = folder.display();
    let remedy = if named {
        format!(
            "run `pip install -r python/requirements.txt` in {folder}, or unset {ENVIRONMENT} to have one made"
        )
    } else {
        format!("remove {folder} to have it made anew")
    };
    let reason = format!("the Python package cannot be loaded: {reason}; {remedy}");
    Ending::Absent { reason }.into()
}

/// Starts Python on an environment and loads the package.
fn load(environment: &Environment) -> Result<(), Halt> {
    let files: Vec<(String, &str)> = SOURCES
        .iter()
        .map(|&(name, text)| (format!("{PACKAGE}/{name}"), text))
        .collect();
    let sources = cache::laid_out("sources", &files)?;
    let named = crate::env::variable(ENVIRONMENT).is_some();
    let failed = |reason: String| unusable(&environment.folder, named, &reason);
    Python::attach(|py| {
        let start = || -> PyResult<Result<(), String>> {
            let path = py.import("sys")?.getattr("path")?;
            // Paths are passed as text: the search path ignores path objects.
            path.call_method1("insert", (0, environment.packages.as_os_str()))?;
            path.call_method1("insert", (0, sources.as_os_str()))?;
            for (package, version) in pins(LIST) {
                let actual = installed(py, package)?;
                if actual != version {
                    return Ok(Err(format!(
                        "it has {package} {actual}, and recorded time series and limits belong to {version}"
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
