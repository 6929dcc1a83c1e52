//! Facts of this project's engines, in this build or not. A new engine is a static in its family's file, and an entry in
//! [`registry`](mod@crate::registry).

mod model;
pub(crate) mod native;
pub(crate) mod python;
pub(crate) mod rapier;
pub(crate) mod solvers;

use crate::info::EngineInfo;

/// Returns the facts of all engines of this project, in this build or not.
pub fn known() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    let families = [native::ALL, rapier::ALL, python::ALL, solvers::ALL];
    families.into_iter().flatten().copied()
}

/// Returns the facts of an engine by name; `None` for users' engines.
pub fn info(name: &str) -> Option<&'static EngineInfo<'static>> {
    known().find(|info| info.name == name)
}
