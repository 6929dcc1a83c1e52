//! Tests of units: by themselves, as importers call them, and as they are written.

use std::path::PathBuf;

mod ffi;
mod package;
mod unit;

/// `libpinwheel_fmu` of this build, beside the tests.
fn library() -> PathBuf {
    let name = format!(
        "{}pinwheel_fmu{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    let here = std::env::current_exe().expect("this test");
    let library = here.parent().expect("its folder").join(name);
    assert!(library.is_file(), "{} is not there", library.display());
    library
}
