//! Whether a run's step resolves its scene: the same run again at twice the step (or ten times the
//! tolerance), and how far the forces move.
//!
//! A method of order 2 that is asymptotic there has a third of that distance for its own error, one of
//! order 4 a fifteenth; with friction, whose switches are not located, a little more than half. An error
//! that this does not show would have to be the same at both steps.

use pinwheel_courses::Courses;
use pinwheel_gearbox::auto;
use pinwheel_mbs::integrators::METHODS;
use pinwheel_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{Ended, run};
use crate::measure::{Difference, difference, level};

/// Relative L2 distance beyond which a run is not resolved: its own error is then about 0.1 or more.
/// Measured over the presets, 0.05 s at 1e-5 s: those within 0.1 of their converged run move by 0.25 at most
/// (`hard-damping-0` with Heun, 0.05 off); `hard-all-open` with Heun moves by 0.56 (0.36 off), `steel` with
/// RK4 by 0.79 (0.79 off).
pub const MOST: f64 = 0.3;

/// Forces below which nothing is judged, N: an idle gear has none to speak of.
const FORCE_FLOOR: f64 = 1.0;

/// What a coarser run shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// The coarser setting in words, e.g. `a step of 2e-5 s`.
    pub coarser: String,
    /// How far the run moves; `None` if the coarser one failed, or without forces to speak of.
    pub moved: Option<Difference>,
    /// How the coarser run failed.
    pub failure: Option<String>,
}

impl Resolution {
    /// False when the forces or the driver's torque move by more than [`MOST`].
    #[must_use]
    pub fn holds(&self) -> bool {
        self.moved
            .is_none_or(|d| d.forces <= MOST && d.driver_torque <= MOST)
    }

    /// One sentence for the reader.
    #[must_use]
    pub fn sentence(&self) -> String {
        match (&self.failure, self.moved) {
            (Some(failure), _) => format!(
                "at {} the run fails ({failure}): this one is less than that away from its limit",
                self.coarser
            ),
            (None, Some(d)) => format!(
                "at {} the forces move by {:.1e}, the driver's torque by {:.1e} (relative L2)",
                self.coarser, d.forces, d.driver_torque
            ),
            (None, None) => "no forces to speak of: nothing to resolve".to_owned(),
        }
    }
}

/// Repeats the native run of `scene` that gave `courses`, coarser; `watch` receives the simulated time and returns
/// true to stop.
///
/// # Errors
/// Cancelled, or a scene that cannot be modelled.
pub fn check(
    scene: &Scene,
    courses: &Courses,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Resolution, StudyError> {
    let integrator = auto::integrator(scene).integrator;
    let adaptive = METHODS.iter().any(|m| m.name == integrator && m.adaptive);
    let mut coarse = scene.clone();
    let coarser = if adaptive {
        coarse.solver.tolerance *= 10.0;
        format!("a tolerance of {:.0e}", coarse.solver.tolerance)
    } else {
        coarse.solver.step_s *= 2.0;
        format!("a step of {:e} s", coarse.solver.step_s)
    };
    let mut found = Resolution {
        coarser,
        moved: None,
        failure: None,
    };
    match run(&coarse, watch)? {
        Ended::Whole(other) => {
            found.moved = (level(courses).peak_force_n > FORCE_FLOOR)
                .then(|| difference(&other.courses, courses));
        }
        Ended::Diverged { time_s, quantity } => {
            found.failure = Some(format!("t = {time_s:.4} s: {quantity}"));
        }
    }
    Ok(found)
}
