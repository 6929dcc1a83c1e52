//! The one vocabulary of verdicts: used by pairs, figures and matrices, and by whatever shows them.

use serde::Serialize;

use crate::metrics::Metric;
use crate::uncertainty::{Estimate, Unresolved};

/// What was found of two numbers or of one number and its limit. All values are relative (see
/// [`Metric`]).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "kebab-case")]
pub enum Verdict {
    /// No difference beyond the numerical uncertainty: D <= U.
    Agree {
        /// How sharp the statement is: U.
        to: f64,
    },
    /// They differ beyond the numerical uncertainty: D > U.
    Differ {
        /// By at least D - U.
        at_least: f64,
    },
    /// The numerical uncertainty is too large, or not known: neither was shown.
    NotResolved {
        /// The participant with the largest uncertainty.
        participant: String,
        /// Its relative uncertainty, where known.
        u: Option<f64>,
        /// Why.
        reason: String,
        /// What would do.
        remedy: String,
        /// Whether this is how it has to be: the participant says why it brings no sharper number
        /// ([`Evidence::excuse`](crate::Evidence::excuse)). A statement then, and no failure.
        stated: bool,
    },
    /// The two differ in their model on purpose, by something in this interval.
    ModelDifference {
        /// D - U.
        low: f64,
        /// D + U.
        high: f64,
        /// The difference predicted; 0 where none is.
        predicted: f64,
        /// How far the engine states its model may be from that; `None` where it states nothing.
        tolerance: Option<f64>,
        /// Whether |D - predicted| <= U + tolerance; `None` without a tolerance.
        within: Option<bool>,
    },
    /// A model error is not distinguishable from zero at this level (ASME V&V 20): |E| <= k u_val.
    NotDistinguishable {
        /// k u_val.
        level: f64,
    },
    /// The model is off by something in this interval (ASME V&V 20): E - k u_val to E + k u_val.
    ModelError {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// At or below a limit.
    Within,
    /// Above a limit, or not a number.
    Exceeded,
    /// Nothing applies.
    NotJudged {
        /// Why.
        reason: String,
    },
}

impl Verdict {
    /// The word used in tables.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Agree { .. } => "agree",
            Self::Differ { .. } => "differ",
            Self::NotResolved { .. } => "not resolved",
            Self::ModelDifference {
                within: Some(false),
                ..
            } => "model difference beyond its tolerance",
            Self::ModelDifference { .. } => "model difference",
            Self::NotDistinguishable { .. } => "no model error distinguishable",
            Self::ModelError { .. } => "model error",
            Self::Within => "within",
            Self::Exceeded => "exceeded",
            Self::NotJudged { .. } => "not judged",
        }
    }

    /// What it amounts to.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        match self {
            Self::Differ { .. }
            | Self::Exceeded
            | Self::ModelDifference {
                within: Some(false),
                ..
            } => Outcome::Finding,
            Self::NotResolved { stated: true, .. } => Outcome::Stated,
            Self::NotResolved { .. } => Outcome::NotResolved,
            Self::NotJudged { .. } => Outcome::Nothing,
            // A model difference without a tolerance is a result; nothing was checked.
            Self::ModelDifference { within: None, .. } => Outcome::Nothing,
            Self::Agree { .. }
            | Self::ModelDifference { .. }
            | Self::NotDistinguishable { .. }
            | Self::ModelError { .. }
            | Self::Within => Outcome::Passed,
        }
    }

    /// The worst of several: a finding before what is not resolved before what passed before what was not judged; among
    /// what is not resolved what a user could change first.
    /// Of equals the first.
    ///
    /// ```
    /// use pinwheel_compare::{Outcome, Verdict};
    ///
    /// let found = [Verdict::Within, Verdict::Agree { to: 1e-4 }, Verdict::Exceeded];
    /// let worst = Verdict::worst(&found).ok_or("nothing was judged")?;
    /// assert_eq!(worst.outcome(), Outcome::Finding);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn worst<'a>(verdicts: impl IntoIterator<Item = &'a Self>) -> Option<&'a Self> {
        let mut worst: Option<&Self> = None;
        for verdict in verdicts {
            if worst.is_none_or(|known| verdict.outcome() > known.outcome()) {
                worst = Some(verdict);
            }
        }
        worst
    }
}

/// What one verdict or a whole comparison amounts to, from the mildest to the gravest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Nothing was judged.
    Nothing,
    /// Everything judged holds.
    Passed,
    /// Not resolved, for a stated reason that no setting of the user's would change.
    Stated,
    /// Something could not be shown either way.
    NotResolved,
    /// Something differs, or is beyond its limit.
    Finding,
}

impl Outcome {
    /// The status a program ends with: 1 where something differs, or could not be resolved; else 0.
    #[must_use]
    pub fn exit_status(self) -> u8 {
        u8::from(matches!(self, Self::NotResolved | Self::Finding))
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

impl Check {
    /// The verdict of this check alone.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.within {
            Verdict::Within
        } else {
            Verdict::Exceeded
        }
    }

    /// Value over limit; infinite where the value is not finite.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.value.map_or(f64::INFINITY, |value| value / self.limit)
    }
}

/// How many verdicts of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// Agree to their uncertainty.
    pub agree: usize,
    /// Differ beyond it.
    pub differ: usize,
    /// Not resolved.
    pub not_resolved: usize,
    /// Not resolved for a stated reason that lies in an engine, a recording or the time allowed.
    pub stated: usize,
    /// Differences and errors of a model, stated as such.
    pub model: usize,
    /// Of these, beyond the tolerance stated for the model.
    pub model_beyond: usize,
    /// Within a limit.
    pub within: usize,
    /// Beyond a limit.
    pub exceeded: usize,
    /// Not judged.
    pub not_judged: usize,
}

impl Counts {
    /// Counts one more.
    pub fn add(&mut self, verdict: &Verdict) {
        match verdict {
            Verdict::Agree { .. } => self.agree += 1,
            Verdict::Differ { .. } => self.differ += 1,
            Verdict::NotResolved { stated: true, .. } => self.stated += 1,
            Verdict::NotResolved { .. } => self.not_resolved += 1,
            Verdict::ModelDifference { within, .. } => {
                self.model += 1;
                self.model_beyond += usize::from(*within == Some(false));
            }
            Verdict::NotDistinguishable { .. } | Verdict::ModelError { .. } => self.model += 1,
            Verdict::Within => self.within += 1,
            Verdict::Exceeded => self.exceeded += 1,
            Verdict::NotJudged { .. } => self.not_judged += 1,
        }
    }

    /// What they amount to; the exit status is [`Outcome::exit_status`] of this.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        if self.differ + self.exceeded + self.model_beyond > 0 {
            Outcome::Finding
        } else if self.not_resolved > 0 {
            Outcome::NotResolved
        } else if self.agree + self.within + self.model > 0 {
            Outcome::Passed
        } else if self.stated > 0 {
            Outcome::Stated
        } else {
            Outcome::Nothing
        }
    }
}

/// One side of a pair as a verdict needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Side<'a> {
    /// Name of the participant.
    pub name: &'a str,
    /// Its uncertainty, relative as the distance is; or why there is none.
    pub uncertainty: Result<Estimate, Unresolved>,
}

impl<'a> Side<'a> {
    /// A side with a known relative uncertainty.
    #[must_use]
    pub fn known(name: &'a str, estimate: Estimate) -> Self {
        Self {
            name,
            uncertainty: Ok(estimate),
        }
    }

    fn u(&self) -> Option<f64> {
        self.uncertainty.as_ref().ok().map(|e| e.u)
    }
}

/// The combined uncertainty U of two sides, or the verdict that says what is missing.
///
/// U = uA + uB: both are bounds of errors that are fixed by the settings, not random and not independent (two
/// engines may share a method and err alike or against each other), so nothing entitles us to add them as squares.
///
/// # Errors
/// The verdict `NotResolved` where one of them is not known.
pub fn combined(a: &Side<'_>, b: &Side<'_>) -> Result<f64, Verdict> {
    for side in [a, b] {
        if let Err(missing) = &side.uncertainty {
            return Err(Verdict::NotResolved {
                participant: side.name.to_owned(),
                u: None,
                reason: missing.reason.clone(),
                remedy: missing.remedy.clone(),
                stated: false,
            });
        }
    }
    Ok(a.u().unwrap_or(0.0) + b.u().unwrap_or(0.0))
}

/// How much of U a difference must exceed where an order was not confirmed.
pub const UNCONFIRMED: f64 = 2.0;

/// Two participants of one law at the relative distance D.
///
/// D <= U: agree to U. D > U: differ by at least D - U; where an uncertainty rests on no confirmed order, 2 U takes the place
/// of U for distances above U. Where U is above `resolution`, agreement would say nothing,
/// and a difference is told only if both uncertainties rest on confirmed orders: otherwise not resolved.
#[must_use]
pub fn pair(distance: f64, a: &Side<'_>, b: &Side<'_>, resolution: f64) -> Verdict {
    let sum = match combined(a, b) {
        Ok(sum) => sum,
        Err(missing) => return missing,
    };
    let confirmed = [a, b]
        .iter()
        .all(|s| s.uncertainty.as_ref().is_ok_and(|e| e.basis.is_confirmed()));
    // What is not a number is not sharp.
    let (sharp, shown) = (sum <= resolution, confirmed && distance > sum);
    if !(sharp || shown) {
        return too_blunt(sum, a, b, resolution);
    }
    // Of a size that no order confirms only twice as much is a bound: such estimates miss one error in a hundred by as
    // much, and a comparison makes hundreds of them.
    let bound = if confirmed { sum } else { UNCONFIRMED * sum };
    if distance <= sum {
        Verdict::Agree { to: sum }
    } else if distance <= bound {
        Verdict::Agree { to: bound }
    } else {
        Verdict::Differ {
            at_least: distance - bound,
        }
    }
}

/// Not resolved: U is above what was asked for.
pub(crate) fn too_blunt(sum: f64, a: &Side<'_>, b: &Side<'_>, resolution: f64) -> Verdict {
    let (blunt, other) = if a.u() >= b.u() { (a, b) } else { (b, a) };
    let target = (resolution - other.u().unwrap_or(0.0)).max(resolution / 2.0);
    let factor = blunt
        .uncertainty
        .as_ref()
        .ok()
        .and_then(|e| e.refinement_for(target));
    Verdict::NotResolved {
        participant: blunt.name.to_owned(),
        u: blunt.u(),
        reason: format!("U = {sum:.1e} is above the resolution of {resolution:.0e}"),
        remedy: match factor {
            Some(factor) => format!(
                "refine {} {} times",
                blunt.name,
                (factor * 10.0).ceil() / 10.0
            ),
            None => format!("refine {}", blunt.name),
        },
        stated: false,
    }
}

/// Two participants whose models differ on purpose, at the (signed, where it has a sign) distance D: the interval
/// D - U to D + U, and whether the difference less the predicted one is within U + `tolerance`.
#[must_use]
pub fn model(
    distance: f64,
    a: &Side<'_>,
    b: &Side<'_>,
    resolution: f64,
    predicted: f64,
    tolerance: Option<f64>,
) -> Verdict {
    let sum = match combined(a, b) {
        Ok(sum) => sum,
        Err(missing) => return missing,
    };
    // As blunt as its tolerance a statement may be, but no blunter: it would pass by being blunt.
    let resolution = resolution.max(tolerance.unwrap_or(0.0));
    if !(sum <= resolution) {
        return too_blunt(sum, a, b, resolution);
    }
    Verdict::ModelDifference {
        low: distance - sum,
        high: distance + sum,
        predicted,
        tolerance,
        within: tolerance.map(|t| (distance - predicted).abs() <= sum + t),
    }
}
