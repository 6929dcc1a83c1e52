//! Facts of the engines of this project, whether a build has them or not. A new engine is a static here, a line of
//! [`KNOWN`], and what its family makes of it ([`registry`](mod@crate::registry)).

mod model;
pub(crate) mod native;
pub(crate) mod python;
pub(crate) mod rapier;
pub(crate) mod solvers;

use crate::info::EngineInfo;

/// All engines, in the order of reports.
static KNOWN: [&EngineInfo<'static>; 13] = [
    &native::REDUCED,
    &native::LAGRANGE,
    &native::RESOLVED,
    &rapier::SHARED_LAW,
    &rapier::HOOK,
    &rapier::COLLIDERS,
    &python::MUJOCO_SHARED_LAW,
    &python::EXUDYN_EXPLICIT,
    &python::EXUDYN_CONSTRAINED,
    &python::MUJOCO_OWN_CONTACT,
    &python::EXUDYN_OWN_CONTACT,
    &solvers::SIMBODY,
    &solvers::IDA,
];

/// Returns the facts of all engines of this project, in this build or another.
pub fn known() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    KNOWN.into_iter()
}

/// Returns the facts of the engine of a name; `None` for users' engines.
#[must_use]
pub fn info(name: &str) -> Option<&'static EngineInfo<'static>> {
    known().find(|info| info.name == name)
}
