//! Baselines: what the solver gave when somebody last looked and accepted it, and what moved since.
//!
//! A baseline holds, for a fixed set of short scenes and solvers ([`SCENES`]), the results (exact summaries,
//! and courses to five digits), their errors against converged runs, and what they cost in counts. [`check`]
//! runs the set again: a result may move and be better, so every change is told twice, against the
//! accepted result and as the change of the error. [`limits`] has every threshold with its reason.

mod cases;
mod check;
mod common;
mod error;
mod file;
mod instructions;
mod judge;
pub mod limits;
mod place;
mod quantised;
pub mod quantity;
mod record;
mod reference;
mod runner;
mod same;
mod source;
pub mod table;
mod write;
mod yardstick;

use cases::Way;
use pinwheel_courses::Ending;
use pinwheel_engines::{Halt, by_name};
use pinwheel_gearbox::contacts::Kernel;

use crate::StudyError;

pub use cases::{Choice, SCENES, SceneCase};
pub use check::{CaseCheck, Check, check};
pub use common::in_common;
pub use error::BaselineError;
pub use file::{
    Acceptance, Baseline, CaseQuantity, CaseRecord, HEAD, Head, Listed, Made, SceneRecord,
};
pub use judge::{CostCheck, Overlay, QuantityCheck, Verdict};
pub use place::Place;
pub use record::record;
pub use runner::Costs;
pub use same::{Fingerprint, Spread, across_loops, fingerprints};
pub use source::made;
pub use write::write;

/// How the set is run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Contact loop.
    pub kernel: Kernel,
    /// Threads; the results do not depend on their number.
    pub threads: usize,
    /// Times each run is repeated for its time; 0: no times.
    pub repeats: usize,
    /// Names of scenes; empty: all.
    pub only: Vec<String>,
    /// Whether the time over all cases decides, too.
    pub judge_time: bool,
    /// Solvers that joined; with any, they are run instead of our own, at the scenes' steps and tolerances.
    pub solvers: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            kernel: Kernel::Lanes,
            threads: 1,
            repeats: 0,
            only: Vec::new(),
            judge_time: false,
            solvers: Vec::new(),
        }
    }
}

impl Options {
    /// The scenes asked for, in the order of the set.
    fn scenes(&self) -> Result<Vec<&'static SceneCase>, BaselineError> {
        if let Some(unknown) = self
            .only
            .iter()
            .find(|name| !SCENES.iter().any(|case| case.name == *name))
        {
            return Err(BaselineError::NoScene(unknown.clone()));
        }
        let wanted = |case: &&SceneCase| {
            self.only.is_empty() || self.only.iter().any(|name| name == case.name)
        };
        Ok(SCENES.iter().filter(wanted).collect())
    }

    /// By which a scene of the set is run: our choices, or the solvers that honour it.
    fn ways<'a>(&'a self, case: &SceneCase) -> Result<Vec<Way<'a>>, BaselineError> {
        if self.solvers.is_empty() {
            return Ok(case.choices.iter().map(Way::from).collect());
        }
        let scene = case.scene(&[]).map_err(StudyError::from)?;
        let honours = |name: &&String| {
            by_name(name, &scene).is_some_and(|engine| {
                !matches!(
                    engine.supports(&scene),
                    Err(Halt::Ended(Ending::Unsupported { .. }))
                )
            })
        };
        let solvers = self.solvers.iter().filter(honours);
        Ok(solvers
            .map(|name| Way {
                name,
                sets: &[],
                solver: Some(name),
            })
            .collect())
    }
}

/// Why this machine does not count instructions; empty if it does.
#[must_use]
pub fn no_instructions() -> String {
    instructions::Counter::new()
        .refusal()
        .unwrap_or_default()
        .to_owned()
}
