//! Settings of a method, coarse to fine, and reasons to stop.

use pinwheel_engines::AccuracySetting;
use pinwheel_scene::Scene;
use serde::Serialize;

/// Coarsest step, as a multiple of the scene's, and number of its halvings.
const COARSEST: f64 = 8.0;
const HALVINGS: i32 = 10;
/// Loosest tolerance, and number of half decades below it.
const LOOSEST: f64 = 1e-2;
const HALF_DECADES: i32 = 16;

/// Returns the settings of a method's step or tolerance for a scene, coarse to fine. Steps divide the sampling step evenly,
/// because some engines sample only at ends of steps.
pub fn settings(knob: AccuracySetting, scene: &Scene) -> Vec<f64> {
    match knob {
        AccuracySetting::Tolerance => {
            let tolerance = |k: i32| {
                let exact = LOOSEST * 10.0_f64.powf(-0.5 * f64::from(k));
                // Two digits suffice for a tolerance.
                format!("{exact:.1e}").parse().unwrap_or(exact)
            };
            (0..=HALF_DECADES).map(tolerance).collect()
        }
        AccuracySetting::Step => {
            let sample = scene.solver.sample_s;
            let step = |k: i32| {
                let step = scene.solver.step_s * COARSEST / 2.0_f64.powi(k);
                sample / (sample / step * (1.0 - 1e-9)).ceil().max(1.0)
            };
            let mut steps: Vec<f64> = (0..=HALVINGS).map(step).collect();
            steps.dedup();
            steps
        }
    }
}

/// Reason why a series has no finer point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stopped {
    /// All settings were tried.
    Finished,
    /// Far more accurate than the target, and finer runs are not cheap.
    GoodEnough,
    /// Distance from the reference below the reference's own error.
    AtTheReference,
    /// The next run would take too long.
    TooLong,
    /// Finer steps no longer help: the remaining error is the engine's model.
    Stagnates,
    /// Scene not supported by the engine, or failure of the engine.
    Failed,
    /// Stop by the user.
    Interrupted,
}

impl Stopped {
    /// Returns the reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Finished => "all settings tried",
            Self::GoodEnough => "ten times better than the target",
            Self::AtTheReference => "at the reference's own error",
            Self::TooLong => "the next run would take too long",
            Self::Stagnates => "finer steps do not help: the rest is an error of its model",
            Self::Failed => "does not run",
            Self::Interrupted => "stopped by the user",
        }
    }
}
