//! SUNDIALS IDA: a Python program in its own environment.

use std::sync::atomic::AtomicBool;

use super::ready::Ready;
use crate::cache;
use crate::engine::Halt;
use crate::python::{Requirements, environment, pinned};

/// Manifest of the solver.
pub(super) const MANIFEST: &str = "ida.toml";

/// Files of the solver's folder.
static FILES: [(&str, &str); 2] = [
    (
        "ida.py",
        include_str!(concat!(env!("PINWHEEL_SHIPPED"), "/solvers/ida/ida.py")),
    ),
    (
        MANIFEST,
        include_str!(concat!(env!("PINWHEEL_SHIPPED"), "/solvers/ida/ida.toml")),
    ),
];

/// Packages that the solver needs.
pub(super) const REQUIREMENTS: Requirements = Requirements {
    name: "ida",
    file: "solvers/ida/requirements.txt",
    only_listed: false,
    text: include_str!(concat!(
        env!("PINWHEEL_SHIPPED"),
        "/solvers/ida/requirements.txt"
    )),
};

/// Returns name and pinned version of its package.
pub(super) fn version() -> String {
    let list = include_str!(concat!(
        env!("PINWHEEL_SHIPPED"),
        "/solvers/ida/requirements.in"
    ));
    pinned(list, "scikit-sundae")
}

/// Makes the Python environment if it is missing.
pub(super) fn ready(cancel: &AtomicBool) -> Result<Ready, Halt> {
    let venv = environment(REQUIREMENTS, cancel)?;
    Ok(Ready {
        here: cache::laid_out("ida", &FILES)?,
        python: Some(venv.python),
    })
}
