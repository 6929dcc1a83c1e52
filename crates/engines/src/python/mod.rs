//! exudyn and MuJoCo as peers, in an embedded Python.
//!
//! The package `pinwheel_engines` (folder `python/`, embedded in the program) holds the adapters;
//! here are its host, its environment and the border over which our contact law reaches them. The
//! law crosses compiled: no Python runs per step in MuJoCo, one user function per stage in exudyn.

mod agreement;
mod border;
mod convert;
mod engine;
mod environment;
mod error;
mod host;
mod law;
mod mujoco;
#[cfg(feature = "provoke")]
pub mod provoke;
mod published;
mod watch;

pub use crate::cache::CacheError;
pub use agreement::{Agreement, law_agreement};
pub use environment::{Environment, Requirements, environment};
pub use error::PythonError;

use crate::cards::CARDS;
use crate::engine::Engine;
use engine::PythonEngine;

/// All Python engines.
pub(crate) fn engines() -> Vec<Box<dyn Engine>> {
    CARDS
        .iter()
        .map(|card| Box::new(PythonEngine(card)) as Box<dyn Engine>)
        .collect()
}
