//! Ctrl-C and SIGTERM: the first stops the running engine, the second ends the program. Without a running engine the first
//! also ends the program if reading does not return.
//!
//! Both remove the unfinished output folder.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::failure::{Failure, STOPPED};

static CANCEL: AtomicBool = AtomicBool::new(false);
/// True if running work checks the flag.
static WATCHED: AtomicBool = AtomicBool::new(false);
/// Longest time for reading to notice the flag. Reading a pipe without a writer never does.
const PATIENCE: Duration = Duration::from_secs(1);
/// Draft of this process, removed by the second signal.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Returns the flag that engines check.
pub(crate) fn flag() -> &'static AtomicBool {
    &CANCEL
}

/// Records that running work checks the flag from now on.
pub(crate) fn watched() {
    WATCHED.store(true, Ordering::Relaxed);
}

/// Returns an error after a stop by the user.
pub(crate) fn check() -> Result<(), Failure> {
    if CANCEL.load(Ordering::Relaxed) {
        Err(Failure::stopped())
    } else {
        Ok(())
    }
}

/// Sets the folder to remove if the program is ended at once, or `None`.
pub(crate) fn unfinished(folder: Option<&Path>) {
    if let Ok(mut place) = UNFINISHED.lock() {
        *place = folder.map(Path::to_owned);
    }
}

/// Makes a file beyond `ulimit -f` an error of its write, like a full disk, instead of a fatal signal. Call before any
/// thread begins: threads inherit the setting, child programs do not.
pub(crate) fn outlive_limits() {
    #[cfg(unix)]
    {
        let signals: nix::sys::signal::SigSet = [nix::sys::signal::SIGXFSZ].into_iter().collect();
        // A wrong argument is the only possible error.
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
