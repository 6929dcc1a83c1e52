//! Environment variables.

use std::ffi::OsString;
use std::path::PathBuf;

/// Variable with a folder that replaces the user's cache folder.
pub(crate) const CACHE: &str = "PINWHEEL_CACHE";

/// Returns the value of an environment variable; `None` if it is empty.
pub(crate) fn variable(name: &str) -> Option<OsString> {
    std::env::var_os(name).filter(|value| !value.is_empty())
}

/// Returns the cache folder; `None` without a home folder.
pub(crate) fn cache() -> Option<PathBuf> {
    let own = || Some(dirs::cache_dir()?.join("pinwheel"));
    variable(CACHE).map(PathBuf::from).or_else(own)
}
