//! The interpreter that engines run in, with the package `pinwheel_engines` loaded.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::prelude::*;

use super::package::{package, text_of};
use super::pins::{LIST, installed, pins};
use crate::engine::{Ending, Halt};

/// Set when Python has imported us and not we Python.
static HERE: AtomicBool = AtomicBool::new(false);

/// Engines run in the interpreter that has loaded this library, with what its user has installed. For an extension
/// module, at its start.
pub fn use_this_interpreter() {
    HERE.store(true, Ordering::Relaxed);
}

fn is_here() -> bool {
    HERE.load(Ordering::Relaxed) || cfg!(not(feature = "crossval"))
}

/// Makes the interpreter ready to run engines.
pub(super) fn ready(cancel: &AtomicBool) -> Result<(), Halt> {
    if is_here() {
        return Python::attach(|py| {
            let found = package(py);
            found.map_err(|error| Ending::absent(text_of(py, &error)))?;
            Ok(())
        });
    }
    #[cfg(feature = "crossval")]
    return super::embedded::ready(cancel);
    #[cfg(not(feature = "crossval"))]
    {
        let _ = cancel;
        Ok(())
    }
}

/// True if an engine of a package can run: an embedded interpreter gets the packages that it lacks, another has them or
/// not. Recorded time series and limits belong to one version, so another one does not count. The answer is kept,
/// because it takes a millisecond.
pub(super) fn has(package: &str) -> bool {
    static FOUND: OnceLock<Vec<&'static str>> = OnceLock::new();
    if !is_here() {
        return true;
    }
    if let Some(found) = FOUND.get() {
        return found.contains(&package);
    }
    let found: Vec<&'static str> = Python::attach(|py| {
        let there =
            |package: &str, version: &str| installed(py, package).is_ok_and(|v| v == version);
        let found = pins(LIST).filter(|(package, version)| there(package, version));
        found.map(|(package, _)| package).collect()
    });
    let has = found.contains(&package);
    // Two threads may both ask; waiting for one another with the interpreter's lock they might wait for ever.
    let _ = FOUND.set(found);
    has
}
