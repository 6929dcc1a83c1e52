//! What long runs do to joints, phases and forces.

use pinwheel_courses::columns;
use pinwheel_scene::{Formulation, Scene, Stabilisation};
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{Control, Ended};
use pinwheel_courses::norms::{Distance, Least};

/// One way of keeping the joints together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drift {
    /// Stabilisation of the Lagrange form.
    pub stabilisation: Stabilisation,
    /// Largest joint error at any sample, m; `None` if the run failed.
    pub joint_m: Option<f64>,
    /// Forces and torque against the reduced form, which has no joints.
    pub against_reduced: Option<Distance>,
    /// Output angle at the end against the ideal ratio, rad, minus the reduced form's.
    pub phase_rad: Option<f64>,
    /// How the run failed.
    pub failure: Option<String>,
}

/// Runs `scene` in the reduced form and in the Lagrange form with every stabilisation.
///
/// # Errors
/// Cancelled, or the reduced run fails.
pub fn measure(scene: &Scene, control: &Control<'_>) -> Result<Vec<Drift>, StudyError> {
    let mut scene = scene.clone();
    scene.solver.formulation = Formulation::Reduced;
    let reduced = control.complete(&scene)?.courses;
    let last_angle = |courses: &pinwheel_courses::Courses| {
        courses
            .channel(columns::OUTPUT_ANGLE)
            .and_then(|c| c.last().copied())
    };
    scene.solver.formulation = Formulation::Lagrange;
    let mut found = Vec::new();
    for stabilisation in [
        Stabilisation::None,
        Stabilisation::Baumgarte,
        Stabilisation::Projection,
    ] {
        scene.solver.stabilisation = stabilisation;
        let mut drift = Drift {
            stabilisation,
            joint_m: None,
            against_reduced: None,
            phase_rad: None,
            failure: None,
        };
        match control.run(&scene)? {
            Ended::Whole(run) => {
                drift.joint_m = Some(run.joint_drift_m);
                drift.against_reduced =
                    Some(Distance::between(&run.courses, &reduced, Least::default()));
                drift.phase_rad = last_angle(&run.courses)
                    .zip(last_angle(&reduced))
                    .map(|(a, b)| a - b);
            }
            Ended::Diverged {
                time_s, quantity, ..
            } => {
                drift.failure = Some(format!("at t = {time_s:.4} s: {quantity}"));
            }
        }
        found.push(drift);
    }
    Ok(found)
}
