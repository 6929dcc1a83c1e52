//! `pinwheel._core`: what the Python package `pinwheel` (folder `python/`) is built on.
//!
//! Python holds what users see; here is what must be Rust: scenes are read and checked, engines run with the interpreter's
//! lock released, studies give their data as JSON and their time series as bytes that numpy takes as they are.

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

/// Carries out a command line, whose first word is the program's name, and returns the exit status. Once in a process.
#[pyfunction]
fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| pinwheel_cli::main(words))
}

/// Rust side of the package `pinwheel`; see there.
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
