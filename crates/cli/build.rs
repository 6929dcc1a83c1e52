//! With `crossval`, sets the run-time path to libpython.

fn main() {
    #[cfg(feature = "crossval")]
    pyo3_build_config::add_libpython_rpath_link_args();
}
