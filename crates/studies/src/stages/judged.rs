//! Stages of a solver and their judgement.

use serde::Serialize;

/// Largest relative rounding error of an independent implementation of the law: search for the closest point, and summation.
pub(super) const ROUNDING: f64 = 1e-6;
/// Error of the native flow, as a share of the effect of the load.
pub(super) const FLOW: f64 = 1e-6;
/// Integration error below which no order is required, as a share of the effect of the load.
pub(super) const SMALL: f64 = 1e-4;
/// Least share of a residual that a cause must explain.
pub(super) const EXPLAINED: f64 = 0.9;
/// Least explained share if forces are exact to rounding: a wrong factor is then equal at all penetrations.
pub(super) const EXACT: f64 = 0.9999;
/// Least explained share if the error of the step is unknown.
pub(super) const SURE: f64 = 0.99;
/// Number of judged samples, besides those at changes of the load.
pub(super) const SAMPLES: usize = 40;
/// Accepted shortfall from the stated order, without and with friction. Contacts that open and close reduce the order, and
/// stick-slip of pins reduces it further.
pub(super) const ORDER_MARGIN: [f64; 2] = [0.7, 1.2];

/// Stage of a solver, in the order of judgement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// States at the start, and geometry.
    Start,
    /// Pairs that touch.
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

    /// Returns the name in words.
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
    /// Stage that is judged.
    pub stage: Stage,
    /// Residual, as a share of the native quantity; `None` if unknown.
    pub residual: Option<f64>,
    /// Bound of the residual, above which the stage is off.
    pub bound: f64,
    /// Place of the largest residual, or the columns needed for a judgement.
    pub note: String,
}

impl Judged {
    /// Creates the judgement of a stage with its residual, which is off above `bound`, and the place.
    pub(super) fn measured(stage: Stage, residual: f64, bound: f64, note: String) -> Self {
        let residual = Some(residual);
        Self {
            stage,
            residual,
            bound,
            note,
        }
    }

    /// Creates the judgement of a stage that cannot be judged, with the reason.
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

/// Formats a share in per cent.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        _ if (99.995..100.0).contains(&percent) => "100 %".to_owned(),
        _ if percent >= 10.0 => format!("{percent:.1} %"),
        _ if percent >= 0.01 => format!("{percent:.2} %"),
        _ => format!("{percent:.0e} %"),
    }
}
