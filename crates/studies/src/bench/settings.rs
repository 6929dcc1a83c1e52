//! The settings a method is tried with, coarse to fine, and when to stop.

use pinwheel_engines::{AccuracySetting, SharedModel};
use pinwheel_scene::Scene;
use serde::Serialize;

use super::Options;

/// Steps as multiples of the scene's: the coarsest, and how often it is halved.
const COARSEST: f64 = 8.0;
const HALVINGS: i32 = 10;
/// Tolerances: the loosest, and half decades below it.
const LOOSEST: f64 = 1e-2;
const HALF_DECADES: i32 = 16;

/// Settings of a knob for a scene, coarse to fine. Steps divide the sampling step evenly, because some
/// engines sample at ends of steps only.
#[must_use]
pub(super) fn settings(knob: AccuracySetting, scene: &Scene) -> Vec<f64> {
    match knob {
        AccuracySetting::Tolerance => {
            let tolerance = |k: i32| {
                let exact = LOOSEST * 10.0_f64.powf(-0.5 * f64::from(k));
                // Two digits are enough to name a tolerance.
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

/// Why a series has no finer point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stopped {
    /// All settings were tried.
    Finished,
    /// Far better than the target, and finer runs are not cheap.
    GoodEnough,
    /// As near to the reference as the reference can tell.
    AtTheReference,
    /// The next run would take too long.
    TooLong,
    /// Finer steps no longer help: the rest is the engine's model.
    Stagnates,
    /// The engine cannot honour the scene, or broke.
    Failed,
    /// The user stopped the study.
    Interrupted,
}

impl Stopped {
    /// For the reader.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Finished => "all settings tried",
            Self::GoodEnough => "ten times better than the target",
            Self::AtTheReference => "at the reference's own error",
            Self::TooLong => "the next run would take too long",
            Self::Stagnates => "finer steps do not help: what is left is its model",
            Self::Failed => "does not run",
            Self::Interrupted => "stopped by the user",
        }
    }
}

/// A run this cheap (s) is made whatever it brings.
const CHEAP_S: f64 = 0.25;
/// An error that falls by less than this factor over two settings does not fall.
const STAGNANT: f64 = 1.3;

/// Facts of a series after a run.
pub(super) struct State {
    pub(super) track: SharedModel,
    /// CPU time of the last run, s, and of the one before.
    pub(super) cpu_s: f64,
    pub(super) cpu_before_s: f64,
    /// Error of the last run; infinite if it failed.
    pub(super) error: f64,
    /// Error two runs before.
    pub(super) error_before: f64,
    /// Upper estimate of the reference's own error.
    pub(super) reference_error: f64,
}

impl State {
    /// Returns the reason to stop before a run whose setting is `ratio` times finer; `None`: go on.
    pub(super) fn stop(
        &self,
        knob: AccuracySetting,
        ratio: f64,
        options: &Options,
    ) -> Option<Stopped> {
        // What a tighter tolerance costs is not known before, and may be less: RODAS5P rubs cheaply from where its steps land on
        // the friction's ramp. Two runs that took too long end a series; one that takes far too long is given up.
        let next = match knob {
            AccuracySetting::Step => self.cpu_s * ratio,
            AccuracySetting::Tolerance => self.cpu_s.min(self.cpu_before_s),
        };
        if self.error <= 0.1 * self.reference_error || self.error == 0.0 {
            return Some(Stopped::AtTheReference);
        }
        if self.error <= 0.1 * options.target && next > CHEAP_S {
            return Some(Stopped::GoodEnough);
        }
        if next > options.longest(self.track) {
            return Some(Stopped::TooLong);
        }
        let stagnant = self.track == SharedModel::OwnContact
            && self.error.is_finite()
            && self.error_before < STAGNANT * self.error;
        stagnant.then_some(Stopped::Stagnates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_halve_and_divide_the_samples() {
        let scene = Scene::paper();
        let steps = settings(AccuracySetting::Step, &scene);
        assert!(steps.contains(&scene.solver.step_s), "{steps:?}");
        for pair in steps.windows(2) {
            assert!((1.5..2.6).contains(&(pair[0] / pair[1])), "{pair:?}");
        }
        for step in steps {
            let parts = scene.solver.sample_s / step;
            assert!((parts - parts.round()).abs() < 1e-9, "{step}");
        }
    }

    #[test]
    fn tolerances_fall_by_half_decades() {
        let tolerances = settings(AccuracySetting::Tolerance, &Scene::paper());
        assert_eq!(tolerances[0], 1e-2);
        assert_eq!((tolerances[1], tolerances[16]), (3.2e-3, 1e-10));
    }

    #[test]
    fn a_series_stops_for_a_reason() {
        let options = Options::default();
        let state = |track, cpu_s, error, error_before| State {
            track,
            cpu_s,
            cpu_before_s: 0.0,
            error,
            error_before,
            reference_error: 1e-8,
        };
        let stop = |state: State| state.stop(AccuracySetting::Step, 2.0, &options);
        let tighter = |cpu_before_s| {
            let long = state(SharedModel::Native, 2.1, 1e-2, 2e-2);
            let long = State {
                cpu_before_s,
                ..long
            };
            long.stop(AccuracySetting::Tolerance, 3.2, &options)
        };
        assert_eq!(tighter(1.9), None);
        assert_eq!(tighter(2.1), Some(Stopped::TooLong));
        assert_eq!(stop(state(SharedModel::Native, 0.1, 1e-6, 4e-6)), None);
        assert_eq!(
            stop(state(SharedModel::Native, 1.0, 1e-6, 4e-6)),
            Some(Stopped::GoodEnough)
        );
        assert_eq!(
            stop(state(SharedModel::SharedLaw, 1e3, 1e-2, 4e-2)),
            Some(Stopped::TooLong)
        );
        assert_eq!(
            stop(state(SharedModel::OwnContact, 1.0, 1e-2, 1e-2)),
            Some(Stopped::Stagnates)
        );
        assert_eq!(stop(state(SharedModel::SharedLaw, 1.0, 1e-2, 1e-2)), None);
        assert_eq!(
            stop(state(SharedModel::Native, 1.0, 1e-10, 1e-9)),
            Some(Stopped::AtTheReference)
        );
        assert_eq!(
            stop(state(
                SharedModel::Native,
                1.0,
                f64::INFINITY,
                f64::INFINITY
            )),
            None
        );
    }
}
