//! Engines in Python: exudyn and MuJoCo as peers, and solvers of users.
//!
//! The package `pinwheel_engines` (folder `python/`) has the adapters; this module has their host and the boundary to the
//! contact law. The interpreter is embedded with its own environment, or the one that imported this library. Calls of the
//! law are compiled: no Python runs per step in MuJoCo, one user function per stage in exudyn.

mod agreement;
mod convert;
#[cfg(feature = "crossval")]
#[doc(hidden)] // for tests
pub mod embedded;
mod engine;
#[cfg(feature = "crossval")]
#[doc(hidden)] // for tests
pub mod environment;
#[doc(hidden)] // for tests
pub mod ffi;
mod host;
#[cfg(feature = "crossval")]
#[doc(hidden)] // for tests
pub mod interpreter;
#[doc(hidden)] // for tests
pub mod law;
#[doc(hidden)] // for tests
pub mod mujoco;
mod package;
mod pins;
#[doc(hidden)] // for tests
pub mod published;
mod user_engine;
mod watch;

pub use agreement::{Agreement, law_agreement};
#[cfg(feature = "crossval")]
pub use environment::{ENGINES, Environment, Requirements, environment};
pub use host::use_this_interpreter;
#[cfg(feature = "crossval")]
pub(crate) use pins::pinned;
#[cfg(not(feature = "crossval"))]
pub(crate) use pins::requirement;
pub use user_engine::UserEngine;

use crate::engine::Engine;
use crate::info::EngineInfo;
use engine::PythonEngine;

/// Returns an engine of the package `pinwheel_engines`; `None` if the importing interpreter lacks its packages.
pub(crate) fn engine(info: &'static EngineInfo<'static>) -> Option<Box<dyn Engine>> {
    host::has(info.package).then(|| Box::new(PythonEngine(info)) as Box<dyn Engine>)
}
