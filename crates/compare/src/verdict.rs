//! Four verdicts and the evidence behind them.
//!
//! No engine is the truth. A difference D is compared with a bound: the numerical error U = uA + uB of both, a model's
//! tolerance, the uncertainty of a measurement, or a limit that a user states.

use std::cmp::Ordering;

use serde::Serialize;

use crate::metrics::Metric;
use crate::uncertainty::{Estimate, Unresolved};
use crate::validation::Budget;

/// Conclusion from a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Difference within the bound.
    Agree,
    /// Difference larger than the bound.
    Differ,
    /// Numerical uncertainty too large or unknown, so that neither agreement nor difference follows.
    Inconclusive,
    /// No bound exists for the difference.
    #[default]
    NotCompared,
}

impl Verdict {
    /// Returns the word for readers.
    pub fn word(self) -> &'static str {
        match self {
            Self::Agree => "agree",
            Self::Differ => "differ",
            Self::Inconclusive => "inconclusive",
            Self::NotCompared => "not compared",
        }
    }
}

/// Kind of bound with which a difference is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// Numerical uncertainty of both engines.
    #[default]
    NumericalError,
    /// Numerical uncertainty and the stated tolerance of an engine's contact model.
    ModelTolerance,
    /// Uncertainty of measured data, of the inputs and of the numerics (ASME V&V 20).
    Measurement,
    /// Limit of the user's, or of the torque balance.
    Limit,
}

impl Against {
    /// Returns the words for readers.
    pub fn word(self) -> &'static str {
        match self {
            Self::NumericalError => "numerical error",
            Self::ModelTolerance => "model tolerance",
            Self::Measurement => "measurement",
            Self::Limit => "limit",
        }
    }
}

/// Verdict with its evidence. All figures are relative, as the metric is (see [`Metric`]).
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Assessment {
    /// Verdict on the difference.
    pub verdict: Verdict,
    /// Kind of bound with which the difference was compared.
    pub against: Against,
    /// Metric of the difference; `None` where nothing was measured.
    pub metric: Option<Metric>,
    /// Difference D, signed where the prediction has a sign; `None` if missing or not finite.
    #[serde(rename = "value")]
    pub difference: Option<f64>,
    /// Predicted difference, which is subtracted.
    #[serde(skip_serializing_if = "is_zero")]
    pub predicted: f64,
    /// Largest difference that counts as agreement; `None` if unknown.
    pub bound: Option<f64>,
    /// Tolerance of the models, as part of the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Uncertainty of the first participant.
    pub u_a: Option<f64>,
    /// Uncertainty of the second participant.
    pub u_b: Option<f64>,
    /// Parts of the validation uncertainty, for measured data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budget: Option<Budget>,
    /// Participant whose uncertainty is too large or unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub participant: Option<String>,
    /// Reason of an inconclusive or missing verdict, of a limit or of a tolerance.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// Setting that would give a conclusive verdict.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub remedy: String,
    /// True if the verdict requires an action of the user.
    pub actionable: bool,
    /// Plural name of participants that can provide nothing sharper, e.g. `recordings`; empty for all others.
    #[serde(skip)]
    pub group: &'static str,
    /// True if the verdict decides about its quantity; all others are for information.
    pub decides: bool,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // as serde calls it
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Assessment {
    /// Returns the assessment of a difference without a bound, with the reason.
    pub fn not_compared(reason: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            decides: true,
            ..Self::default()
        }
    }

    /// Compares a figure with a limit; a figure that is not finite exceeds every limit.
    pub fn limit(metric: Metric, value: Option<f64>, limit: f64, reason: &str) -> Self {
        let holds = value.is_some_and(|value| value <= limit);
        Self {
            against: Against::Limit,
            metric: Some(metric),
            difference: value,
            bound: Some(limit),
            ..Self::not_compared(reason)
        }
        .decided(holds)
    }

    /// Marks the assessment as inconclusive because of `participant`.
    #[must_use]
    pub fn inconclusive(self, participant: &str, reason: String, remedy: String) -> Self {
        Self {
            verdict: Verdict::Inconclusive,
            participant: Some(participant.to_owned()),
            reason,
            remedy,
            actionable: true,
            ..self
        }
    }

    fn decided(self, agree: bool) -> Self {
        let verdict = if agree {
            Verdict::Agree
        } else {
            Verdict::Differ
        };
        Self {
            verdict,
            actionable: !agree,
            ..self
        }
    }

    /// Marks an inconclusive verdict as one without an action, because its participant can provide nothing sharper.
    pub(crate) fn beyond_settings(mut self, group: &'static str, reason: &str) -> Self {
        if self.verdict == Verdict::Inconclusive {
            self.reason = format!("{}; {reason}", self.reason);
            self.group = group;
            self.actionable = false;
            self.remedy.clear();
        }
        self
    }

    /// Returns U; `None` unless both uncertainties are known.
    pub fn combined(&self) -> Option<f64> {
        Some(self.u_a? + self.u_b?)
    }

    /// Returns the interval of the difference of two models, or of a model's error: the difference +- its uncertainty.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let half = match self.against {
            Against::ModelTolerance => self.combined()?,
            Against::Measurement => self.bound?,
            Against::NumericalError | Against::Limit => return None,
        };
        let middle = self.difference?;
        Some([middle - half, middle + half])
    }

    /// Returns difference over bound. An inconclusive verdict counts its uncertainty as the difference; an unknown
    /// uncertainty is infinite.
    pub fn share(&self) -> f64 {
        if self.verdict == Verdict::Inconclusive {
            return self.combined().unwrap_or(f64::INFINITY);
        }
        match (self.difference, self.bound) {
            (Some(difference), Some(bound)) => {
                let off = (difference - self.predicted).abs();
                if off == 0.0 { 0.0 } else { off / bound }
            }
            _ => f64::INFINITY,
        }
    }

    /// Returns the rank of gravity, rising: not compared, agree, inconclusive without an action, inconclusive, differ.
    pub fn rank(&self) -> u8 {
        match (self.verdict, self.actionable) {
            (Verdict::NotCompared, _) => 0,
            (Verdict::Agree, _) => 1,
            (Verdict::Inconclusive, false) => 2,
            (Verdict::Inconclusive, true) => 3,
            (Verdict::Differ, _) => 4,
        }
    }

    /// Compares by [rank](Self::rank), then by the used share of the bound.
    pub fn graver(&self, other: &Self) -> Ordering {
        let by_rank = self.rank().cmp(&other.rank());
        by_rank.then(self.share().total_cmp(&other.share()))
    }

    /// Returns the item with the [gravest](Self::graver) assessment, the first of equals; `of` returns the assessment of an
    /// item.
    pub fn gravest<T>(all: impl IntoIterator<Item = T>, of: impl Fn(&T) -> &Self) -> Option<T> {
        all.into_iter()
            .reduce(|worst, other| match of(&other).graver(of(&worst)) {
                Ordering::Greater => other,
                _ => worst,
            })
    }
}

/// Number of verdicts of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Verdicts *agree*.
    pub agree: usize,
    /// Verdicts *differ*.
    pub differ: usize,
    /// Verdicts *inconclusive*.
    pub inconclusive: usize,
    /// Verdicts *not compared*.
    pub not_compared: usize,
    /// Differing verdicts that require an action; the error of a model against a measurement does not.
    pub differ_actionable: usize,
    /// Inconclusive verdicts that a setting would settle.
    pub inconclusive_actionable: usize,
}

impl Counts {
    /// Adds one assessment.
    pub fn add(&mut self, one: &Assessment) {
        let [all, actionable] = match one.verdict {
            Verdict::Agree => [&mut self.agree, &mut 0],
            Verdict::Differ => [&mut self.differ, &mut self.differ_actionable],
            Verdict::Inconclusive => [&mut self.inconclusive, &mut self.inconclusive_actionable],
            Verdict::NotCompared => [&mut self.not_compared, &mut 0],
        };
        *all += 1;
        *actionable += usize::from(one.actionable);
    }

    /// Returns the number of quantities that were compared.
    pub fn compared(&self) -> usize {
        self.agree + self.differ + self.inconclusive
    }

    /// Returns the exit status of these verdicts: 1 with a difference, 4 if a setting would resolve an inconclusive verdict,
    /// else 0.
    pub fn exit_status(&self) -> u8 {
        if self.differ_actionable > 0 {
            1
        } else if self.inconclusive_actionable > 0 {
            4
        } else {
            0
        }
    }
}

/// Side of a pair, as input of a verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Side<'a> {
    /// Name of the participant.
    pub name: &'a str,
    /// Relative uncertainty of the engine, or the reason for its absence.
    pub uncertainty: Result<Estimate, Unresolved>,
}

impl<'a> Side<'a> {
    /// Returns a side with a known relative uncertainty.
    pub fn known(name: &'a str, estimate: Estimate) -> Self {
        Self {
            name,
            uncertainty: Ok(estimate),
        }
    }

    /// Returns the relative uncertainty, if it is known.
    pub fn u(&self) -> Option<f64> {
        self.uncertainty.as_ref().ok().map(|e| e.u)
    }
}

/// Returns the assessment of a difference in a metric of two sides, before the comparison with a bound.
fn between(
    metric: Metric,
    difference: f64,
    against: Against,
    [a, b]: [&Side<'_>; 2],
) -> Assessment {
    Assessment {
        against,
        metric: Some(metric),
        difference: Some(difference),
        u_a: a.u(),
        u_b: b.u(),
        ..Assessment::not_compared("")
    }
}

/// Returns the combined uncertainty U of two sides, or the side with an unknown uncertainty and its reason.
///
/// U = uA + uB: both are bounds of errors fixed by the settings. These errors are neither random nor independent (two engines
/// may share a method), so they must not be added as squares.
///
/// # Errors
/// Side with an unknown uncertainty.
fn combined<'a>([a, b]: [&'a Side<'a>; 2]) -> Result<f64, (&'a str, Unresolved)> {
    let of = |side: &'a Side<'a>| match &side.uncertainty {
        Ok(estimate) => Ok(estimate.u),
        Err(missing) => Err((side.name, missing.clone())),
    };
    Ok(of(a)? + of(b)?)
}

/// Multiple of U that a difference must exceed where no order was confirmed.
pub const UNCONFIRMED: f64 = 2.0;

/// Compares two participants with one contact law at the relative distance D.
///
/// D <= U: they agree. D > U: they differ; where an uncertainty has no confirmed order, 2 U replaces U for distances above U.
/// Where U exceeds `resolution`, agreement proves nothing, and a difference needs confirmed orders of both uncertainties:
/// otherwise the verdict is inconclusive.
pub fn pair(metric: Metric, distance: f64, sides: [&Side<'_>; 2], resolution: f64) -> Assessment {
    let result = between(metric, distance, Against::NumericalError, sides);
    let sum = match combined(sides) {
        Ok(sum) => sum,
        Err((who, missing)) => return result.inconclusive(who, missing.reason, missing.remedy),
    };
    let is_confirmed = |of: &Estimate| of.basis.is_confirmed();
    let mut known = sides.iter().map(|side| side.uncertainty.as_ref());
    let confirmed = known.all(|known| known.is_ok_and(is_confirmed));
    // A sum that is NaN does not count as sharp.
    let (sharp, shown) = (sum <= resolution, confirmed && distance > sum);
    if !(sharp || shown) {
        return too_blunt(result, sum, sides, resolution);
    }
    // Without an observed order an uncertainty must be doubled to be a bound: such estimates are too small by as much in one
    // case of a hundred, and a comparison makes hundreds of estimates.
    let bound = if confirmed || distance <= sum {
        sum
    } else {
        UNCONFIRMED * sum
    };
    Assessment {
        bound: Some(bound),
        ..result
    }
    .decided(distance <= bound)
}

/// Returns an inconclusive assessment because U exceeds the resolution.
fn too_blunt(result: Assessment, sum: f64, [a, b]: [&Side<'_>; 2], resolution: f64) -> Assessment {
    let (blunt, other) = if a.u() >= b.u() { (a, b) } else { (b, a) };
    let target = (resolution - other.u().unwrap_or(0.0)).max(resolution / 2.0);
    let estimate = blunt.uncertainty.as_ref().ok();
    let factor = estimate.and_then(|e| e.refinement_for(target));
    let times = factor.map(|factor| format!(" {} times", (factor * 10.0).ceil() / 10.0));
    let remedy = format!("refine {}{}", blunt.name, times.unwrap_or_default());
    let reason = format!("U = {sum:.1e} is above the resolution of {resolution:.0e}");
    result.inconclusive(blunt.name, reason, remedy)
}

/// Permitted difference of two models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// Predicted difference.
    pub predicted: f64,
    /// Stated tolerance of the engines around the prediction, in addition to numerical uncertainty.
    pub tolerance: f64,
    /// Reason of the tolerance.
    pub reason: &'static str,
}

/// Compares two participants with intentionally different models at the distance D, signed where it has a sign. They agree if
/// the difference less the predicted one is within U plus the tolerance; without a tolerance the interval D - U to D + U is the
/// result.
pub fn model(
    metric: Metric,
    distance: f64,
    sides: [&Side<'_>; 2],
    resolution: f64,
    allowed: Result<Allowed, &str>,
) -> Assessment {
    let result = between(metric, distance, Against::ModelTolerance, sides);
    let allowed = match allowed {
        Ok(allowed) => allowed,
        Err(reason) => {
            let reason = reason.to_owned();
            return Assessment { reason, ..result };
        }
    };
    let sum = match combined(sides) {
        Ok(sum) => sum,
        Err((who, missing)) => return result.inconclusive(who, missing.reason, missing.remedy),
    };
    // The uncertainty must not exceed the resolution or the tolerance: otherwise an uncertain result would pass.
    let resolution = resolution.max(allowed.tolerance);
    if !(sum <= resolution) {
        return too_blunt(result, sum, sides, resolution);
    }
    let bound = sum + allowed.tolerance;
    Assessment {
        predicted: allowed.predicted,
        bound: Some(bound),
        tolerance: Some(allowed.tolerance),
        reason: allowed.reason.to_owned(),
        ..result
    }
    .decided((distance - allowed.predicted).abs() <= bound)
}

/// Compares a simulation with measured data at the error E = S - D. A model error is a result that requires no action.
pub fn measured(metric: Metric, error: f64, sides: [&Side<'_>; 2], budget: Budget) -> Assessment {
    let bound = budget.bound();
    let result = Assessment {
        bound: Some(bound),
        budget: Some(budget),
        ..between(metric, error, Against::Measurement, sides)
    };
    Assessment {
        actionable: false,
        ..result.decided(error.abs() <= bound)
    }
}
