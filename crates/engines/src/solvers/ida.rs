//! SUNDIALS IDA: a Python program in an environment of its own.

use std::sync::atomic::AtomicBool;

use super::ready::{Missing, Ready};
use crate::cache;
use crate::python::{PythonError, Requirements, environment};

/// Its manifest.
pub(super) const MANIFEST: &str = "ida.toml";

/// What its folder holds.
static FILES: [(&str, &str); 2] = [
    ("ida.py", include_str!("../../../../solvers/ida/ida.py")),
    (MANIFEST, include_str!("../../../../solvers/ida/ida.toml")),
];

/// What it needs.
const REQUIREMENTS: Requirements = Requirements {
    name: "ida",
    file: "solvers/ida/requirements.txt",
    only_listed: false,
    text: include_str!("../../../../solvers/ida/requirements.txt"),
};

/// Name and pinned version of its package.
pub(super) fn version() -> String {
    const PACKAGE: &str = "scikit-sundae";
    let mut pins = include_str!("../../../../solvers/ida/requirements.in")
        .lines()
        .filter_map(|line| line.split_once("=="));
    let pinned = pins.find(|(package, _)| *package == PACKAGE);
    pinned.map_or_else(
        || PACKAGE.to_owned(),
        |(_, version)| format!("{PACKAGE} {version}"),
    )
}

/// Makes its environment if need be.
pub(super) fn ready(cancel: &AtomicBool) -> Result<Ready, Missing> {
    let found = environment(REQUIREMENTS, cancel).map_err(|error: PythonError| {
        if error.is_stop() {
            Missing::Stopped
        } else {
            Missing::Because(error.to_string())
        }
    })?;
    Ok(Ready {
        here: cache::laid_out("ida", &FILES)?,
        python: Some(found.python),
    })
}
