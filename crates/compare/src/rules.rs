//! Rules by which verdicts are made.

use crate::limits::StatedLimit;
use crate::model::ModelTolerance;
use crate::uncertainty::Evidence;
use crate::validation::DataUncertainty;

/// Rules by which verdicts are made. `Rules::default()` has neither tables nor evidence.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// Names of the participants that the user brought: solvers and records. [`findings`](crate::Comparison::findings) has a line
    /// for each.
    pub brought: &'a [&'a str],
    /// Limits stated for measured participants.
    pub stated: &'a [StatedLimit],
    /// Numerical uncertainty of the participants. With evidence for one, whatever is compared with others without is
    /// *inconclusive*; without any, engines are not compared at all.
    pub evidence: &'a [Evidence],
    /// Stated tolerances of engines, by their names, against the native model; of each quantity and metric the first that fits counts.
    pub tolerances: &'a [(&'a str, ModelTolerance)],
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
            brought: &[],
            stated: &[],
            evidence: &[],
            tolerances: &[],
            data: &[],
            resolution: RESOLUTION,
        }
    }
}

/// One per cent.
pub const RESOLUTION: f64 = 0.01;
