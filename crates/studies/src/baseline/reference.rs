//! The converged run of a scene, with an estimate of its own error.
//!
//! Dormand and Prince's method in the reduced form at a tolerance far below every choice of the set, also for
//! friction (stiff, but over 20 ms it can be followed) and for discrete points (each jump of a force is met by
//! rejected steps). The same run at ten times the tolerance lies this far away: that is what its error is worth.

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_scene::{Formulation, Scene};

use super::runner::Job;

/// Tolerances of the converged run and of the one that tells its error.
pub(super) const TOLERANCES: [f64; 2] = [1e-10, 1e-9];

/// Settings in words.
pub(super) fn settings() -> String {
    format!(
        "reduced, dopri5, tolerance {:e}; own error: distance to {:e}",
        TOLERANCES[0], TOLERANCES[1]
    )
}

/// The converged run and the one that tells its error.
pub(super) fn jobs(scene: &Scene) -> [Job; 2] {
    TOLERANCES.map(|tolerance| {
        let mut scene = scene.clone();
        scene.solver.formulation = Formulation::Reduced;
        "dopri5".clone_into(&mut scene.solver.integrator);
        scene.solver.tolerance = tolerance;
        scene.solver.step_s = 1e-7;
        Job {
            label: format!("{}, converged at {tolerance:e}", scene.name),
            scene,
            kernel: Kernel::Lanes,
            solver: None,
            repeats: 0,
        }
    })
}
