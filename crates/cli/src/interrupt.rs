//! Ctrl-C and SIGTERM: the first asks the running engine to stop, the second ends the program; so does the first while
//! nothing runs and what is read does not come.
//!
//! Either way nothing half-written stays behind: the unfinished output folder is removed.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::failure::{Failure, STOPPED};

static CANCEL: AtomicBool = AtomicBool::new(false);
/// True if something runs that looks at the flag.
static WATCHED: AtomicBool = AtomicBool::new(false);
/// Longest time in which reading may notice the flag by itself. A pipe that nobody writes to never does.
const PATIENCE: Duration = Duration::from_secs(1);
/// The draft being written, for the second signal: this process made it, and nobody else enters it.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// The flag engines watch.
pub(crate) fn flag() -> &'static AtomicBool {
    &CANCEL
}

/// Records that running work checks the flag from now on.
pub(crate) fn watched() {
    WATCHED.store(true, Ordering::Relaxed);
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

/// A file that grows beyond `ulimit -f` is an error of its write, as a full disk is, and no signal that kills. Before any thread
/// begins, as threads take it over; programs that are started do not.
pub(crate) fn outlive_limits() {
    #[cfg(unix)]
    {
        let signals: nix::sys::signal::SigSet = [nix::sys::signal::SIGXFSZ].into_iter().collect();
        // There is no other error than a wrong argument.
        let _ = signals.thread_block();
    }
}

/// Installs the handler.
pub(crate) fn install() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        pinwheel::engines::stop_preparing();
        if !CANCEL.swap(true, Ordering::Relaxed) {
            if !WATCHED.load(Ordering::Relaxed) {
                std::thread::sleep(PATIENCE);
            }
            if WATCHED.load(Ordering::Relaxed) {
                return;
            }
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
