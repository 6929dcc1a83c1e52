//! The report: one self-contained HTML page.
//!
//! [`render`] fills it in. The page opens without a network, reads without a script (every table
//! is plain HTML), and draws its courses with an embedded plotting library.

mod error;
mod input;

pub use error::ReportError;
pub use input::{Fact, ReportInput};
