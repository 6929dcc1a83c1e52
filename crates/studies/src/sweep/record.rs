//! What is kept of a run.

use std::collections::BTreeMap;

use pinwheel_compare::quantities::{INPUT_TORQUE, OUTPUT_ANGLE, OUTPUT_TORQUE, derive};
use pinwheel_compare::statistics::{Statistics, View};
use pinwheel_courses::Courses;
use pinwheel_engines::{Engine, Run};
use serde::{Deserialize, Serialize};

use crate::sweep::PlannedRun;

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "lowercase")]
pub enum Outcome {
    /// Complete.
    Finished,
    /// The numbers ran away: a result, but one without figures.
    Diverged {
        /// When, s.
        time_s: f64,
        /// Which quantity.
        quantity: String,
    },
    /// The engine cannot honour the scene.
    Unsupported {
        /// Why.
        reason: String,
    },
    /// The engine broke; not kept for another attempt.
    Failed {
        /// Its own words.
        reason: String,
    },
}

impl Outcome {
    /// One word.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Diverged { .. } => "diverged",
            Self::Unsupported { .. } => "unsupported",
            Self::Failed { .. } => "failed",
        }
    }

    /// Why there are no figures; empty when finished.
    #[must_use]
    pub fn reason(&self) -> &str {
        match self {
            Self::Finished => "",
            Self::Diverged { quantity, .. } => quantity,
            Self::Unsupported { reason } | Self::Failed { reason } => reason,
        }
    }
}

/// Figures of one quantity over the window, all its channels together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub peak: f64,
}

/// What is kept of a run. All but the two times is the same whenever it is run again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Engine.
    pub engine: String,
    /// Its version.
    pub engine_version: String,
    /// This program's version.
    pub pinwheel_version: String,
    /// The whole scene, TOML.
    pub scene: String,
    /// Window of the figures, s.
    pub window_s: [f64; 2],
    /// How it ended.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// Figures by quantity; empty unless finished.
    pub figures: BTreeMap<String, Spread>,
    /// Quantities in the order of the courses.
    pub quantities: Vec<String>,
    /// Power out over power in, by means over the window; `None` without positive power in.
    pub efficiency: Option<f64>,
    /// Energy that nothing accounts for in the run's second half, as a share of the larger work, where
    /// the engine keeps an account.
    pub energy_remainder_share: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// Evaluations of the contact forces.
    pub rhs_calls: u64,
    /// Remarks of the engine.
    pub notes: Vec<String>,
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time, s.
    pub cpu_s: f64,
}

impl RunRecord {
    /// A record without figures.
    pub(crate) fn empty(planned: &PlannedRun, engine: &dyn Engine, outcome: Outcome) -> Self {
        Self {
            engine: engine.name().to_owned(),
            engine_version: engine.version(),
            pinwheel_version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: planned.scene.to_toml(),
            window_s: planned.window_s,
            outcome,
            figures: BTreeMap::new(),
            quantities: Vec::new(),
            efficiency: None,
            energy_remainder_share: None,
            steps: 0,
            rhs_calls: 0,
            notes: Vec::new(),
            wall_s: 0.0,
            cpu_s: 0.0,
        }
    }

    /// Adds what a run cost.
    pub(crate) fn with_cost(mut self, run: &Run) -> Self {
        let stats = &run.stats;
        self.steps = stats.steps;
        self.rhs_calls = stats.rhs_calls;
        self.notes = stats.notes.clone();
        self.wall_s = stats.wall_s;
        self.cpu_s = stats.cpu_s;
        self
    }

    /// Adds the figures of a complete run.
    pub(crate) fn with_figures(mut self, planned: &PlannedRun, run: &Run) -> Self {
        let [from, to] = planned.window_s;
        let samples = run.courses.window(from, to);
        for quantity in derive([&run.courses]) {
            let view = View::of(&run.courses, &quantity, samples.clone());
            if let Some(of) = view.as_ref().and_then(Statistics::of) {
                let spread = Spread {
                    mean: of.mean,
                    min: of.min,
                    max: of.max,
                    rms: of.rms,
                    peak: of.peak,
                };
                self.quantities.push(quantity.name.clone());
                self.figures.insert(quantity.name, spread);
            }
        }
        self.efficiency = self.efficiency_of(planned, &run.courses);
        self.energy_remainder_share = run.stats.energy.last().map(|audit| audit.remainder_share);
        self
    }

    /// mean T_out * mean speed out / (mean T_in * speed in).
    fn efficiency_of(&self, planned: &PlannedRun, courses: &Courses) -> Option<f64> {
        let [from, to] = planned.window_s;
        let samples = courses.window(from, to);
        let time = courses.time_s().get(samples.clone())?;
        let angle = courses.channel(OUTPUT_ANGLE)?.get(samples)?;
        let speed = (angle.last()? - angle.first()?) / (time.last()? - time.first()?);
        let mean = |name: &str| self.figures.get(name).map(|spread| spread.mean);
        let power_in = mean(INPUT_TORQUE)? * planned.scene.drive.input_speed_rad_s;
        let efficiency = mean(OUTPUT_TORQUE)? * speed / power_in;
        (power_in > 0.0 && efficiency.is_finite()).then_some(efficiency)
    }

    /// Everything that the figures depend on, as text.
    pub(crate) fn identity(&self) -> String {
        identity(
            &self.engine,
            &self.engine_version,
            &self.pinwheel_version,
            self.window_s,
            &self.scene,
        )
    }
}

/// Everything that the figures of a run depend on, as text.
pub(crate) fn identity(
    engine: &str,
    version: &str,
    pinwheel: &str,
    window_s: [f64; 2],
    scene: &str,
) -> String {
    format!("{engine}\n{version}\n{pinwheel}\n{window_s:?}\n{scene}")
}
