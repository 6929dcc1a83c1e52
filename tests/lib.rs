//! Helpers of the tests of the program: paths, the program, and its runs.

pub mod runs;
pub mod served;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Returns a path in the repository.
#[must_use]
pub fn repository(path: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(path)
}

/// Returns a command that runs the program `pinwheel` with the tests' own profile and features.
///
/// Cargo builds it before it runs a test of its package and puts it one folder above that test.
///
/// # Panics
/// Panics if the program is absent: the calling test belongs to another package.
#[must_use]
pub fn pinwheel() -> Command {
    let name = format!("pinwheel{}", std::env::consts::EXE_SUFFIX);
    let program = std::env::current_exe()
        .ok()
        .and_then(|test| Some(test.parent()?.parent()?.join(name)))
        .filter(|program| program.is_file());
    match program {
        // Each test sets storage of runs and its folder.
        Some(program) => {
            let mut command = Command::new(program);
            command
                .env("PINWHEEL_RUNS", "")
                .env_remove("GITHUB_ACTIONS"); // no annotations on stderr
            command
        }
        None => panic!(
            "no program beside this test: list the test in the manifest of the package pinwheel"
        ),
    }
}

/// Splits a command into its words.
#[must_use]
pub fn words(typed: &str) -> Vec<&str> {
    typed.split_whitespace().collect()
}

/// Result of a finished program.
#[derive(Debug)]
pub struct Outcome {
    /// Exit status; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Standard output: results.
    pub stdout: String,
    /// Standard error: errors and progress.
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
/// If the program cannot be built or started.
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

/// Returns the names in a folder, sorted, with hidden ones but without the marker of outputs; empty if the folder cannot be read.
#[must_use]
pub fn names_in(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name != ".pinwheel")
        .collect();
    names.sort();
    names
}
