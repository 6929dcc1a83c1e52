//! Engines that live in Python: exudyn and MuJoCo as peers, and solvers that users write.
//!
//! The package `pinwheel_engines` (folder `python/`) holds the adapters; here are its host and the border over which our
//! contact law reaches them. The interpreter is one that the program embeds, with an environment that it makes, or the
//! one that has imported us. The
//! law crosses compiled: no Python runs per step in MuJoCo, one user function per stage in exudyn.

mod agreement;
mod border;
mod convert;
#[cfg(feature = "crossval")]
mod embedded;
mod engine;
#[cfg(feature = "crossval")]
mod environment;
#[cfg(feature = "crossval")]
mod error;
mod guest;
mod host;
#[cfg(feature = "crossval")]
mod interpreter;
mod law;
mod mujoco;
#[cfg(feature = "provoke")]
pub mod provoke;
mod published;
#[cfg(feature = "crossval")]
mod variables;
mod watch;

#[cfg(feature = "crossval")]
pub use crate::cache::CacheError;
pub use agreement::{Agreement, law_agreement};
#[cfg(feature = "crossval")]
pub use environment::{ENGINES, Environment, Requirements, environment};
#[cfg(feature = "crossval")]
pub use error::PythonError;
pub use guest::Guest;
pub use host::use_this_interpreter;

use crate::cards::CARDS;
use crate::engine::Engine;
use engine::PythonEngine;
pub(crate) use host::has;

/// All Python engines; in an interpreter that is not ours those whose packages it has.
pub(crate) fn engines() -> Vec<Box<dyn Engine>> {
    CARDS
        .iter()
        .filter(|card| has(card))
        .map(|card| Box::new(PythonEngine(card)) as Box<dyn Engine>)
        .collect()
}
