//! Verdict on a new run against the accepted one.

use serde::Serialize;

use super::file::{CaseSnapshot, Converged, QuantitySnapshot};
use super::limits;
use super::runner::Costs;
use super::snapshot::{Quantity, Statistics};

/// Change of a figure; the most urgent last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Equal to rounding.
    #[default]
    Same,
    /// Moved, with an error as large as before.
    Changed,
    /// Closer to the converged result, or cheaper.
    Better,
    /// Closer to the converged result and more expensive, by no larger a factor.
    Traded,
    /// Not in the baseline, so not compared.
    New,
    /// Farther from the converged result, or more expensive.
    Worse,
}

impl Verdict {
    /// Returns the verdict as text.
    pub fn label(self) -> &'static str {
        match self {
            Self::Same => "same to rounding",
            Self::Changed => "changed within limits",
            Self::Better => "better",
            Self::Traded => "traded",
            Self::New => "not in the baseline",
            Self::Worse => "worse",
        }
    }
}

/// Check of one quantity of one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityCheck {
    /// Quantity that is checked.
    pub quantity: Quantity,
    /// Label of the quantity.
    pub label: &'static str,
    /// Root mean square change of the statistics against the accepted run, a share of the quantity's size.
    pub change: f64,
    /// Largest change that counts as rounding.
    pub rounding_limit: f64,
    /// Error of the accepted run against the converged one, a share of the size.
    pub error_before: f64,
    /// Error of the new run.
    pub error_after: f64,
    /// Change of the error that is neither better nor worse.
    pub error_limit: f64,
    /// Means, accepted and new.
    pub mean: [f64; 2],
    /// Largest magnitudes, accepted and new.
    pub peak: [f64; 2],
    /// Verdict on the quantity.
    pub verdict: Verdict,
}

/// Check of one cost of one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostCheck {
    /// Name of the cost.
    pub label: &'static str,
    /// Cost of the accepted run.
    pub before: f64,
    /// Cost of the new run.
    pub after: f64,
    /// Permitted change of the cost.
    pub limit: f64,
    /// Verdict on the cost.
    pub verdict: Verdict,
}

/// Checks one quantity; `after` are the new statistics. `None` if their shape differs from the accepted ones.
pub fn quantity(
    quantity: Quantity,
    after: &Statistics,
    accepted: &QuantitySnapshot,
    converged: &Converged,
) -> Option<QuantityCheck> {
    let share = |distance: f64| distance / converged.scale;
    let change = share(after.distance(&accepted.statistics)?);
    let rounding_limit = limits::same_up_to(accepted.rounding);
    let error_before = accepted.error;
    let error_after = share(after.distance(&converged.statistics)?);
    let error_limit = limits::ERROR_SHARE * error_before + converged.own_error + rounding_limit;
    let verdict = if change <= rounding_limit {
        Verdict::Same
    } else if error_after < error_before - error_limit {
        Verdict::Better
    } else if error_after <= error_before + error_limit {
        Verdict::Changed
    } else {
        Verdict::Worse
    };
    let before = &accepted.statistics;
    Some(QuantityCheck {
        quantity,
        label: quantity.label(),
        change,
        rounding_limit,
        error_before,
        error_after,
        error_limit,
        mean: [before.whole_mean(), after.whole_mean()],
        peak: [before.whole_peak(), after.whole_peak()],
        verdict,
    })
}

/// Checks all costs of a case. `adaptive` is true where a step control chose the steps.
pub(super) fn costs(accepted: &CaseSnapshot, after: &Costs, adaptive: bool) -> Vec<CostCheck> {
    let before = accepted.costs;
    let share = if adaptive {
        limits::ADAPTIVE_COUNT_SHARE.max(limits::FLIP_MARGIN * accepted.count_spread)
    } else {
        0.0
    };
    let mut checks = Vec::new();
    // A cost may change by `share` of itself and by `room`; less is better.
    let mut add = |label, of: fn(&Costs) -> u64, share: f64, room: f64| {
        let [before, after] = [&before, after].map(|costs| of(costs) as f64);
        let limit = share * before + room;
        checks.push(CostCheck {
            label,
            before,
            after,
            limit,
            verdict: cost(before, after, limit),
        });
    };
    add("right-hand sides", |c| c.right_hand_sides, share, 0.0);
    add("steps", |c| c.steps, share, 0.0);
    if adaptive {
        let room = limits::REJECTIONS + share * before.steps as f64;
        add("rejections", |c| c.rejections, 0.0, room);
    }
    if before.newton_steps + after.newton_steps > 0 {
        let share = limits::NEWTON_SHARE.max(share);
        add("Newton steps", |c| c.newton_steps, share, 0.0);
    }
    checks
}

/// Returns the verdict on a case, the most urgent of its figures. More cost with less error is a trade if the largest error
/// fell by at least the factor of the counts.
pub fn case(quantities: &[QuantityCheck], costs: &[CostCheck]) -> Verdict {
    let verdicts = quantities.iter().map(|q| q.verdict);
    let accuracy = verdicts.max().unwrap_or(Verdict::New);
    let worst = costs.iter().map(|cost| cost.verdict).max();
    let farthest = quantities.iter().filter(|q| q.verdict == Verdict::Better);
    let farthest = farthest.max_by(|a, b| a.error_before.total_cmp(&b.error_before));
    if let (Verdict::Better, Some(Verdict::Worse), Some(most)) = (accuracy, worst, farthest) {
        let dearer = costs.iter().map(|cost| cost.after / cost.before.max(1.0));
        let dearer = dearer.fold(0.0, f64::max);
        if dearer * most.error_after <= (1.0 + limits::ERROR_SHARE) * most.error_before {
            return Verdict::Traded;
        }
    }
    worst.unwrap_or_default().max(accuracy)
}

/// Returns the verdict on the change of a cost, where less is better.
pub fn cost(before: f64, after: f64, limit: f64) -> Verdict {
    if after - before > limit {
        Verdict::Worse
    } else if before - after > limit {
        Verdict::Better
    } else {
        Verdict::Same
    }
}
