//! From the differences between runs of one method at several refinements to an uncertainty of the finest.
//!
//! With H the step over the finest step, p the order and C a constant of the problem, `f(H) = f + C H^p`. Then
//! `|f2 - f1| = C (H2^p - 1)` and the finest run is off by `C = |f2 - f1| / (H2^p - 1)`; the factor of safety Fs
//! makes a bound of it: Roache's grid convergence index (Verification and Validation in Computational Science
//! and Engineering, 1998, ch. 5). Fs = 1.25 where three runs show the order that the method promises, else 3; and 3 where
//! contacts open and close, or forces jump, in a method of a higher order than they allow.
//! The caps on the order are those of Oberkampf & Roy (2010), ch. 8, and Eca & Hoekstra, J. Comput. Phys. 262
//! (2014) 104. Where runs at several tolerances show no order, because each chooses its steps
//! anew, three times the largest difference of any two takes its place, as there. Fixed steps that show none say nothing.

use serde::{Deserialize, Serialize};

/// Fs where the order was observed as stated.
pub const SAFETY: f64 = 1.25;
/// Fs elsewhere.
pub const SAFETY_UNCONFIRMED: f64 = 3.0;
/// Below this observed order a refinement study does not converge.
pub const LEAST_ORDER: f64 = 0.5;
/// Value of [`LEAST_ORDER`] for tolerances: the differences shrink less than twofold while the tolerance falls tenfold.
pub const LEAST_TOLERANCE_ORDER: f64 = 0.3;
/// An observed order confirms the stated one when it is no further away than this.
pub const ORDER_MARGIN: f64 = 0.5;
/// Two successive differences confirm an order only if they point the same way: the least cosine between them.
pub const LEAST_ALIGNMENT: f64 = 0.5;

/// Margin in the order for a scene whose forces [jump](Rough::Jumps): if three runs show the method's formal order
/// within it, the solution is treated as smooth at these steps. A wider margin would admit orders between that of jumps
/// and that of the method, which come by chance.
pub const SMOOTH_MARGIN: f64 = 0.25;
/// Value of [`LEAST_ALIGNMENT`] for jumping forces: differences made by jumps point anywhere. Heun on the paper's gear without a jump in sight has 0.84.
pub const SMOOTH_ALIGNMENT: f64 = 0.8;

/// Non-smooth feature of a scene's forces. It bounds the order of every fixed step, whatever the method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rough {
    /// Contacts open and close with a force of penetration^1.5: a step over such a kink is off by h^2.5.
    Kinks,
    /// A force sets in within less than a step: damping over a ramp that a disc crosses faster. Such a step is off by h times a
    /// factor of where in it that falls. Steps as short as the ramp see its two kinks: h^2.
    Jumps,
    /// Forces jump from point to point all the time.
    Points,
    /// Friction on a ramp of speeds that no explicit step follows.
    Friction,
}

impl Rough {
    /// The order that it allows.
    #[must_use]
    pub fn order(self) -> f64 {
        match self {
            Self::Kinks => 2.5,
            Self::Jumps | Self::Points | Self::Friction => 1.0,
        }
    }
}

/// Order with which the errors fall of runs that resolve the ramp of a [jump](Rough::Jumps).
const RAMPS: f64 = 2.0;
/// Least uncertainty of the finest run with a step that does not follow its friction, as a share of its distance to the
/// next run. Runs whose steps chatter differ by as much as they err, however much finer one run is, and their differences
/// show no order. Measured with `rk4` and rapier on `one-wheel` with friction, steps 1e-5 to 8e-8 s, ratios 2 to 8: of 528
/// errors 516 are covered without this value and 527 with it.
pub const CHATTER: f64 = 1.5;
/// Order in a tolerance that contacts allow.
pub const KINKS: f64 = 0.5;
/// Order in a tolerance for explicit Runge-Kutta methods, whose few long steps scatter more than others. Measured with
/// Dormand-Prince on 90 random gears without friction, where [`KINKS`] covers 93.8 % of 432 errors and this value 96 %.
pub const KINKS_EXPLICIT: f64 = 0.43;
/// Order with which the next difference of runs at several tolerances counts. On average errors fall with the tolerance
/// itself. But the error of a step over a kink or a jump depends on the place of the kink or jump within the step. The
/// method's own estimate misses this error (for a step of Dormand-Prince over a jump it is a hundredth of the error), so two
/// runs may be wrong alike by accident. Counted with the order 1, the next difference hid that. Measured on 1 163 errors of
/// 73 gears without friction, 40 of the gears like `three39` of the tests, by two methods at several tolerances: with the
/// order 1, 93.5 % were covered and 17 above 2 u; with these orders 97.7 % are covered and 2 above 2 u. The median of u over
/// the error rises from 5.4 to 8.5. [`LOOSE_EXPLICIT`] is the order for explicit Runge-Kutta methods.
const LOOSE: f64 = 2.0 / 3.0;
const LOOSE_EXPLICIT: f64 = 0.5;
/// The order in a tolerance where forces jump from point to point, which no method follows: each run has an error of its own.
pub const SCATTER: f64 = 0.0;

/// Kind of setting that is refined from level to level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "refined", rename_all = "kebab-case")]
pub enum Method {
    /// A step, mesh or number of points of a method with a known order.
    Step {
        /// Order the method states.
        order: f64,
        /// Non-smooth feature that bounds the order; `None` for a smooth scene. Coarse runs may show the method's order
        /// while the error of the finest already falls with the scene's: never more is used.
        rough: Option<Rough>,
    },
    /// The error tolerance of an adaptive method. Its error follows the tolerance, which is what step size control aims
    /// at, to a factor (Fs = 3); over kinks it falls with the square root only (order 2.5 of a method of order 5).
    Tolerance {
        /// Order in the tolerance that the scene allows: 1 for a smooth one, [`KINKS`], [`SCATTER`].
        order: f64,
    },
}

impl Method {
    /// The order that the method states in its refinement.
    #[must_use]
    pub fn stated_order(self) -> f64 {
        match self {
            Self::Step { order, .. } => order,
            Self::Tolerance { .. } => 1.0,
        }
    }

    /// The highest order used: that of method and scene.
    #[must_use]
    pub fn allowed_order(self) -> f64 {
        match self {
            Self::Step { order, rough } => rough.map_or(order, |rough| rough.order().min(order)),
            Self::Tolerance { order } => order,
        }
    }

    /// Returns the non-smooth feature that limits the error instead of the method's order.
    fn rough(self) -> Option<Rough> {
        match self {
            Self::Step { order, rough } => rough.filter(|rough| rough.order() < order),
            Self::Tolerance { .. } => None,
        }
    }

    /// Returns the method without its jumps where three runs show the method's own order, so that no jump is visible:
    /// the scene then counts as one with kinks. Returns with it the share of the finest difference in which a jump may hide
    /// all the same, because the order is known within a margin only. Elsewhere returns `self` and 0.
    fn as_seen(self, observed: Option<f64>, steps: &[Step], alignment: Option<f64>) -> (Self, f64) {
        let (Self::Step { order, .. }, Some(Rough::Jumps)) = (self, self.rough()) else {
            return (self, 0.0);
        };
        let straight = alignment.is_none_or(|cosine| cosine >= SMOOTH_ALIGNMENT);
        let own = observed.is_some_and(|observed| (observed - order).abs() <= SMOOTH_MARGIN);
        match steps.get(1) {
            Some(coarse) if straight && own => {
                let rough = Some(Rough::Kinks);
                let hidden = 1.0 - coarse.ratio.powf(-SMOOTH_MARGIN);
                (Self::Step { order, rough }, hidden)
            }
            _ => (self, 0.0),
        }
    }

    fn least_order(self) -> f64 {
        match self {
            Self::Step { .. } => LEAST_ORDER,
            Self::Tolerance { .. } => LEAST_TOLERANCE_ORDER,
        }
    }

    /// Fs where the order was not confirmed. A square root of the tolerance is itself the bad case.
    fn unconfirmed_safety(self) -> f64 {
        match self {
            Self::Tolerance { order } if order <= KINKS => SAFETY,
            _ => SAFETY_UNCONFIRMED,
        }
    }

    /// True if the order `observed` from three runs confirms the expected order of method and scene.
    fn confirmed_by(self, observed: f64) -> bool {
        let Self::Step { order, .. } = self else {
            return false;
        };
        // Kinks and jumps confirm nothing: where in a step they fall is an accident, and so is the order that three runs show. Nor
        // does friction: orders about 1 come and go there.
        let sound = matches!(self.rough(), None | Some(Rough::Friction));
        sound && (order - ORDER_MARGIN..=order + ORDER_MARGIN).contains(&observed)
    }
}

/// Kind of evidence on which an uncertainty rests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// Three runs showed the stated order: Fs = 1.25.
    Observed,
    /// Three runs converge, with another order than stated: Fs = 3 with the lower of both orders. Or contacts open and close, or
    /// forces jump, which a method of a higher order than theirs cannot confirm: Fs = 3 with theirs.
    Unconfirmed,
    /// Two runs: the order is the stated one, not a measured one. An error that both runs share stays hidden.
    TwoLevels,
    /// Runs at several tolerances: the error was taken as proportional to the tolerance, Fs = 3.
    Tolerance,
    /// The runs differ by rounding only: u is the floor of rounding.
    Rounding,
    /// A figure of a series whose own uncertainty bounds it more sharply than the figure's study does.
    Series,
    /// Runs at several tolerances that show no order, or runs beyond the divergence horizon, where each is a sample: three
    /// times their spread.
    Spread,
    /// The engine states it: a closed form, or a value the caller knows.
    Stated,
}

impl Basis {
    /// True if the size of u was confirmed, and not only guarded against by a larger factor of safety.
    #[must_use]
    pub fn is_confirmed(self) -> bool {
        matches!(self, Self::Observed | Self::Rounding | Self::Stated)
    }
}

/// The numerical uncertainty of one figure: a bound of a deterministic error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The uncertainty, in the unit of what was estimated; never negative.
    pub u: f64,
    /// Kind of evidence for the value.
    pub basis: Basis,
    /// Order observed from three runs.
    pub observed_order: Option<f64>,
    /// Order used.
    pub order: Option<f64>,
    /// Factor of safety of the finest difference; differences of coarser levels may have another factor.
    pub safety: Option<f64>,
}

impl Estimate {
    /// An uncertainty that is known otherwise.
    #[must_use]
    pub fn stated(u: f64) -> Self {
        Self {
            u,
            basis: Basis::Stated,
            observed_order: None,
            order: None,
            safety: None,
        }
    }

    /// Returns the estimate for runs that are this far `apart` when the evidence favours no run.
    #[must_use]
    pub fn spread(apart: f64, floor: f64) -> Self {
        Self {
            basis: Basis::Spread,
            safety: Some(SAFETY_UNCONFIRMED),
            ..Self::stated((SAFETY_UNCONFIRMED * apart).max(floor))
        }
    }

    /// Factor by which the step (or tolerance) must fall for u to fall to `target`: at least 1; `None` where no
    /// refinement would do (rounding), or the order is not known.
    #[must_use]
    pub fn refinement_for(&self, target: f64) -> Option<f64> {
        if matches!(self.basis, Basis::Rounding) {
            return None;
        }
        let factor = (self.u / target).powf(1.0 / self.order?);
        (target > 0.0 && factor.is_finite()).then(|| factor.max(1.0))
    }
}

/// Why there is no uncertainty, and what would give one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unresolved {
    /// Why.
    pub reason: String,
    /// Action by the user that would make the result resolved.
    pub remedy: String,
}

impl Unresolved {
    /// The reason, and what would help.
    #[must_use]
    pub fn new(reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }
}

/// From one level to the next coarser one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The coarser refinement over the finer one, above 1.
    pub ratio: f64,
    /// Norm of the difference of the two runs.
    pub difference: f64,
}

/// Returns the order p that the two finest differences show; `None` if a difference is zero or not finite.
///
/// Solves `e32/e21 = r21^p (r32^p - 1) / (r21^p - 1)`, which for equal ratios is `ln(e32/e21) / ln r`.
/// The result lies between -20 and 20.
#[must_use]
pub fn observed_order(fine: Step, coarse: Step) -> Option<f64> {
    let sound = |s: Step| s.ratio > 1.0 && s.difference > 0.0 && s.difference.is_finite();
    if !sound(fine) || !sound(coarse) {
        return None;
    }
    let wanted = (coarse.difference / fine.difference).ln();
    let (r21, r32) = (fine.ratio.ln(), coarse.ratio.ln());
    // ln of the right-hand side without cancellation: (r^p - 1) = expm1(p ln r).
    let of = |p: f64| {
        let quotient = if p.abs() < 1e-9 {
            r32 / r21
        } else {
            (p * r32).exp_m1() / (p * r21).exp_m1()
        };
        p * r21 + quotient.ln()
    };
    let (mut low, mut high) = (-20.0, 20.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// The uncertainty of the finest run.
///
/// `steps`: from the finest level to the coarsest. `alignment`: cosine between the two finest differences, for
/// single figures 1 or -1. `floor`: what rounding alone may make of a difference, in the unit of the differences.
///
/// # Errors
/// [`Unresolved`]: fewer than two runs, differences that are not finite or do not shrink.
pub fn estimate(
    steps: &[Step],
    alignment: Option<f64>,
    method: Method,
    floor: f64,
) -> Result<Estimate, Unresolved> {
    let Some(fine) = steps.first().copied() else {
        return Err(Unresolved::new(
            "one run alone shows nothing of its error",
            "run it again at a coarser step or tolerance",
        ));
    };
    if steps.iter().any(|s| !s.difference.is_finite()) {
        return Err(Unresolved::new(
            "a run of the refinement study is not finite",
            "take a finer study",
        ));
    }
    if steps
        .iter()
        .any(|s| !(s.ratio > 1.0 && s.ratio.is_finite()))
    {
        return Err(Unresolved::new(
            "the levels of the refinement study are not ordered from fine to coarse",
            "order them",
        ));
    }
    let observed = steps
        .get(1)
        .map(|&coarse| observed_order(fine, coarse).unwrap_or(f64::NEG_INFINITY));
    let (method, hidden) = method.as_seen(observed, steps, alignment);
    let bound = |order: f64, safety: f64| {
        let mut refinement = fine.ratio;
        let mut largest =
            safety * fine.difference * (1.0 / (refinement.powf(order) - 1.0) + hidden);
        // Every level predicts the error of the finest; an accident of one difference does not hide the others.
        let (order, safety) = match method.rough() {
            Some(Rough::Kinks) => (order, SAFETY),
            Some(Rough::Jumps) => (RAMPS, safety),
            Some(Rough::Points) => (order, safety),
            // With friction coarse runs fall with the method's own order.
            Some(Rough::Friction) => {
                largest = largest.max(CHATTER * fine.difference);
                (method.stated_order(), safety)
            }
            None => match method {
                Method::Tolerance { order } if order < KINKS => (LOOSE_EXPLICIT, safety),
                Method::Tolerance { order } if order < 1.0 => (LOOSE, safety),
                _ => (order, safety),
            },
        };
        // Clearly more than that order is luck: the finest difference is small for no reason, the next one is not.
        let is_luck = observed.is_some_and(|observed| observed > order + ORDER_MARGIN);
        // An order that is loose leaves room for it.
        let is_luck = is_luck && !matches!(method, Method::Tolerance { order } if order < 1.0);
        let safety = if is_luck { SAFETY_UNCONFIRMED } else { safety };
        for step in &steps[1..] {
            let next = refinement * step.ratio;
            let off = step.difference / (next.powf(order) - refinement.powf(order));
            largest = largest.max(safety * off);
            refinement = next;
        }
        largest.max(floor)
    };
    let known = |basis, observed_order, order: f64, safety| {
        Ok(Estimate {
            u: bound(order, safety),
            basis,
            observed_order,
            order: Some(order),
            safety: Some(safety),
        })
    };
    // No two runs are further apart than all their differences together.
    let spread = || Estimate::spread(steps.iter().map(|step| step.difference).sum(), floor);
    if method.allowed_order() < method.least_order() {
        return Ok(spread());
    }
    let guarded = method.unconfirmed_safety();
    let (shared_error, lowest) = match method {
        Method::Step { .. } => (Basis::TwoLevels, Basis::Rounding),
        // Its floor is what all its runs may miss alike, which nothing shows.
        Method::Tolerance { .. } => (Basis::Tolerance, Basis::Tolerance),
    };
    if fine.difference <= floor {
        return known(lowest, None, method.allowed_order(), SAFETY_UNCONFIRMED);
    }
    let (Some(observed), Some(&coarse)) = (observed, steps.get(1)) else {
        return known(shared_error, None, method.allowed_order(), guarded);
    };
    if !(observed >= method.least_order()) {
        if matches!(method, Method::Tolerance { .. }) {
            return Ok(spread());
        }
        return Err(Unresolved::new(
            format!(
                "it does not converge: from level to level the runs differ by {:.1e} and then by {:.1e} (observed order {}, \
                 at least {} needed)",
                coarse.difference,
                fine.difference,
                if observed.is_finite() {
                    format!("{observed:.1}")
                } else {
                    "none".to_owned()
                },
                method.least_order()
            ),
            "take a smaller step: half or a quarter",
        ));
    }
    let allowed = method.allowed_order();
    let lower = match method.rough() {
        Some(Rough::Kinks) => allowed,
        _ => observed.min(allowed),
    };
    let aligned = alignment.is_none_or(|cosine| cosine >= LEAST_ALIGNMENT);
    if aligned && method.confirmed_by(observed) {
        // The deficit of the order shows how well the order is known: it is subtracted once more.
        let order = (lower - (allowed - lower)).max(LEAST_ORDER);
        return known(Basis::Observed, Some(observed), order, SAFETY);
    }
    let basis = match method {
        Method::Step { .. } => Basis::Unconfirmed,
        Method::Tolerance { .. } => Basis::Tolerance,
    };
    known(basis, Some(observed), lower, guarded)
}
