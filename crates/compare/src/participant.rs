//! Inputs of a comparison: runs of several engines on one scene, and the known facts of the scene.

use pinwheel_timeseries::TimeSeries;
pub use pinwheel_timeseries::{
    Ending as Status, EnergyAudit as Energy, RunStats as Cost, SharedModel,
};
use serde::{Deserialize, Serialize};

use crate::windows::Window;

/// One engine's run.
#[derive(Debug, Clone)]
pub struct Participant {
    /// Engine name, unique within a comparison.
    pub name: String,
    /// Track: the comparison to which the participant belongs.
    pub track: SharedModel,
    /// Version of the engine.
    pub version: String,
    /// One line on what it is.
    pub summary: String,
    /// Differences from the native solver, in plain words.
    pub differences: String,
    /// Time series; shorter than the others', or empty, unless [`Status::Finished`].
    pub time_series: TimeSeries,
    /// Cost of the run.
    pub cost: Cost,
    /// Ending of the run.
    pub status: Status,
}

/// Facts of the scene that a comparison needs. Only `scene` and `duration_s` are needed for time series that are not of
/// a gearbox. A figure or verdict whose fact is `None` is left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Context {
    /// Scene name.
    pub scene: String,
    /// Why the scene exists, one sentence, or empty.
    pub description: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Torque of the load on the output shaft, N m. Of a load that changes the last one, which is that of a steady window.
    pub load_n_m: Option<f64>,
    /// From here on the load is that, s.
    #[serde(skip)]
    pub load_from_s: f64,
    /// Moment of inertia that contact forces and load turn, kg m^2: the output shaft with its output pins. Without it no
    /// balance is judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_inertia_kg_m2: Option<f64>,
    /// Times at which the load changes or comes to the end of a change, s, increasing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub load_changes_s: Vec<f64>,
    /// Angular velocity of the driver, rad/s.
    pub input_speed_rad_s: Option<f64>,
    /// Coefficient of friction; 0 chooses the tolerances of frictionless scenes.
    pub friction_coefficient: f64,
    /// Time in which the start-up transient has decayed, s; `None` takes
    /// [`SETTLING_S`](crate::windows::SETTLING_S). 0 for a run that starts in equilibrium.
    pub settling_s: Option<f64>,
    /// Measured effect of a rounding on the scene; `None` where it was not measured.
    pub divergence: Option<Divergence>,
    /// Sizes that tell a load from a rounding; what is `None` is taken from the time series themselves.
    #[serde(skip_serializing_if = "Scales::is_empty")]
    pub scales: Scales,
}

/// Characteristic sizes of a scene, so that no verdict depends on how large the gear is.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Scales {
    /// Force, N: e.g. the load over the radius it acts at.
    pub force_n: Option<f64>,
    /// Torque, N m: e.g. the load.
    pub torque_n_m: Option<f64>,
}

impl Scales {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Growth of the difference between two runs of one solver that start one rounding apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Divergence {
    /// From here on the time_series differ visibly, s, and only their statistics (mean, peak, RMS) can be compared;
    /// `None`: not within the run.
    pub horizon_s: Option<f64>,
    /// Largest difference, as a share of the largest force.
    pub largest_share: f64,
    /// One sentence for the reader: how it was measured and what follows.
    pub told: String,
}

impl Context {
    /// Load (N m) and inertia (kg m^2) of the output in a window throughout which the load is the last one.
    pub(crate) fn output(&self, window: &Window) -> Option<[f64; 2]> {
        let load = self
            .load_n_m
            .filter(|_| self.load_from_s <= window.from_s)?;
        Some([load, self.output_inertia_kg_m2?])
    }

    /// True if time series can be compared sample by sample up to `to_s`.
    #[must_use]
    pub fn is_pointwise(&self, to_s: f64) -> bool {
        let horizon = self.divergence.as_ref().and_then(|d| d.horizon_s);
        horizon.is_none_or(|horizon| to_s <= horizon)
    }
}
