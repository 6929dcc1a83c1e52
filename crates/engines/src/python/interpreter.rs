//! Embedded interpreter and possible paths of its executable.

use std::path::PathBuf;

use pyo3::prelude::*;

use super::package::text_of;
use crate::engine::{Ending, Halt};

/// Variable with an existing environment, used unchanged.
pub const ENVIRONMENT: &str = "PINWHEEL_PYTHON_ENV";

/// Interpreter whose library this program embeds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interpreter {
    /// Version, e.g. `3.11.7`.
    pub version: String,
    /// Possible paths of the executable, most likely first.
    pub candidates: Vec<PathBuf>,
}

/// Returns the interpreter that this process embeds.
pub fn interpreter() -> Result<Interpreter, Halt> {
    if let Some(home) = crate::env::variable("PYTHONHOME") {
        return Err(Ending::absent(format!(
            "PYTHONHOME = {home:?} would send the embedded Python to another installation; unset PYTHONHOME"
        ))
        .into());
    }
    let asked = Python::attach(|py| -> PyResult<Interpreter> {
        let sys = py.import("sys")?;
        let (major, minor, micro): (u8, u8, u8) = sys
            .getattr("version_info")?
            .get_item(pyo3::types::PySlice::new(py, 0, 3, 1))?
            .extract()?;
        let folder = py
            .import("sysconfig")?
            .call_method1("get_config_var", ("BINDIR",))?
            .extract::<Option<PathBuf>>()?;
        let prefix: PathBuf = sys.getattr("base_exec_prefix")?.extract()?;
        let names = [
            format!("python{major}.{minor}"),
            "python3".to_owned(),
            "python.exe".to_owned(),
        ];
        let folders = folder.into_iter().chain([prefix.join("bin"), prefix]);
        let mut candidates: Vec<PathBuf> = folders
            .flat_map(|folder| names.each_ref().map(|name| folder.join(name)))
            .chain([PathBuf::from(env!("PINWHEEL_PYTHON_AT_BUILD"))])
            .filter(|path| path.is_file())
            .collect();
        candidates.dedup();
        Ok(Interpreter {
            version: format!("{major}.{minor}.{micro}"),
            candidates,
        })
    });
    asked.map_err(|error| no_interpreter("3", &Python::attach(|py| text_of(py, &error))))
}

/// Returns the ending of a run without an interpreter of that version.
pub fn no_interpreter(version: &str, tried: &str) -> Halt {
    Ending::absent(format!(
        "no Python {version} interpreter was found to make an environment with (tried {tried}); install it, or name an \
         environment of that version with {ENVIRONMENT}"
    ))
    .into()
}
