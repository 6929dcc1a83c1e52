//! What goes into a comparison: runs of several engines on one scene, and what is known of the scene.

use pinwheel_courses::Courses;
use serde::Serialize;

/// The tracks: kinds of comparison that are never mixed in one table.
pub mod track {
    /// The project's own solver; stands in the tables of every other track.
    pub const NATIVE: &str = "native";
    /// Foreign bodies, joints and time integration under one shared contact law.
    pub const SHARED_LAW: &str = "shared-law";
    /// The engine detects or resolves contact itself.
    pub const OWN_CONTACT: &str = "own-contact";
    /// Data from elsewhere: another program's export, a test rig. Samples may be missing (NaN) before
    /// and after what it covers, and only limits that its owner states apply.
    pub const MEASURED: &str = "measured";
}

/// One engine's run.
#[derive(Debug, Clone)]
pub struct Participant {
    /// Engine name, unique within a comparison.
    pub name: String,
    /// Track, see [`track`]; other words make tracks of their own.
    pub track: String,
    /// Version of the engine.
    pub version: String,
    /// One line on what it is.
    pub summary: String,
    /// How it differs from the native solver, in plain words.
    pub differences: String,
    /// Its courses; shorter than the others', or empty, unless [`Status::Finished`].
    pub courses: Courses,
    /// What the run cost.
    pub cost: Cost,
    /// How the run ended.
    pub status: Status,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum Status {
    /// Complete courses; the only state that is judged.
    Finished,
    /// The numbers ran away; the courses until then are kept and shown, not judged.
    Diverged {
        /// When, s.
        time_s: f64,
        /// Which quantity, and its value.
        quantity: String,
    },
    /// The engine cannot honour the scene.
    Unsupported {
        /// Which part of the scene, and why.
        reason: String,
    },
    /// The engine is missing or broke.
    Failed {
        /// Its own words.
        reason: String,
    },
}

impl Status {
    /// True for complete courses.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        *self == Self::Finished
    }

    /// One word for tables: `finished`, `diverged`, `unsupported`, `failed`.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Diverged { .. } => "diverged",
            Self::Unsupported { .. } => "unsupported",
            Self::Failed { .. } => "failed",
        }
    }

    /// Why the run is not judged; `None` when finished.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        match self {
            Self::Finished => None,
            Self::Diverged { time_s, quantity } => {
                Some(format!("diverged at t = {time_s:.6} s: {quantity}"))
            }
            Self::Unsupported { reason } => Some(format!("cannot run this scene: {reason}")),
            Self::Failed { reason } => Some(format!("failed: {reason}")),
        }
    }
}

/// What a run cost and which settings it had.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Cost {
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time, s.
    pub cpu_s: f64,
    /// Evaluations of the right-hand side.
    pub rhs_calls: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps (adaptive methods).
    pub rejected_steps: u64,
    /// Degrees of freedom integrated.
    pub degrees_of_freedom: usize,
    /// Bodies moved.
    pub bodies: usize,
    /// Step, s (the mean accepted step of adaptive methods).
    pub step_s: f64,
    /// The engine's settings in words.
    pub settings: String,
    /// Remarks for the reader.
    pub notes: Vec<String>,
    /// Largest position error of any joint, m, where the engine has constraints.
    pub joint_drift_m: Option<f64>,
    /// Where the energy went, window by window, of engines that keep an account.
    pub energy: Vec<Energy>,
    /// Set for a course that was not computed now but recorded earlier: when, with what, and why it stands here.
    /// Costs are then those of the recording, on its machine; its samples may be a part of the others'.
    pub recorded: Option<String>,
}

/// Energy account of one window, J: growth of kinetic and stored energy = works - losses + remainder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Energy {
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s.
    pub to_s: f64,
    /// Work of the driver.
    pub driver_j: f64,
    /// Work of the load; negative when the gear drives it.
    pub load_j: f64,
    /// Growth of kinetic energy.
    pub kinetic_j: f64,
    /// Growth of the energy stored in contacts.
    pub stored_j: f64,
    /// Lost by contact damping.
    pub damping_j: f64,
    /// Lost by sliding.
    pub friction_j: f64,
    /// Energy that nothing accounts for.
    pub remainder_j: f64,
    /// The remainder as a share of the larger work.
    pub remainder_share: f64,
}

/// What a comparison needs to know of the scene. Only `scene` and `duration_s` are needed for
/// courses that are no gearbox's: what is `None` is left out of figures and verdicts.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Context {
    /// Scene name.
    pub scene: String,
    /// Why the scene exists, one sentence, or empty.
    pub description: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Torque of the load on the output shaft, N m. In the mean the contact forces balance it:
    /// mean `output_torque_n_m` = -load. Of a load that changes the last one, which is that of a steady window.
    pub load_n_m: Option<f64>,
    /// Times at which the load changes or comes to the end of a change, s, increasing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub load_changes_s: Vec<f64>,
    /// Angular velocity of the driver, rad/s.
    pub input_speed_rad_s: Option<f64>,
    /// Coefficient of friction; 0 chooses the limits of frictionless scenes.
    pub friction_coefficient: f64,
    /// Time in which the start-up transient has decayed, s; `None` takes
    /// [`SETTLING_S`](crate::windows::SETTLING_S). 0 for a run that starts in equilibrium.
    pub settling_s: Option<f64>,
    /// What a rounding does to the scene, where it was measured.
    pub divergence: Option<Divergence>,
}

/// How two runs of one solver come apart that differ by one rounding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Divergence {
    /// From here on the courses differ visibly, s, and only their statistics (mean, peak, RMS) can be compared;
    /// `None`: not within the run.
    pub horizon_s: Option<f64>,
    /// Largest difference, as a share of the largest force.
    pub largest_share: f64,
    /// One sentence for the reader: how it was measured and what follows.
    pub told: String,
}

impl Context {
    /// Whether courses can be compared sample by sample up to `to_s`.
    #[must_use]
    pub fn is_pointwise(&self, to_s: f64) -> bool {
        let horizon = self.divergence.as_ref().and_then(|d| d.horizon_s);
        horizon.is_none_or(|horizon| to_s <= horizon)
    }
}
