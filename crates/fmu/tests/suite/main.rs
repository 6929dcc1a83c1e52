//! Tests of units, of their C interface and of their packages.

use std::path::PathBuf;

mod ffi;
mod package;
mod unit;

/// Returns the path of `libpinwheel_fmu` of this build, beside the tests.
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
