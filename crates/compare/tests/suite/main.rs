//! The tests of this crate as one program: linking is most of what a small test costs.

mod common;
mod edges;
mod invariances;
mod orders;
mod shown;
mod uncertainty;
mod verdicts;
