//! What can go wrong while a page is made.

/// Faults of [`render`](crate::render).
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The data for the charts cannot be written.
    #[error("the charts' data cannot be written: {0}")]
    Data(#[from] serde_json::Error),
    /// The comparison names an engine without time series.
    #[error(
        "the comparison names `{0}`, which is not among the participants: pass the same list to both"
    )]
    UnknownEngine(String),
}
