//! Facts of a run beside its time series: shared model, cost, energy account, ending, in the types of every engine, comparison
//! and file.

use serde::{Deserialize, Serialize};

use crate::norms::View;
use crate::{TimeSeries, columns};

/// Model that an engine shares with the native solver. Engines that share different models are never in one table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SharedModel {
    /// Pinwheel's own solver; it is in the tables of all others.
    Native,
    /// Foreign bodies, joints and time integration; Pinwheel's contact law evaluated inside the engine's step.
    SharedLaw,
    /// Contact detection or resolution by the engine itself.
    OwnContact,
    /// Measured or imported data: another program's export, a test rig. Samples may be missing (NaN) at both ends, and only
    /// limits stated by the owner apply.
    Measured,
}

impl SharedModel {
    /// Returns the word in reports and files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::SharedLaw => "shared-law",
            Self::OwnContact => "own-contact",
            Self::Measured => "measured",
        }
    }

    /// Names the shared part, about which agreement is no evidence.
    pub const fn shares(self) -> &'static str {
        match self {
            Self::Native => "equations",
            Self::SharedLaw => "contact law",
            Self::OwnContact | Self::Measured => "nothing",
        }
    }
}

impl std::fmt::Display for SharedModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

/// Effort, cost and settings of one run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct RunStats {
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time of the running thread, s.
    pub cpu_s: f64,
    /// Evaluations of the contact forces inside the integration (samples not counted).
    pub rhs_calls: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps (adaptive methods).
    pub rejected_steps: u64,
    /// Degrees of freedom integrated, i.e. velocities.
    pub degrees_of_freedom: usize,
    /// Number of moving bodies.
    pub bodies: usize,
    /// Step, s (the mean accepted step of adaptive methods).
    pub step_s: f64,
    /// The engine's own settings in words, e.g. `reduced, rk2`.
    pub settings: String,
    /// Remarks for the reader (approximations, activated safeguards).
    pub notes: Vec<String>,
    /// Largest position error of any joint, m, where the engine has constraints.
    pub joint_drift_m: Option<f64>,
    /// Energy account of the run and of its second half, where the engine keeps one.
    pub energy: Vec<EnergyAudit>,
    /// Description of a recording, for time series of an earlier date: date, program and reason of use. Its costs are those on
    /// its machine; its samples may be a subset of the other runs' samples.
    pub recorded: Option<String>,
    /// Day and machine of a complete run that an earlier command stored; its costs are those of that time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<String>,
    /// Uncertainty of recorded time series.
    #[serde(skip)]
    pub recorded_uncertainty: Vec<RecordedUncertainty>,
}

/// Uncertainty of a recorded quantity in one window, in its unit; `None` if unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedUncertainty {
    /// Quantity name.
    pub quantity: String,
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s.
    pub to_s: f64,
    /// Root mean square of the series' error.
    pub l2: Option<f64>,
    /// Largest error of the series.
    pub linf: Option<f64>,
    /// Error of the mean.
    pub mean: Option<f64>,
    /// Error of the largest magnitude.
    pub peak: Option<f64>,
    /// Error of the root mean square.
    pub rms: Option<f64>,
}

impl RecordedUncertainty {
    /// Returns the uncertainties of series, largest error, mean, peak and root mean square.
    pub fn norms(&self) -> [Option<f64>; 5] {
        [self.l2, self.linf, self.mean, self.peak, self.rms]
    }
}

/// Energy account between two times, J: growth of kinetic and stored energy = works - losses + remainder.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct EnergyAudit {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Work of the driver on the input shaft, J.
    pub driver_j: f64,
    /// Work of the load on the output shaft, J; negative when the gear drives the load.
    pub load_j: f64,
    /// Growth of kinetic energy, J.
    pub kinetic_j: f64,
    /// Growth of the energy stored in contacts, J.
    pub stored_j: f64,
    /// Energy lost to contact damping, J.
    pub damping_j: f64,
    /// Energy lost to friction, J.
    pub friction_j: f64,
    /// Friction losses in contacts, J; these and the next three are `None` if not modelled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact_friction_j: Option<f64>,
    /// Energy lost to friction in the bearings of eccentrics or cranks, J.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bearing_friction_j: Option<f64>,
    /// Energy lost to friction of sleeves on their pins, J.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sleeve_friction_j: Option<f64>,
    /// Energy lost to friction of seals, J.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seal_friction_j: Option<f64>,
    /// Remainder of the balance, J: positive for energy of unknown origin.
    pub remainder_j: f64,
    /// Remainder as a share of the larger work; `None` if both works are rounding.
    pub remainder_share: Option<f64>,
    /// Error of the remainder from the signal between the account's entries, J.
    #[serde(default)]
    pub remainder_off_j: f64,
    /// Error of the losses from the signal between the account's entries, J.
    #[serde(default)]
    pub lost_off_j: f64,
}

impl EnergyAudit {
    /// Returns the remainder as a share of the larger work; `None` if the works are rounding of the account's largest energy
    /// `held_j`.
    pub fn share(remainder_j: f64, driver_j: f64, load_j: f64, held_j: f64) -> Option<f64> {
        let work = driver_j.abs().max(load_j.abs());
        (work > ROUNDING * held_j).then_some(remainder_j / work)
    }

    /// Returns the overlap of the account's interval with `from_s` to `to_s`, as a share of the span of both together.
    pub fn overlap(&self, from_s: f64, to_s: f64) -> f64 {
        let both = self.to_s.min(to_s) - self.from_s.max(from_s);
        both / (self.to_s.max(to_s) - self.from_s.min(from_s))
    }

    /// Returns the mean power at input shaft and load, W, from works, which include the signal between samples; `None` if the
    /// account covers another time.
    pub fn mean_powers(&self, from_s: f64, to_s: f64) -> Option<[f64; 2]> {
        let time = self.to_s - self.from_s;
        let is_of = self.overlap(from_s, to_s) > SAME;
        is_of.then(|| [self.driver_j / time, -self.load_j / time])
    }
}

/// Overlap from which on a window and an account, whose ends are samples, cover the same time.
const SAME: f64 = 0.98;
/// Share of the summed energies below which a work is rounding.
const ROUNDING: f64 = 1e-11;

/// Largest ratio of powers that is an efficiency: above it stored energy exceeds the transmitted energy.
const MOST_EFFICIENT: f64 = 2.0;

/// Least share of the power created or destroyed by a contact law that makes an efficiency meaningless.
pub const CREATED: f64 = 1e-3;
/// Reason why a scene without friction has no efficiency.
pub const NO_LOSS: &str = "no loss modelled: the scene has no friction";
/// Reason why an engine without an energy account has no efficiency above 1.
pub const ABOVE_ONE: &str =
    "above 1: what the contact law creates is in it, and this engine keeps no account of that";

/// Returns power out over power in, both in W.
///
/// # Errors
/// Reason why the ratio is no efficiency.
pub fn efficiency(power_in: f64, power_out: f64) -> Result<f64, &'static str> {
    if !(power_in > 0.0) {
        return Err("no power goes in");
    }
    let efficiency = power_out / power_in;
    if efficiency.abs() <= MOST_EFFICIENT {
        Ok(efficiency)
    } else {
        Err("the output's power does not come from the input in this window")
    }
}

/// Returns the mean power at input shaft and load over `samples`, W, for a driver speed of `speed_rad_s`; `None` if a channel
/// is missing.
pub fn mean_powers(
    time_series: &TimeSeries,
    samples: std::ops::Range<usize>,
    speed_rad_s: f64,
) -> Option<[f64; 2]> {
    let mean = |name: &str| View::of(time_series, &[name], samples.clone())?.mean();
    let change = |values: &[f64]| {
        let part = values.get(samples.clone())?;
        Some(part.last()? - part.first()?)
    };
    let turned = change(time_series.channel(columns::OUTPUT_ANGLE)?)?;
    Some([
        mean(columns::INPUT_TORQUE)? * speed_rad_s,
        mean(columns::OUTPUT_TORQUE)? * turned / change(time_series.time_s())?,
    ])
}

/// Ending of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum Ending {
    /// Complete time series; only these are judged.
    Finished,
    /// Diverged solution; its time series up to then are shown, not judged.
    Diverged {
        /// Time of the divergence, s.
        time_s: f64,
        /// Quantity that diverged, and its value.
        quantity: String,
    },
    /// Scene that the engine does not support; engines never approximate silently.
    Unsupported {
        /// Unsupported part of the scene, and the reason.
        reason: String,
    },
    /// Missing package, compiler or library on this machine. A recording may replace the run.
    Absent {
        /// Name of the missing part, and its installation.
        reason: String,
    },
    /// Failure of the engine.
    Failed {
        /// Message of the engine.
        reason: String,
    },
    /// Run stopped by a time limit.
    TimedOut {
        /// Simulated time reached, s.
        time_s: f64,
        /// Time limit or time needed, and the remedy.
        reason: String,
    },
}

impl Ending {
    /// Ending for a scene that the engine does not support.
    pub fn unsupported(reason: impl ToString) -> Self {
        Self::Unsupported {
            reason: reason.to_string(),
        }
    }

    /// Ending for a missing part on this machine.
    pub fn absent(reason: impl ToString) -> Self {
        Self::Absent {
            reason: reason.to_string(),
        }
    }

    /// Ending for a failed engine.
    pub fn failed(reason: impl ToString) -> Self {
        Self::Failed {
            reason: reason.to_string(),
        }
    }

    /// True for complete time series.
    pub fn is_finished(&self) -> bool {
        *self == Self::Finished
    }

    /// True if the engine ran but failed or diverged.
    pub fn is_broken(&self) -> bool {
        matches!(self, Self::Diverged { .. } | Self::Failed { .. })
    }

    /// True if another attempt or machine may give another ending.
    pub fn may_pass(&self) -> bool {
        matches!(
            self,
            Self::Absent { .. } | Self::Failed { .. } | Self::TimedOut { .. }
        )
    }

    /// Words for tables, one for each ending.
    pub const WORDS: [&str; 6] = [
        "finished",
        "diverged",
        "unsupported",
        "absent",
        "failed",
        "timed out",
    ];

    /// Returns one or two words for tables.
    pub fn word(&self) -> &'static str {
        Self::WORDS[match self {
            Self::Finished => 0,
            Self::Diverged { .. } => 1,
            Self::Unsupported { .. } => 2,
            Self::Absent { .. } => 3,
            Self::Failed { .. } => 4,
            Self::TimedOut { .. } => 5,
        }]
    }

    /// Returns the reason why the run is not judged; `None` when finished.
    pub fn reason(&self) -> Option<String> {
        match self {
            Self::Finished => None,
            Self::Unsupported { reason } => Some(format!("left out: {reason}")),
            Self::Absent { reason } => {
                Some(format!("left out: it is not on this machine: {reason}"))
            }
            other => Some(other.to_string()),
        }
    }

    /// Describes the failure of a run in tables of trials: `at t = 0.0034 s: ...`; `None` when finished.
    pub fn failure(&self) -> Option<String> {
        match self {
            Self::Finished => None,
            Self::Diverged { time_s, quantity } => {
                Some(format!("at t = {time_s:.4} s: {quantity}"))
            }
            other => Some(other.to_string()),
        }
    }

    /// Returns `Ok` if the run finished.
    ///
    /// # Errors
    /// Ending of a run that did not finish.
    pub fn finished(&self) -> Result<(), Self> {
        if self.is_finished() {
            Ok(())
        } else {
            Err(self.clone())
        }
    }
}

/// Continuation of the engine's name in a message.
impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Finished => write!(f, "finished"),
            Self::Diverged { time_s, quantity } => {
                write!(f, "diverged at t = {time_s:.6} s: {quantity}")
            }
            Self::Unsupported { reason } => write!(f, "cannot run this scene: {reason}"),
            Self::Absent { reason } => write!(f, "is not on this machine: {reason}"),
            Self::Failed { reason } => write!(f, "failed: {reason}"),
            Self::TimedOut { reason, .. } => write!(f, "timed out: {reason}"),
        }
    }
}

impl std::error::Error for Ending {}
