//! Remedy for a failed setting of a scene: a tested setting that works.

use std::time::{Duration, Instant};

use super::{BUDGET, run_resolved};
use crate::scene::CheckedScene;
use crate::{Gearbox, auto};

/// Tries `solver.integrator = "auto"` on a scene whose named method failed, for at most `longest` of wall time. Returns the
/// result in words; `None` if `auto` does not resolve the scene, takes longer, or is the scene's own setting.
pub fn remedy(scene: &CheckedScene, longest: Duration) -> Option<String> {
    if scene.solver.integrator == auto::AUTO {
        return None;
    }
    let began = Instant::now();
    let gearbox = Gearbox::new(scene).ok()?;
    let mut late = |_| began.elapsed() > longest;
    let (_, uncertainty) = run_resolved(&gearbox, auto::TARGET, BUDGET, &mut late).ok()?;
    let (auto, known) = (auto::AUTO, uncertainty.sentence());
    let advice = format!("solver.integrator = \"{auto}\" resolves this scene (tried): {known}");
    uncertainty.is_resolved().then_some(advice)
}
