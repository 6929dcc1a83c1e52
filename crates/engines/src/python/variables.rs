//! Environment variables that the Python engines heed.

/// Names an existing environment, which is used as it is.
pub(super) const ENVIRONMENT: &str = "PINWHEEL_PYTHON_ENV";
/// Names a folder of wheels to install from, without a network.
pub(super) const WHEELS: &str = "PINWHEEL_WHEELS";
