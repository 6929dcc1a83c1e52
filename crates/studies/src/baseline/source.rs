//! What makes a record: date, commit, program, machine.

use std::path::Path;
use std::process::{Command, Stdio};

use pinwheel_gearbox::contacts::Kernel;

use super::{Made, no_instructions};
use crate::provenance::Provenance;

/// This program, on this machine, today; the commit is that of the repository that holds `dir`.
#[must_use]
pub fn made(dir: &Path) -> Made {
    let here = Provenance::here("");
    Made {
        date: here.date,
        commit: commit(dir),
        version: here.version.to_owned(),
        build: here.machine.build.to_owned(),
        vectors: Kernel::Lanes.vectors().to_owned(),
        processor: here.machine.processor,
        no_instructions: no_instructions(),
    }
}

/// The commit at which the sources stand, `+changes` if they were changed since; `unknown` without git.
fn commit(dir: &Path) -> String {
    let place = dir
        .ancestors()
        .find(|part| part.is_dir())
        .unwrap_or(Path::new("."));
    let git = |words: &[&str]| -> Option<String> {
        let output = Command::new("git")
            .current_dir(place)
            .args(words)
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output()
            .ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) else {
        return "unknown".to_owned();
    };
    // The baselines themselves are no part of what made them.
    let changed = git(&[
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
        ":/crates",
        ":/Cargo.lock",
    ]);
    match changed {
        Some(changes) if changes.is_empty() => commit,
        _ => format!("{commit}+changes"),
    }
}
