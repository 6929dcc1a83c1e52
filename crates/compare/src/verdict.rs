//! Verdicts: what a limit says of a number.

use serde::Serialize;

use crate::limits::Metric;

/// Within, exceeded, or not judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "kebab-case")]
pub enum Verdict {
    /// The value is at or below its limit.
    Within,
    /// The value is above its limit, or is not a number.
    Exceeded,
    /// No limit applies.
    NotJudged {
        /// Why.
        reason: String,
    },
}

impl Verdict {
    /// The word used in tables: `within`, `exceeded`, `not judged`.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Within => "within",
            Self::Exceeded => "exceeded",
            Self::NotJudged { .. } => "not judged",
        }
    }
}

/// One number held against one limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Which metric.
    pub metric: Metric,
    /// Its value; `None` where the courses hold values that are not finite.
    pub value: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// What was measured when the limit was set.
    pub measured: Option<f64>,
    /// Why the limit is what it is.
    pub reason: String,
    /// True when within.
    pub within: bool,
}

/// How many verdicts of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Within.
    pub within: usize,
    /// Exceeded.
    pub exceeded: usize,
    /// Not judged.
    pub not_judged: usize,
}

impl Counts {
    /// Counts one more.
    pub fn add(&mut self, verdict: &Verdict) {
        match verdict {
            Verdict::Within => self.within += 1,
            Verdict::Exceeded => self.exceeded += 1,
            Verdict::NotJudged { .. } => self.not_judged += 1,
        }
    }
}
