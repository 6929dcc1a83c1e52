//! Numerical uncertainty of a run, from the same engine's runs at coarser settings.
//!
//! A [`Ladder`] has the runs and estimates one quantity in one window; [`Evidence`] is a participant's input, and
//! [`crate::uncertainties`] evaluates all its quantities.

use serde::{Deserialize, Serialize};

use crate::windows::{Window, WindowKind};
pub use pinwheel_timeseries::RecordedUncertainty;
pub use pinwheel_timeseries::convergence::{self as order, Basis, Estimate, Method, Unresolved};
pub use pinwheel_timeseries::ladder::{Ladder, Level};

/// Uncertainty of one figure, or the reason why it is unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum Uncertainty {
    /// Estimated uncertainty.
    Known(Estimate),
    /// Reason why the uncertainty is unknown.
    Unknown(Unresolved),
}

impl Uncertainty {
    /// Returns the estimate; `None` if unknown.
    pub fn estimate(&self) -> Option<&Estimate> {
        match self {
            Self::Known(estimate) => Some(estimate),
            Self::Unknown(_) => None,
        }
    }

    /// Returns the uncertainty in the unit of the quantity; `None` if unknown.
    pub fn u(&self) -> Option<f64> {
        self.estimate().map(|e| e.u)
    }

    /// Returns the uncertainty of a recording.
    pub(crate) fn recorded(u: Option<f64>) -> Self {
        let missing = || Unresolved::new("it was not known when it was recorded", "run it live");
        u.map(Estimate::stated).ok_or_else(missing).into()
    }
}

impl From<Result<Estimate, Unresolved>> for Uncertainty {
    fn from(estimate: Result<Estimate, Unresolved>) -> Self {
        estimate.map_or_else(Self::Unknown, Self::Known)
    }
}

/// Norm in which an uncertainty is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Norm {
    /// Root mean square of the error over all channels and samples.
    L2,
    /// Largest error of the series.
    Linf,
    /// Error of the mean.
    Mean,
    /// Error of the largest magnitude.
    Peak,
    /// Error of the root mean square.
    Rms,
}

/// Uncertainties of one quantity in one window, each in the quantity's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuantityUncertainty {
    /// Quantity name.
    pub quantity: String,
    /// Window.
    pub window: WindowKind,
    /// Root mean square of the series' error.
    pub l2: Uncertainty,
    /// Largest error of the series.
    pub linf: Uncertainty,
    /// Error of the mean.
    pub mean: Uncertainty,
    /// Error of the peak.
    pub peak: Uncertainty,
    /// Error of the root mean square.
    pub rms: Uncertainty,
    /// `l2` over the quantity's own RMS, to be compared with the 1 % of the resolution. `None` for a series of zeros.
    pub relative_l2: Option<f64>,
}

impl QuantityUncertainty {
    /// Returns the uncertainty in one norm.
    pub fn of(&self, norm: Norm) -> &Uncertainty {
        match norm {
            Norm::L2 => &self.l2,
            Norm::Linf => &self.linf,
            Norm::Mean => &self.mean,
            Norm::Peak => &self.peak,
            Norm::Rms => &self.rms,
        }
    }

    /// Converts the uncertainty to the form stored with a recording of the window.
    pub fn to_record(&self, window: &Window) -> RecordedUncertainty {
        RecordedUncertainty {
            quantity: self.quantity.clone(),
            from_s: window.from_s,
            to_s: window.to_s,
            l2: self.l2.u(),
            linf: self.linf.u(),
            mean: self.mean.u(),
            peak: self.peak.u(),
            rms: self.rms.u(),
        }
    }

    /// Makes an uncertainty from those in each norm, and from `l2` as a share, which counts if it is finite.
    pub(crate) fn new(
        quantity: &str,
        window: WindowKind,
        norms: [Uncertainty; 5],
        relative_l2: Option<f64>,
    ) -> Self {
        let [l2, linf, mean, peak, rms] = norms;
        Self {
            quantity: quantity.to_owned(),
            window,
            l2,
            linf,
            mean,
            peak,
            rms,
            relative_l2: relative_l2.filter(|share| share.is_finite()),
        }
    }
}

/// Evidence for the distance of a participant's results from the exact solution of its own equations.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Name of the participant.
    pub engine: String,
    /// Evidence of the uncertainty.
    pub source: Source,
    /// Reason why no setting reduces the uncertainty, e.g. an exhausted time limit. An inconclusive verdict then requires
    /// no action. `None` where a setting would help.
    pub is_final: Option<Final>,
}

/// Reason why no setting of the user's reduces a participant's uncertainty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Final {
    /// Plural name of participants of this kind, e.g. `recordings`.
    pub group: &'static str,
    /// Reason for this participant.
    pub reason: String,
}

/// Evidence of an uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// Coarser runs of the same engine.
    Refinement(Ladder),
    /// Uncertainties written down with a recording ([`QuantityUncertainty::to_record`]).
    Recorded(Vec<RecordedUncertainty>),
    /// Exact solution but for rounding, e.g. a closed form. The value is the rounding error as a share of a quantity's RMS.
    Exact(f64),
    /// No evidence, with the reason.
    Unknown(Unresolved),
}

impl Evidence {
    /// Returns evidence from coarser runs.
    pub fn refinement(engine: impl Into<String>, ladder: Ladder) -> Self {
        Self::of(engine, Source::Refinement(ladder))
    }

    fn of(engine: impl Into<String>, source: Source) -> Self {
        Self {
            engine: engine.into(),
            source,
            is_final: None,
        }
    }

    /// Returns an unknown uncertainty of a participant with its reason.
    pub fn unknown(
        engine: impl Into<String>,
        reason: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::of(engine, Source::Unknown(Unresolved::new(reason, remedy)))
    }

    /// Adds an error floor, as a share of every quantity: the error of the engine's iterations, which coarser runs do not
    /// reveal.
    #[must_use]
    pub fn with_floor(mut self, floor: f64) -> Self {
        if let Source::Refinement(ladder) = &mut self.source {
            ladder.floor = ladder.floor.max(floor);
        }
        self
    }

    /// Marks a participant that can provide no sharper evidence, with the name of its group and the reason.
    #[must_use]
    pub fn finally(self, group: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self {
            is_final: Some(Final { group, reason }),
            ..self
        }
    }
}

/// Bound of the summed rounding errors of the steps, in standard deviations of their random walk: the measured 2e-12 over 60
/// 000 steps is 37 of them.
const WALK: f64 = 64.0;

/// Returns the rounding error of a run of `steps` steps, as a share of a quantity's RMS: errors of 2^-52 a step that add up as
/// a random walk.
pub fn rounding_floor(steps: u64) -> f64 {
    WALK * f64::EPSILON * (steps.max(1) as f64).sqrt()
}
