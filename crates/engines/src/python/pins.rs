//! Pinned packages of the Python engines, from the list of requested ones.

use pyo3::prelude::*;

/// List of requested packages.
pub(super) const LIST: &str =
    include_str!(concat!(env!("PINWHEEL_SHIPPED"), "/python/requirements.in"));

/// Returns packages and versions of a list.
pub(super) fn pins(list: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let pins = list.lines().filter_map(|line| line.split_once("=="));
    pins.filter(|(package, _)| !package.starts_with('#'))
}

/// Returns name and version of a package in a list.
pub(crate) fn pinned(list: &'static str, package: &str) -> String {
    let name = package.trim_end_matches("-core");
    let pin = pins(list).find(|(pinned, _)| *pinned == package);
    pin.map_or_else(
        || name.to_owned(),
        |(_, version)| format!("{name} {version}"),
    )
}

/// Returns a package with its version for pip; `None` if no engine of Pinwheel needs it.
#[cfg(not(feature = "crossval"))]
pub(crate) fn requirement(package: &str) -> Option<String> {
    let pin = pins(LIST).find(|(pinned, _)| *pinned == package);
    pin.map(|(package, version)| format!("{package}=={version}"))
}

/// Returns the version of an installed package.
pub(super) fn installed(py: Python<'_>, package: &str) -> PyResult<String> {
    let metadata = py.import("importlib.metadata")?;
    metadata.call_method1("version", (package,))?.extract()
}
