//! Tests of the crate.

mod page;
mod study;
