//! Helpers of the whole-program tests.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use escargot::{CargoBuild, CargoRun};

/// The program `pinwheel`, built once per test binary with the tests' own profile and features.
///
/// # Panics
/// When it cannot be built.
#[must_use]
pub fn pinwheel() -> Command {
    static BUILT: OnceLock<CargoRun> = OnceLock::new();
    let built = BUILT.get_or_init(|| {
        let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/cli/Cargo.toml");
        let mut build = CargoBuild::new()
            .manifest_path(manifest)
            .bin("pinwheel")
            .current_release();
        if cfg!(feature = "crossval") {
            build = build.features("crossval");
        }
        match build.run() {
            Ok(built) => built,
            Err(error) => panic!("the program pinwheel does not build: {error}"),
        }
    });
    built.command()
}

/// How a finished program left.
#[derive(Debug)]
pub struct Outcome {
    /// Exit status; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Results.
    pub stdout: String,
    /// Errors and progress.
    pub stderr: String,
}

impl From<Output> for Outcome {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// Runs `pinwheel` in the folder `dir` to its end.
///
/// # Panics
/// When it cannot be built or started.
pub fn run_in<S: AsRef<OsStr>>(dir: &Path, args: impl IntoIterator<Item = S>) -> Outcome {
    match pinwheel()
        .current_dir(dir)
        .args(args)
        .stdin(Stdio::null())
        .output()
    {
        Ok(output) => output.into(),
        Err(error) => panic!("the program pinwheel does not start: {error}"),
    }
}

/// Names in a folder, sorted, hidden ones included; a test folder that cannot be read has none.
#[must_use]
pub fn names_in(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
