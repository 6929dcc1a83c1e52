//! The report: one self-contained HTML page.
//!
//! ```text
//!  Comparison, time_series ─> comparison ─┐
//!  any study's findings ─────────────>├─> study (tiles, tables, charts) ─> one HTML file, nothing outside it
//!  angles, forces      ─> animation ──┘
//! ```
//!
//! [`comparison::study`] makes the study of a comparison, [`study::render`] the page of any study. A page opens without a network, reads without a script (every table
//! is plain HTML), and draws its time series with an embedded plotting library.

pub mod animation;
mod chart_data;
pub mod colours;
pub mod comparison;
pub mod format;
mod packed;
pub mod sanitize;
pub mod stack;
pub mod study;
pub mod table;
pub mod terminal;
pub mod words;
