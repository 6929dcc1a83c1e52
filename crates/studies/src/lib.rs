//! Studies of the native solver.

mod measure;

pub use measure::{Difference, difference};
