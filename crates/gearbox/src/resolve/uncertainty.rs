//! Estimate of a run's numerical error.

use pinwheel_timeseries::ladder::Ladder;
use serde::{Deserialize, Serialize};

use crate::Distance;

/// One run of a refinement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Method of the run.
    pub integrator: String,
    /// Setting that determines the level's steps, in words.
    pub setting: String,
    /// Number of evaluations of the forces.
    pub evaluations: u64,
    /// Distance of the forces from those of the previous level, if that finished.
    pub moved: Option<Distance>,
    /// Description of the level's failure.
    pub failure: Option<String>,
}

/// Outcome of the comparison with the target.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Verdict {
    /// The target was reached.
    Resolved,
    /// Target not reached; the reached accuracy is [`Uncertainty::error`].
    NotResolved {
        /// Reason why the refinement ended.
        reason: String,
        /// Action that would help.
        remedy: String,
    },
}

/// Numerical uncertainty of a run, and the runs from which it was estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// Requested target: relative L2 of the forces and of the driver's torque.
    pub target: f64,
    /// Estimated bounds of the error; `None` if only one run finished.
    pub error: Option<Distance>,
    /// Outcome of the comparison with the target.
    pub verdict: Verdict,
    /// Index of the run whose time series are returned.
    pub chosen: usize,
    /// All runs, in order.
    pub levels: Vec<Level>,
    /// Coarser runs by the method of the chosen one, with their time series; `None` if they are no evidence of its error.
    #[serde(skip)]
    pub ladder: Option<Ladder>,
}

impl Uncertainty {
    /// True if the target was reached.
    pub fn is_resolved(&self) -> bool {
        self.verdict == Verdict::Resolved
    }

    /// Returns the run whose time series are returned.
    pub fn chosen(&self) -> Option<&Level> {
        self.levels.get(self.chosen)
    }

    /// Returns the cost of the verification: evaluations of all runs over those of the chosen one.
    pub fn cost(&self) -> f64 {
        let all: u64 = self.levels.iter().map(|level| level.evaluations).sum();
        let one = self.chosen().map_or(0, |level| level.evaluations);
        all as f64 / one.max(1) as f64
    }

    /// Returns remarks for the reader: the result and its cost.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![self.sentence()];
        let failed = self.levels.iter().filter(|level| level.failure.is_some());
        if let Some(first) = failed.clone().next() {
            let failed = failed.count();
            let why = first.failure.as_deref().unwrap_or_default();
            notes.push(format!(
                "{failed} of {} runs failed, the first ({}, {}) at {why}.",
                self.levels.len(),
                first.integrator,
                first.setting
            ));
        }
        notes
    }

    /// Returns one sentence with the estimated error, its evidence and its cost.
    pub fn sentence(&self) -> String {
        let (method, setting) = self.chosen().map_or(("", ""), |level| {
            (level.integrator.as_str(), level.setting.as_str())
        });
        let known = match self.error {
            Some(error) => format!(
                "numerical uncertainty {:.1e} in the forces, {:.1e} in the driver's torque (relative L2)",
                error.forces, error.driver_torque
            ),
            None => "numerical uncertainty not known".to_owned(),
        };
        let cost = format!(
            "{method} at {setting}, {} runs, {:.2} times the cost of the last",
            self.levels.len(),
            self.cost()
        );
        match &self.verdict {
            Verdict::Resolved => {
                format!("Resolved: {known}, {:.0e} asked for; {cost}.", self.target)
            }
            Verdict::NotResolved { reason, remedy } => format!(
                "Not resolved: {known}, {:.0e} asked for; {reason}; {cost}. {remedy}",
                self.target
            ),
        }
    }
}

/// Returns the remedy for a run that was not resolved.
pub fn remedy(target: f64, error: Option<Distance>, budget: u64) -> String {
    let reached = error.map(|e| e.worst()).filter(|e| e.is_finite());
    match reached {
        Some(worst) if worst < 0.1 => format!(
            "Its figures hold to {worst:.0e}; a shorter solver.duration_s or more than {:.0e} evaluations would \
             bring {target:.0e}.",
            budget as f64
        ),
        Some(_) => {
            "Its forces are not to be trusted as a course: errors grow from impact to impact; look at a shorter \
             solver.duration_s, or give the contacts damping."
                .to_owned()
        }
        None => format!(
            "Nothing is known of its error; a shorter solver.duration_s or more than {:.0e} evaluations would measure it.",
            budget as f64
        ),
    }
}
