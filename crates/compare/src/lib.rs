//! Metrics, limits and verdicts on courses of several engines.
//!
//! [`compare`] takes finished (and unfinished) runs on one sample grid and says, per pair of
//! engines, window and quantity, how far they are apart, which limit applies and whether it holds.
//! No engine is called the truth: every judged metric is free of direction.
//! It works on any courses; what only a gearbox has (load, efficiency) is optional.

mod compare;
pub mod comparison;
mod error;
mod grid;
mod judge;
pub mod limits;
mod matrix;
pub mod metrics;
mod participant;
pub mod quantities;
pub mod sprague_geers;
pub mod statistics;
pub mod verdict;
pub mod windows;

pub use compare::{compare, compare_stated};
pub use comparison::Comparison;
pub use error::CompareError;
pub use limits::{Limit, Metric, StatedLimit};
pub use participant::{Context, Cost, Divergence, Energy, Participant, Status, track};
pub use quantities::Quantity;
pub use verdict::{Check, Counts, Verdict};
pub use windows::{Window, WindowKind};
