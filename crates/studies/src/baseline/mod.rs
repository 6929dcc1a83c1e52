//! Baselines: accepted results of the solver, and changes since.
//!
//! A baseline has, for a fixed set of short scenes and solvers ([`scenes`]), exact [`Statistics`] of the results, their
//! errors against converged runs, and their cost in counts. [`check`] runs the set again. A changed result may be better,
//! so every change is reported twice, against the accepted result and as a change of the error. [`limits`] has every
//! threshold with its reason.

pub(crate) mod cases;
mod check;
mod file;
pub(crate) mod judge;
pub mod limits;
mod moved;
mod record;
mod runner;
mod snapshot;

use std::path::Path;

use cases::sets;
use pinwheel_engines::{Halt, by_name};
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_timeseries::Ending;
use serde::Serialize;

use crate::StudyError;
use crate::output::OutputError;
use crate::provenance::{Provenance, Summary};

pub use cases::{SceneCase, scenes};
pub use check::{Answer, CaseCheck, Check, check};
pub use file::{
    Acceptance, Baseline, CaseSnapshot, Converged, FILE, Made, QuantitySnapshot, SceneSnapshot,
};
pub use judge::{CostCheck, QuantityCheck, Verdict};
pub use record::{LeftOut, Record, record};
pub use runner::Costs;
use runner::Job;
pub use snapshot::{Quantity, Statistics};

/// Options for running the set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Contact loop.
    pub kernel: Kernel,
    /// Number of threads; results do not depend on it.
    pub threads: usize,
    /// Names of the selected scenes; empty: all.
    pub only: Vec<String>,
    /// Solvers that joined; they replace the native one, at the scenes' steps and tolerances.
    pub solvers: Vec<String>,
    /// True if the changed stage is located for cases with an increased error.
    pub stages: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            kernel: Kernel::Lanes,
            threads: 1,
            only: Vec::new(),
            solvers: Vec::new(),
            stages: true,
        }
    }
}

impl Options {
    /// Returns the selected scenes, in the order of the set.
    fn scenes(&self) -> Result<Vec<&'static SceneCase>, StudyError> {
        let known: Vec<&str> = scenes().iter().map(|case| case.name.as_str()).collect();
        let mut only = self.only.iter();
        if let Some(unknown) = only.find(|name| !known.contains(&name.as_str())) {
            return Err(StudyError::Input(format!(
                "no scene of the baselines is called `{unknown}`; there are {}",
                known.join(", ")
            )));
        }
        let wanted = |case: &&SceneCase| self.only.is_empty() || self.only.contains(&case.name);
        Ok(scenes().iter().filter(wanted).collect())
    }

    /// Returns the runs of a scene: by the native choices, or by the solvers that joined.
    fn planned<'a>(&'a self, case: &'static SceneCase) -> Result<Vec<Planned<'a>>, StudyError> {
        let names = match self.solvers.as_slice() {
            [] => &case.choices,
            _ => &self.solvers,
        };
        let plan = |name: &'a String| {
            let solver = self.solvers.contains(name).then(|| name.clone());
            let sets = if solver.is_some() { &[] } else { sets(name) };
            let scene = case.scene(sets)?;
            let engine = solver.as_ref().and_then(|name| by_name(name, &scene));
            let refused = engine.and_then(|engine| match engine.supports(&scene) {
                Err(Halt::Ended(Ending::Unsupported { reason })) => Some(reason),
                _ => None,
            });
            let job = Job {
                label: format!("{}, {name}", case.name),
                scene: scene.into_scene(),
                kernel: self.kernel,
                solver,
            };
            Ok(Planned {
                name,
                sets,
                refused,
                job,
            })
        };
        names.iter().map(plan).collect()
    }
}

/// Run of a scene of the set by a native choice or a solver that joined.
struct Planned<'a> {
    /// Name in the baseline.
    name: &'a str,
    /// Keys set by the choice.
    sets: &'static [String],
    /// Reason of a solver that refuses the scene.
    refused: Option<String>,
    /// Run to record or check.
    job: Job,
}

/// Describes this program, on this machine, today.
pub fn made(kernel: Kernel) -> Made {
    let here = Provenance::here("");
    Made {
        date: here.date,
        version: here.version.to_owned(),
        build: here.machine.build.to_owned(),
        vectors: kernel.vectors().to_owned(),
        processor: here.machine.processor,
    }
}

/// Content of `summary.json`.
#[derive(Serialize)]
struct Checked<'a> {
    answers: Vec<Answer>,
    accepted: &'a [Acceptance],
    check: &'a Check,
}

/// Writes `summary.json` of a check against the baseline `name` into the folder `dir`.
///
/// # Errors
/// The file cannot be written.
pub fn write(
    name: &str,
    check: &Check,
    baseline: &Baseline,
    dir: &Path,
    origin: &Provenance,
) -> Result<(), OutputError> {
    let accepted = &baseline.accepted;
    let answers = check.answers(name);
    let checked = Checked {
        answers,
        accepted,
        check,
    };
    Summary::new(origin, checked).write(dir)
}
