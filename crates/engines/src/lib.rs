//! Engines behind one trait: the native solver and the peers it is checked against.

mod cards;
mod engine;
mod native;
#[cfg(feature = "crossval")]
pub mod python;
#[cfg(feature = "rapier")]
mod rapier;
pub mod recorded;
mod registry;
mod stopping;

pub use engine::{Control, Engine, EngineError, Prepared, Run, RunStats, Track};
pub use native::Native;
pub use registry::{by_name, registry};
pub use stopping::stop_preparing;
