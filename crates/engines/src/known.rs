//! Facts of the engines of this project, whether a build has them or not. A new engine is a static of its
//! family, and what [`registry`](mod@crate::registry) makes of it.

mod model;
pub(crate) mod native;
pub(crate) mod python;
pub(crate) mod rapier;
pub(crate) mod solvers;

use crate::info::EngineInfo;

/// Returns the facts of all engines of this project, in this build or another.
pub fn known() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    let families = [native::ALL, rapier::ALL, python::ALL, solvers::ALL];
    families.into_iter().flatten().copied()
}

/// Returns the facts of the engine of a name; `None` for users' engines.
#[must_use]
pub fn info(name: &str) -> Option<&'static EngineInfo<'static>> {
    known().find(|info| info.name == name)
}
