//! Stages and their judgement.

use serde::Serialize;

/// Largest rounding of a law that somebody else wrote, as a share: its search for the closest point and its sums.
pub(super) const ROUNDING: f64 = 1e-6;
/// Error of the flow, as a share of what the load would do.
pub(super) const FLOW: f64 = 1e-6;
/// Error of the integration that no order is asked of, as a share of what the load would do: no verdict depends on less.
pub(super) const SMALL: f64 = 1e-4;
/// Share of a residual that a cause must explain.
pub(super) const EXPLAINED: f64 = 0.9;
/// Share that it must explain where forces are known to rounding: a factor is the same at all penetrations.
pub(super) const EXACT: f64 = 0.9999;
/// Share that it must explain where the step's own error is not known.
pub(super) const SURE: f64 = 0.99;
/// Samples that are looked at, but for those at changes of the load.
pub(super) const SAMPLES: usize = 40;
/// Order below that stated which is still right: contacts that open and close take some of it, and pins that stick and slip more.
pub(super) const ORDER_MARGIN: [f64; 2] = [0.7, 1.2];

/// Stage of a solver, in the order of judgement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// States at the start, and geometry.
    Start,
    /// Which pairs touch.
    ContactSearch,
    /// Forces of the contacts.
    Law,
    /// Sum of the forces, lever arms, moments.
    Assembly,
    /// Masses, inertia, load, kinematics.
    Equations,
    /// Torque of the driver.
    Driver,
    /// Order, events, jumps.
    Integration,
}

impl Stage {
    /// All stages.
    pub const ALL: [Self; 7] = [
        Self::Start,
        Self::ContactSearch,
        Self::Law,
        Self::Assembly,
        Self::Equations,
        Self::Driver,
        Self::Integration,
    ];

    /// Name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        const NAMES: [&str; Stage::ALL.len()] = [
            "start",
            "contact search",
            "law",
            "assembly",
            "equations",
            "driver",
            "integration",
        ];
        NAMES[self as usize]
    }
}

/// Judgement of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// The stage.
    pub stage: Stage,
    /// Residual, as a share of the native quantity; `None`: unknown.
    pub residual: Option<f64>,
    /// Residual from which the stage is off.
    pub bound: f64,
    /// Place of the largest residual, or the columns that it needs.
    pub note: String,
}

impl Judged {
    /// Creates a stage with its residual, which is off above `bound`, and the place.
    pub(super) fn measured(stage: Stage, residual: f64, bound: f64, note: String) -> Self {
        let residual = Some(residual);
        Self {
            stage,
            residual,
            bound,
            note,
        }
    }

    /// Creates a stage that cannot be judged, with the reason.
    pub(super) fn unknown(stage: Stage, note: &str) -> Self {
        let note = note.to_owned();
        Self {
            stage,
            residual: None,
            bound: ROUNDING,
            note,
        }
    }

    /// True if the stage is off.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.residual
            .is_some_and(|residual| !(residual <= self.bound))
    }
}

/// Returns a share in words.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        _ if (99.995..100.0).contains(&percent) => "100 %".to_owned(),
        _ if percent >= 10.0 => format!("{percent:.1} %"),
        _ if percent >= 0.01 => format!("{percent:.2} %"),
        _ => format!("{percent:.0e} %"),
    }
}
