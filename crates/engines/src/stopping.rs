//! Stopping while engines are prepared: that can take minutes where packages are installed, and has no control of its
//! own.

use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Tells all preparations, now and later, that the user asked to stop: they end with
/// [`Cancelled`](crate::Cancelled). For a program's signal handler.
pub fn stop_preparing() {
    STOP.store(true, Ordering::Relaxed);
}

/// The flag that preparations watch.
#[cfg(feature = "python")]
pub(crate) fn flag() -> &'static AtomicBool {
    &STOP
}
