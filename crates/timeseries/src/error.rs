//! Errors of time series.

use std::path::PathBuf;

/// Faults of building, reading or writing [`TimeSeries`](crate::TimeSeries).
#[derive(Debug, thiserror::Error)]
pub enum TimeSeriesError {
    /// A channel's length differs from the time column's.
    #[error("channel `{name}` has {got} values, the time column has {expected}")]
    Length {
        /// Channel name.
        name: String,
        /// Values given.
        got: usize,
        /// Values needed.
        expected: usize,
    },
    /// Two channels of one name.
    #[error("channel `{0}` appears twice")]
    Duplicate(String),
    /// Times are not strictly increasing and finite.
    #[error("time does not increase at row {row}: {before} s is followed by {after} s")]
    Time {
        /// Row number, the first data row being 1.
        row: usize,
        /// Time of the row before.
        before: f64,
        /// Time of this row.
        after: f64,
    },
    /// Cell without a number.
    #[error("row {row}, column `{column}`: `{text}` is not a number")]
    Cell {
        /// Row number, the first data row being 1.
        row: usize,
        /// Column name.
        column: String,
        /// Content of the cell.
        text: String,
    },
    /// File without a `time_s` column.
    #[error("no column `time_s`: the first row must name the columns")]
    NoTime,
    /// Malformed CSV.
    #[error("malformed CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}
