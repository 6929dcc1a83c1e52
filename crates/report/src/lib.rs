//! The report: one self-contained HTML page.
//!
//! ```text
//!  Comparison, time_series ─> comparison ─┐
//!  any study's findings ─────────────>├─> study (tiles, tables, charts) ─> one HTML file, nothing outside it
//!  angles, forces      ─> animation ──┘
//! ```
//!
//! [`render`] fills in the page of a comparison, [`study::render`] that of any other study. A page opens without a network, reads without a script (every table
//! is plain HTML), and draws its time series with an embedded plotting library.

pub mod animation;
mod chart_data;
pub mod colours;
mod comparison;
mod error;
pub mod format;
mod input;
mod packed;
pub mod sanitize;
pub mod study;
pub mod table;
pub mod terminal;
pub mod words;

pub use error::ReportError;
pub use input::ReportInput;

/// Fills in the page.
///
/// The page depends on the input alone: the same input gives the same bytes.
///
/// # Errors
/// The comparison and the participants do not belong together, or (never in practice) the charts' data cannot be written.
pub fn render(input: &ReportInput<'_>) -> Result<String, ReportError> {
    study::render(&comparison::study(input)?)
}
