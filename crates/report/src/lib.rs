//! Reports on the results of studies: a self-contained HTML page, and text for terminals.
//!
//! ```text
//!  outcome of a study ─> pages (a file or folder a study) ─> study (tiles, facts, tables, charts) ─> one HTML file
//!                                                        └─> terminal (facts, tables)
//! ```
//!
//! [`study::render`] makes the page of any study. A page opens without a network, is readable without a script (every table
//! is plain HTML), and draws its time series with an embedded plotting library. Only [`pages`] depends on studies.

pub mod figure;
pub mod format;
pub mod pages;
pub mod sanitize;
pub mod script;
pub mod stack;
pub mod study;
pub mod table;
pub mod terminal;

/// Number of line colours in the style sheet (`--line-0` ...).
pub const COLOURS: usize = 16;
