//! Stop of the preparation of engines, which may take minutes if packages are installed, and has no control.

use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Ends all present and later preparations with [`Cancelled`](crate::Cancelled), for a program's signal handler.
pub fn stop_preparing() {
    STOP.store(true, Ordering::Relaxed);
}

/// Returns the stop flag for preparations.
#[cfg(feature = "python")]
pub(crate) fn flag() -> &'static AtomicBool {
    &STOP
}
