//! Contacts between wheels and sleeves.

mod field;

pub use field::{ContactField, PairContact};
