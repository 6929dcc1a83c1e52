//! Studies: each takes data, gives data, and prints nothing.
//!
//! ```text
//!  scene, engines, files ──> run(input, control) ──> Outcome ──> write(folder)   CSV, JSON
//!                                  │                    └──────> pages           HTML, terminal
//!                       progress, Ctrl-C, threads
//! ```
//!
//! [`single::run`] runs one scene on one engine, [`comparison::run`] on several and compares them, [`sweep`] runs a
//! scene with lists and ranges of its keys, [`paper::run`] computes the paper's figures again, [`baseline::check`]
//! says what a change of the solver moved, [`bench::run`] what accuracy costs. A [`Control`] stops them and sees
//! their progress; `write` of an outcome keeps it as files in a folder, with a [`Provenance`].
//!
//! [`survey::Survey`] studies what the native solver does on scenes that are hard on integrators, on several threads, and goes on where it was stopped. Alone,
//! [`stability::run`] gives the atlas of all hard scenes, formulations and integrators;
//! [`divergence::horizon`] how long two runs that differ by a rounding stay together;
//! [`drift::measure`] what long runs do to joints, phases and forces; [`published::run`] which of the
//! published model's choices make it fail at high damping; [`resolution::check`] whether a run's step resolves its
//! scene; [`precision::run`] what every engine's accuracy costs. All results serialise.

pub mod baseline;
pub mod bench;
pub mod choice;
pub mod comparison;
pub mod conformance;
mod control;
pub mod divergence;
pub mod drift;
mod error;
pub mod explained;
pub mod folder;
pub mod junit;
mod measure;
pub mod output;
pub mod ownership;
pub mod paper;
mod pool;
pub mod precision;
pub mod provenance;
pub mod published;
pub mod recording;
pub mod resolution;
pub mod single;
pub mod stability;
pub mod survey;
pub mod sweep;

pub use control::{Control, Progress};
pub use error::StudyError;
pub use measure::{Difference, Level, difference, level};
pub use provenance::Provenance;
