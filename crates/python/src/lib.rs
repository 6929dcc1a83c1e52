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
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    pinwheel::engines::python::use_this_interpreter();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Core>()?;
    module.add_class::<time_series::Columns>()?;
    module.add_class::<law::Law>()?;
    module.add_class::<run::Ran>()?;
    module.add_class::<studies::Compared>()?;
    module.add_class::<studies::Benched>()?;
    module.add_class::<sweep::Sweep>()?;
    module.add_class::<design::Designed>()?;
    for function in [
        wrap_pyfunction!(scene::key, module)?,
        wrap_pyfunction!(scene::keys, module)?,
        wrap_pyfunction!(scene::presets, module)?,
        wrap_pyfunction!(law::laws, module)?,
        wrap_pyfunction!(run::run, module)?,
        wrap_pyfunction!(studies::compare, module)?,
        wrap_pyfunction!(studies::bench, module)?,
        wrap_pyfunction!(studies::explain, module)?,
        wrap_pyfunction!(studies::engines, module)?,
        wrap_pyfunction!(sweep::perform, module)?,
        wrap_pyfunction!(scene::schema, module)?,
        wrap_pyfunction!(design::gear, module)?,
        wrap_pyfunction!(design::design, module)?,
        wrap_pyfunction!(design::fmu, module)?,
        wrap_pyfunction!(files::write, module)?,
        wrap_pyfunction!(program, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
