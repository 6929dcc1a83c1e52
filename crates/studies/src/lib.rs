//! Studies of the native solver: what it does on scenes that are hard on integrators.
//!
//! [`survey::Survey`] does all of it, on several threads, and goes on where it was stopped. Alone,
//! [`stability::run`] gives the atlas of all hard scenes, formulations and integrators;
//! [`divergence::horizon`] how long two runs that differ by a rounding stay together;
//! [`drift::measure`] what long runs do to joints, phases and forces; [`published::run`] which of the
//! published model's choices make it fail at high damping; [`resolution::check`] whether a run's step resolves its
//! scene; [`precision::run`] what every engine's accuracy costs. All results serialise.

pub mod baseline;
mod control;
pub mod divergence;
pub mod drift;
mod error;
mod measure;
pub mod paper;
pub mod precision;
pub mod published;
pub mod resolution;
pub mod stability;
pub mod survey;

pub use control::{Control, Progress};
pub use error::StudyError;
pub use measure::{Difference, Level, difference, level};
