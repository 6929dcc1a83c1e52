//! The numerical uncertainty of a run, from the same engine's runs at coarser settings.
//!
//! A [`Ladder`] holds the runs and estimates one quantity in one window; [`Evidence`] is what a participant brings, and
//! [`crate::uncertainties`] what follows for all its quantities.

use serde::{Deserialize, Serialize};

use crate::windows::{Window, WindowKind};
pub use pinwheel_timeseries::RecordedUncertainty;
pub use pinwheel_timeseries::convergence::{self as order, Basis, Estimate, Method, Unresolved};
pub use pinwheel_timeseries::ladder::{Estimates, Ladder, Level};

/// Uncertainty of one figure, or the reason why it is not known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
pub enum Uncertainty {
    /// Known.
    Known(Estimate),
    /// Not known.
    Unknown(Unresolved),
}

impl Uncertainty {
    /// The estimate, if there is one.
    #[must_use]
    pub fn estimate(&self) -> Option<&Estimate> {
        match self {
            Self::Known(estimate) => Some(estimate),
            Self::Unknown(_) => None,
        }
    }

    /// The uncertainty in the unit of the quantity, if it is known.
    #[must_use]
    pub fn u(&self) -> Option<f64> {
        self.estimate().map(|e| e.u)
    }
}

impl From<Result<Estimate, Unresolved>> for Uncertainty {
    fn from(found: Result<Estimate, Unresolved>) -> Self {
        found.map_or_else(Self::Unknown, Self::Known)
    }
}

/// Norm in which an uncertainty is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Norm {
    /// The series, as root mean square of its error over all channels and samples.
    L2,
    /// The series, as its largest error.
    Linf,
    /// The mean.
    Mean,
    /// The largest magnitude.
    Peak,
    /// The root mean square.
    Rms,
}

/// The uncertainties of one quantity in one window, each in the quantity's unit.
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
    /// `l2` over the quantity's own RMS: what a reader compares with 1 %. `None` for a series of zeros.
    pub relative_l2: Option<f64>,
}

impl QuantityUncertainty {
    /// The uncertainty in one norm.
    #[must_use]
    pub fn of(&self, norm: Norm) -> &Uncertainty {
        match norm {
            Norm::L2 => &self.l2,
            Norm::Linf => &self.linf,
            Norm::Mean => &self.mean,
            Norm::Peak => &self.peak,
            Norm::Rms => &self.rms,
        }
    }

    /// To be written down with a recording of the window.
    #[must_use]
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

    /// Uncertainty of a recorded quantity whose root mean square in this window is `rms`.
    pub(crate) fn of_record(
        record: &RecordedUncertainty,
        window: WindowKind,
        rms: Option<f64>,
    ) -> Self {
        let known = |u: Option<f64>| match u {
            Some(u) => Uncertainty::Known(Estimate::stated(u)),
            None => Uncertainty::Unknown(Unresolved::new(
                "it was not known when it was recorded",
                "run it live",
            )),
        };
        Self {
            quantity: record.quantity.clone(),
            window,
            l2: known(record.l2),
            linf: known(record.linf),
            mean: known(record.mean),
            peak: known(record.peak),
            rms: known(record.rms),
            relative_l2: record
                .l2
                .zip(rms)
                .map(|(u, rms)| u / rms)
                .filter(|share| share.is_finite()),
        }
    }

    /// Uncertainty of a quantity that a ladder shows.
    pub(crate) fn of_estimates(quantity: &str, window: WindowKind, found: Estimates) -> Self {
        let [l2, linf, mean, peak, rms] = found.norms.map(Uncertainty::from);
        Self {
            quantity: quantity.to_owned(),
            window,
            l2,
            linf,
            mean,
            peak,
            rms,
            relative_l2: found.relative_l2,
        }
    }

    /// Uncertainty of a quantity that is `what` in every norm.
    pub(crate) fn everywhere(quantity: &str, window: WindowKind, what: &Uncertainty) -> Self {
        Self {
            quantity: quantity.to_owned(),
            window,
            l2: what.clone(),
            linf: what.clone(),
            mean: what.clone(),
            peak: what.clone(),
            rms: what.clone(),
            relative_l2: None,
        }
    }
}

/// Evidence of a participant for the distance of its numbers from the exact solution of its own equations.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Name of the participant.
    pub engine: String,
    /// Evidence of the uncertainty.
    pub source: Source,
    /// Why a number that is not sharp enough has to be accepted: a time limit is spent, say. What is then inconclusive
    /// leaves nothing to act on. `None` where a setting would do.
    pub is_final: Option<Final>,
}

/// Why no setting of the user's makes a participant's numbers sharper.
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
    /// Exact but for rounding: a closed form. The value is the floor, as a share of a quantity's RMS.
    Exact(f64),
    /// Not known.
    Unknown(Unresolved),
}

impl Evidence {
    /// Evidence from coarser runs.
    #[must_use]
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

    /// Makes the missing evidence of a participant, with the reason.
    pub fn unknown(
        engine: impl Into<String>,
        reason: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::of(engine, Source::Unknown(Unresolved::new(reason, remedy)))
    }

    /// Raises the share of every quantity that the engine's iterations leave, which coarser runs do not show.
    #[must_use]
    pub fn with_floor(mut self, floor: f64) -> Self {
        if let Source::Refinement(ladder) = &mut self.source {
            ladder.floor = ladder.floor.max(floor);
        }
        self
    }

    /// Marks a participant that can bring no sharper evidence, with the name of its group and the reason.
    #[must_use]
    pub fn finally(self, group: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self {
            is_final: Some(Final { group, reason }),
            ..self
        }
    }
}

/// Bound of the summed rounding errors of the steps, in root mean squares of their random walk: the measured 2e-12 over
/// 60 000 steps is 37 root mean squares.
const WALK: f64 = 64.0;

/// Rounding error of a run of `steps` steps, as a share of a quantity's RMS: errors of 2^-52 a step that add up as a
/// random walk.
#[must_use]
pub fn rounding_floor(steps: u64) -> f64 {
    WALK * f64::EPSILON * (steps.max(1) as f64).sqrt()
}
