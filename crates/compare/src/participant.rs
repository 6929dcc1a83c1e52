//! Inputs of a comparison: runs of several engines on one scene, and the facts of the scene.

use pinwheel_timeseries::TimeSeries;
pub use pinwheel_timeseries::{
    Ending as Status, EnergyAudit as Energy, RunStats as Cost, SharedModel,
};
use serde::{Deserialize, Serialize};

use crate::windows::Window;

/// Run of an engine.
#[derive(Debug, Clone)]
pub struct Participant {
    /// Engine name, unique within a comparison.
    pub name: String,
    /// Model shared with the native solver; selects the engines with which it is compared.
    pub track: SharedModel,
    /// Version of the engine.
    pub version: String,
    /// One-line description of the engine.
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

/// Facts of the scene that a comparison needs. Time series that are not of a gearbox need only `scene` and `duration_s`.
/// Figures and verdicts whose fact is `None` are left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Context {
    /// Scene name.
    pub scene: String,
    /// Purpose of the scene in one sentence, or empty.
    pub description: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Load torque on the output shaft, N m: the last one of a changing load, which applies in a steady window.
    pub load_n_m: Option<f64>,
    /// Time from which the load is `load_n_m`, s.
    #[serde(skip)]
    pub load_from_s: f64,
    /// Moment of inertia that contact forces and load accelerate, kg m^2: output shaft with its output pins. Without it no
    /// torque balance is judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_inertia_kg_m2: Option<f64>,
    /// Start and end times of load changes, s, increasing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub load_changes_s: Vec<f64>,
    /// Angular velocity of the driver, rad/s.
    pub input_speed_rad_s: Option<f64>,
    /// Coefficient of friction; 0 chooses the tolerances of frictionless scenes.
    pub friction_coefficient: f64,
    /// True if bearings, seals or sleeves on their pins lose power too.
    #[serde(skip)]
    pub has_losses: bool,
    /// Decay time of the start-up transient, s; `None` takes [`SETTLING_S`](crate::windows::SETTLING_S). 0 for a run that
    /// starts in equilibrium.
    pub settling_s: Option<f64>,
    /// Measured effect of a rounding on the scene; `None` if not measured.
    pub divergence: Option<Divergence>,
    /// Sizes that distinguish a load from a rounding; each `None` is derived from the time series.
    #[serde(skip_serializing_if = "Scales::is_empty")]
    pub scales: Scales,
}

/// Characteristic sizes of a scene, so that verdicts do not depend on the size of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Scales {
    /// Force, N: e.g. the load over its radius.
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
    /// Time from which the time series differ visibly, s, so that only their statistics (mean, peak, RMS) can be compared;
    /// `None` if they do not within the run.
    pub horizon_s: Option<f64>,
    /// Largest difference, as a share of the largest force.
    pub largest_share: f64,
    /// Sentence for readers: the measurement and its consequence.
    pub told: String,
}

impl Context {
    /// Returns load (N m) and inertia (kg m^2) of the output if the load is the last one throughout the window.
    pub(crate) fn output(&self, window: &Window) -> Option<[f64; 2]> {
        let load = self
            .load_n_m
            .filter(|_| self.load_from_s <= window.from_s)?;
        Some([load, self.output_inertia_kg_m2?])
    }

    /// True if time series can be compared sample by sample up to `to_s`.
    pub fn is_pointwise(&self, to_s: f64) -> bool {
        let horizon = self.divergence.as_ref().and_then(|d| d.horizon_s);
        horizon.is_none_or(|horizon| to_s <= horizon)
    }
}
