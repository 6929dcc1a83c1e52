//! Engines behind one trait.

mod engine;

pub use engine::{Control, Engine, EngineError, Run, RunStats, Track};
