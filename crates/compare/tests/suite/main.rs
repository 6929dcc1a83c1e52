//! The tests of this crate as one program: linking is most of what a small test costs.

mod common;
mod edges;
mod invariances;
mod limits;
mod metrics;
mod model;
mod orders;
mod quantities;
mod shown;
mod sprague_geers;
mod uncertainty;
mod validation;
mod verdicts;
mod windows;
