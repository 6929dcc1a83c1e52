//! Ctrl-C and SIGTERM: the first asks the running engine to stop, the second ends the program.
//!
//! Either way nothing half-written stays behind: the unfinished output folder is removed.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, STOPPED};

static CANCEL: AtomicBool = AtomicBool::new(false);
/// The folder being written, for the second signal.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// The flag engines watch.
pub(crate) fn flag() -> &'static AtomicBool {
    &CANCEL
}

/// Fails once the user asked to stop.
pub(crate) fn check() -> Result<(), Failure> {
    if CANCEL.load(Ordering::Relaxed) {
        Err(Failure::stopped())
    } else {
        Ok(())
    }
}

/// Names the folder to remove if the program is ended at once, or `None`.
pub(crate) fn unfinished(folder: Option<&Path>) {
    if let Ok(mut place) = UNFINISHED.lock() {
        *place = folder.map(Path::to_owned);
    }
}

/// Installs the handler.
pub(crate) fn install() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        pinwheel::engines::stop_preparing();
        if !CANCEL.swap(true, Ordering::Relaxed) {
            return;
        }
        pinwheel::engines::external::end_all();
        if let Ok(place) = UNFINISHED.lock()
            && let Some(folder) = place.as_deref()
        {
            let _ = std::fs::remove_dir_all(folder);
        }
        std::process::exit(i32::from(STOPPED));
    })
    .map_err(|error| Failure::input(format!("signals cannot be watched: {error}; try again")))
}
