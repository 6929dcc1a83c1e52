//! Rules of the verdicts.

use crate::limits::StatedLimit;
use crate::model::ModelTolerance;
use crate::uncertainty::Evidence;
use crate::validation::DataUncertainty;

/// Rules of the verdicts. `Rules::default()` has neither tables nor evidence.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// Names of the participants that the user brought: solvers and records. [`findings`](crate::Comparison::findings) has a line
    /// for each.
    pub brought: &'a [&'a str],
    /// Limits stated for measured participants.
    pub stated: &'a [StatedLimit],
    /// Numerical uncertainty of the participants. If any participant has evidence, a comparison with one that has none is
    /// *inconclusive*; without evidence for any, engines are not compared.
    pub evidence: &'a [Evidence],
    /// Stated tolerances of engines, by name, against the native model; for each quantity and metric the first match applies.
    pub tolerances: &'a [(&'a str, ModelTolerance)],
    /// Uncertainty of measured data and of the inputs.
    pub data: &'a [DataUncertainty],
    /// Largest relative U with which agreement is conclusive.
    pub resolution: f64,
}

impl Rules<'_> {
    /// Returns the evidence of a participant.
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

/// Default resolution: 1 %.
pub const RESOLUTION: f64 = 0.01;
