//! `pinwheel._core`: compiled part of the Python package `pinwheel` (folder `python/`).
//!
//! The public interface is in Python. Rust reads and checks scenes, runs engines without the interpreter's lock, and
//! returns studies as JSON and time series as bytes for numpy.

mod design;
mod errors;
mod files;
mod guests;
mod law;
mod run;
mod scene;
mod studies;
mod supervise;
mod sweep;
mod time_series;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs a command line, which begins with the program's name, and returns the exit status; `interpreter` runs further processes
/// of the program. Call once a process.
#[pyfunction]
fn program(py: Python<'_>, words: Vec<OsString>, interpreter: OsString) -> u8 {
    pinwheel_cli::within(interpreter);
    py.detach(|| pinwheel_cli::main(words))
}

/// Compiled part of the package `pinwheel`.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::design::{Designed, design, fmu, gear};
    #[pymodule_export]
    use crate::files::write;
    #[pymodule_export]
    use crate::law::{Law, laws};
    #[pymodule_export]
    use crate::program;
    #[pymodule_export]
    use crate::run::{Ran, run};
    #[pymodule_export]
    use crate::scene::{Core, figures, key, keys, named, presets, schema};
    #[pymodule_export]
    use crate::studies::{Benched, Compared, bench, compare, engines, explain};
    #[pymodule_export]
    use crate::sweep::{Sweep, perform};
    #[pymodule_export]
    use crate::time_series::Columns;

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        pinwheel::engines::python::use_this_interpreter();
        Ok(())
    }
}
