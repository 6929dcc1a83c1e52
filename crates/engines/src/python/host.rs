//! Interpreter that runs engines, with the package `pinwheel_engines` loaded.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::prelude::*;

use super::package::{package, text_of};
use super::pins::{LIST, installed, pins};
use crate::engine::{Ending, Halt};

/// True if Python imported this library; false if the program embeds Python.
static HERE: AtomicBool = AtomicBool::new(false);

/// Selects the interpreter that loaded this library, with its user's packages, for engines. Call at the start of an
/// extension module.
pub fn use_this_interpreter() {
    HERE.store(true, Ordering::Relaxed);
}

fn is_here() -> bool {
    HERE.load(Ordering::Relaxed) || cfg!(not(feature = "crossval"))
}

/// Prepares the interpreter for engines.
pub(super) fn ready(cancel: &AtomicBool) -> Result<(), Halt> {
    if is_here() {
        return Python::attach(|py| {
            let present = package(py);
            present.map_err(|error| Ending::absent(text_of(py, &error)))?;
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

/// True if engines of a package can run: an embedded interpreter installs missing packages, another may lack them. Recorded
/// time series and limits apply to one version, so other versions do not count. The answer is cached, because it takes a
/// millisecond.
pub(super) fn has(package: &str) -> bool {
    static PRESENT: OnceLock<Vec<&'static str>> = OnceLock::new();
    if !is_here() {
        return true;
    }
    if let Some(present) = PRESENT.get() {
        return present.contains(&package);
    }
    let present: Vec<&'static str> = Python::attach(|py| {
        let there =
            |package: &str, version: &str| installed(py, package).is_ok_and(|v| v == version);
        let present = pins(LIST).filter(|(package, version)| there(package, version));
        present.map(|(package, _)| package).collect()
    });
    let has = present.contains(&package);
    // No lock: two threads that both compute this could deadlock with the interpreter's lock.
    let _ = PRESENT.set(present);
    has
}
