//! What verdicts are made by.

use crate::limits::StatedLimit;
use crate::model::{self, ModelTolerance};
use crate::uncertainty::Evidence;
use crate::validation::DataUncertainty;

/// What verdicts are made by. `Rules::default()` has the project's tables and no evidence.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// Limits stated for measured participants.
    pub stated: &'a [StatedLimit],
    /// Numerical uncertainty of the participants. With evidence for one, whatever is compared with others without is
    /// *inconclusive*; without any, engines are not compared at all.
    pub evidence: &'a [Evidence],
    /// How far own-contact engines state to be from the native model.
    pub tolerances: &'a [ModelTolerance],
    /// Uncertainty of measured data and of the inputs.
    pub data: &'a [DataUncertainty],
    /// The largest U that still proves agreement, relative.
    pub resolution: f64,
}

impl Rules<'_> {
    /// The evidence of a participant.
    pub(crate) fn evidence_of(&self, name: &str) -> Option<&Evidence> {
        self.evidence.iter().find(|one| one.engine == name)
    }
}

impl Default for Rules<'_> {
    fn default() -> Self {
        Self {
            stated: &[],
            evidence: &[],
            tolerances: model::TOLERANCES,
            data: &[],
            resolution: RESOLUTION,
        }
    }
}

/// One per cent.
pub const RESOLUTION: f64 = 0.01;
