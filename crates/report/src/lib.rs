//! The report: one self-contained HTML page.
//!
//! [`render`] fills it in. The page opens without a network, reads without a script (every table
//! is plain HTML), and draws its courses with an embedded plotting library.

mod chart_data;
mod error;
mod format;
mod input;
mod view;

pub use error::ReportError;
pub use input::{Fact, ReportInput};

use askama::Template;

/// Fills in the page.
///
/// The page depends on the input alone: the same input gives the same bytes.
///
/// # Errors
/// The comparison and the participants do not belong together, or (never in practice) the
/// template or the charts' data cannot be written.
pub fn render(input: &ReportInput<'_>) -> Result<String, ReportError> {
    Ok(view::Page::of(input)?.render()?)
}
