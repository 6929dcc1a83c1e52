//! Tests of this crate as one program, because linking dominates the cost of a small test.

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
