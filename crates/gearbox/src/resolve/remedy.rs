//! The setting that works where the scene's own does not: tried before it is offered.

use std::time::{Duration, Instant};

use super::{Budget, Uncertainty, run_resolved};
use crate::scene::CheckedScene;
use crate::{Gearbox, auto};

/// A setting that was tried on this very scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Remedy {
    /// What to write, e.g. `solver.integrator = "auto"`.
    pub setting: String,
    /// What it gave.
    pub uncertainty: Uncertainty,
}

impl Remedy {
    /// One sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!(
            "{} resolves this scene (tried): {}",
            self.setting,
            self.uncertainty.sentence()
        )
    }
}

/// Tries `solver.integrator = "auto"` on a scene whose named method failed, for no longer than `longest` of wall time.
/// `None` if that does not resolve it, takes longer, or is what the scene says already.
#[must_use]
pub fn remedy(scene: &CheckedScene, longest: Duration) -> Option<Remedy> {
    if scene.solver.integrator == auto::AUTO {
        return None;
    }
    let began = Instant::now();
    let gearbox = Gearbox::new(scene).ok()?;
    let mut late = |_| began.elapsed() > longest;
    let (_, uncertainty) =
        run_resolved(&gearbox, auto::TARGET, Budget::default(), &mut late).ok()?;
    uncertainty.is_resolved().then(|| Remedy {
        setting: format!("solver.integrator = \"{}\"", auto::AUTO),
        uncertainty,
    })
}
