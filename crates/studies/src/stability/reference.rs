//! The converged run of a scene, and how well it is converged.

use pinwheel_scene::{Detection, Scene};
use pinwheel_timeseries::TimeSeries;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{Control, complete, reduced_by};
use pinwheel_timeseries::norms::{Distance, Least, Level};

/// How the converged run was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Integrator.
    pub integrator: String,
    /// Step (s) or tolerance.
    pub setting: f64,
    /// Distance to the same run with twice the step, or ten times the tolerance: what its errors are worth.
    pub own_error: Distance,
    /// Sizes of its time series.
    pub level: Level,
}

/// Step of friction: 40 times finer than the paper's.
const FRICTION_STEP: f64 = 2.5e-7;
/// Step of discrete points, whose forces jump.
const POINTS_STEP: f64 = 5e-7;
/// Tolerance without either.
const TOLERANCE: f64 = 1e-8;

/// Runs `scene` converged, in the reduced form.
pub(super) fn run(
    scene: &Scene,
    control: &Control<'_>,
) -> Result<(Reference, TimeSeries), StudyError> {
    let (integrator, fine, coarse) = if scene.contact.friction_coefficient > 0.0 {
        ("imex2", FRICTION_STEP, 2.0 * FRICTION_STEP)
    } else if scene.contact.detection == Detection::Points {
        ("rk4", POINTS_STEP, 2.0 * POINTS_STEP)
    } else {
        ("dopri5", TOLERANCE, 10.0 * TOLERANCE)
    };
    let at = |setting: f64| complete(&reduced_by(scene, integrator, setting), control);
    let (best, other) = (at(fine)?, at(coarse)?);
    let reference = Reference {
        integrator: integrator.to_owned(),
        setting: fine,
        own_error: Distance::between(&other.time_series, &best.time_series, Least::default()),
        level: Level::of(&best.time_series),
    };
    Ok((reference, best.time_series))
}
