//! Judgement of a run against the converged one: correct, or the kind of failure.

use pinwheel_engines::Run;
use pinwheel_scene::Scales;
use pinwheel_timeseries::{Ending, TimeSeries};
use serde::{Deserialize, Serialize};

use pinwheel_timeseries::norms::{Distance, LoadFloor, LoadMagnitude};

/// Kind of failure of a run. All except a blow-up give wrong numbers that look like results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Failure {
    /// Run stopped with an error.
    BlowUp {
        /// Time of the failure, s.
        time_s: f64,
        /// Quantity that failed.
        quantity: String,
    },
    /// Forces far above the converged ones.
    Chatter {
        /// Largest force over the converged largest.
        peak_ratio: f64,
    },
    /// Wrong mean driver torque.
    WrongMean {
        /// Difference as a share of the torque's converged RMS.
        share: f64,
    },
    /// Joints that open (Lagrange form).
    Drift {
        /// Largest joint error, m.
        joint_m: f64,
    },
    /// Forces of the right size at the wrong time, i.e. with lost phases.
    WrongCourse {
        /// Relative L2 error of the forces.
        error: f64,
    },
}

/// Largest permitted ratio of peak forces to the converged ones.
const PEAK_RATIO: f64 = 1.5;
/// Largest permitted relative error of the mean driver torque.
const MEAN_SHARE: f64 = 0.1;
/// Largest permitted joint error, as a share of the penetration under the load: 1e-7 m for the paper's gear, a hundredth of its
/// ramp.
const JOINT_SHARE: f64 = 0.0015;
/// Largest permitted relative L2 error of the forces; beyond it the time series are unrelated.
const COURSE_ERROR: f64 = 0.5;
/// Least force and torque that are judged, as shares of the largest static pin force and of a disc's load: 1 N and 0.01 N m for
/// the paper's gear. An unloaded gear has less.
const FORCE_SHARE: f64 = 0.015;
const TORQUE_SHARE: f64 = 1e-3;

impl Failure {
    /// Returns the failure in one or two words.
    pub fn word(&self) -> &'static str {
        match self {
            Self::BlowUp { .. } => "blow-up",
            Self::Chatter { .. } => "chatter",
            Self::WrongMean { .. } => "wrong mean",
            Self::Drift { .. } => "drift",
            Self::WrongCourse { .. } => "wrong course",
        }
    }

    /// Returns the word with its figure, for a cell of a table.
    pub fn short(&self) -> String {
        match self {
            Self::BlowUp { time_s, .. } => format!("blow-up at {time_s:.4} s"),
            Self::Chatter { peak_ratio } => format!("chatter, {peak_ratio:.1} x"),
            Self::WrongMean { share } => format!("wrong mean, {:.0} %", 100.0 * share),
            Self::Drift { joint_m } => format!("drift, {joint_m:.0e} m"),
            Self::WrongCourse { error } => format!("wrong course, {:.0} %", 100.0 * error),
        }
    }

    /// Returns the failure with its figure as a sentence.
    pub fn sentence(&self) -> String {
        match self {
            Self::BlowUp { time_s, quantity } => {
                format!("stopped with an error at t = {time_s:.4} s: {quantity}")
            }
            Self::Chatter { peak_ratio } => {
                format!("largest force {peak_ratio:.2} times the converged one")
            }
            Self::WrongMean { share } => {
                format!("mean driver torque off by {:.0} %", 100.0 * share)
            }
            Self::Drift { joint_m } => format!("joints {joint_m:.1e} m apart"),
            Self::WrongCourse { error } => format!("forces {:.0} % off", 100.0 * error),
        }
    }
}

/// Reference for the judgement of runs.
pub(super) struct Judge<'a> {
    reference: &'a TimeSeries,
    level: LoadMagnitude,
    /// Static loads and deflections of the scene.
    scales: Scales,
}

impl<'a> Judge<'a> {
    pub(super) fn new(reference: &'a TimeSeries, scales: Scales) -> Self {
        let level = LoadMagnitude::of(reference);
        Self {
            reference,
            level,
            scales,
        }
    }

    /// Returns the error against the reference; `None` if its forces are below the least that is judged.
    pub(super) fn error(&self, time_series: &TimeSeries) -> Option<Distance> {
        let floor = FORCE_SHARE * self.scales.external_force_n;
        (self.level.peak_force_n > floor)
            .then(|| Distance::between(time_series, self.reference, LoadFloor::default()))
    }

    /// Returns the failure of a run; `None` if the run is correct.
    pub(super) fn failure(&self, run: &Run) -> Option<Failure> {
        let (time_s, quantity) = match &run.ending {
            Ending::Finished => return self.wrong(run),
            Ending::Diverged { time_s, quantity } => (*time_s, quantity.clone()),
            ending => (0.0, ending.to_string()),
        };
        Some(Failure::BlowUp { time_s, quantity })
    }

    /// Returns the failure of a run that finished.
    fn wrong(&self, run: &Run) -> Option<Failure> {
        let joint_m = run.stats.joint_drift_m.unwrap_or(0.0);
        if !(joint_m <= JOINT_SHARE * self.scales.penetration_m) {
            return Some(Failure::Drift { joint_m });
        }
        let own = LoadMagnitude::of(&run.time_series);
        let floor = FORCE_SHARE * self.scales.external_force_n;
        let peak = self.level.peak_force_n.max(floor);
        let peak_ratio = own.peak_force_n / peak;
        if !(peak_ratio <= PEAK_RATIO) {
            return Some(Failure::Chatter { peak_ratio });
        }
        let off = (own.mean_torque_n_m - self.level.mean_torque_n_m).abs();
        let floor = TORQUE_SHARE * self.scales.wheel_torque_n_m;
        let share = off / self.level.rms_torque_n_m.max(floor);
        if !(share <= MEAN_SHARE) {
            return Some(Failure::WrongMean { share });
        }
        let error = self.error(&run.time_series)?.forces;
        (!(error <= COURSE_ERROR)).then_some(Failure::WrongCourse { error })
    }
}
