//! With `crossval`, tells examples and tests where libpython is.

fn main() {
    #[cfg(feature = "crossval")]
    pyo3_build_config::add_libpython_rpath_link_args();
}
