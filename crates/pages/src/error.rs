//! Why there is no page.

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// Stopped while the motion was computed.
    #[error("stopped")]
    Cancelled,
    /// The page cannot be made.
    #[error("the page cannot be made: {0}")]
    Report(#[from] pinwheel_report::ReportError),
}
