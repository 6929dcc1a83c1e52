//! The report: one self-contained HTML page, and text for terminals.
//!
//! ```text
//!  findings of any study ─> study (tiles, facts, tables, charts) ─> one HTML file, nothing outside it
//!                       └─> terminal (facts, tables)
//! ```
//!
//! [`study::render`] makes the page of any study. A page opens without a network, reads without a script (every table
//! is plain HTML), and draws its time series with an embedded plotting library. No study and no engine is known here.

pub mod figure;
pub mod format;
pub mod sanitize;
pub mod script;
pub mod stack;
pub mod study;
pub mod table;
pub mod terminal;

/// Colours of lines in the style sheet (`--line-0` ...).
pub const COLOURS: usize = 16;
