//! Uncertainty of the finest run from differences between runs of one method at several refinements.
//!
//! With H the step over the finest step, p the order and C a constant of the problem, `f(H) = f + C H^p`. Then `|f2 - f1| = C
//! (H2^p - 1)`, and the error of the finest run is `C = |f2 - f1| / (H2^p - 1)`. The factor of safety Fs makes this a bound:
//! Roache's grid convergence index (Verification and Validation in Computational Science and Engineering, 1998, ch. 5). Fs =
//! 1.25 where three runs show the method's order, else 3; also 3 where contacts open and close, or forces jump, under a method
//! of a higher order than these allow. The caps on the order are those of Oberkampf & Roy (2010), ch. 8, and Eca & Hoekstra, J.
//! Comput. Phys. 262 (2014) 104. Runs at several tolerances may show no order, because each chooses its own steps: then, as
//! there, the bound is three times the largest difference of any two. Fixed steps without an order give no bound.

use serde::{Deserialize, Serialize};

/// Fs where the observed order confirms the stated one.
pub const SAFETY: f64 = 1.25;
/// Fs without a confirmed order.
pub const SAFETY_UNCONFIRMED: f64 = 3.0;
/// Lowest observed order of a convergent refinement study.
pub const LEAST_ORDER: f64 = 0.5;
/// Value of [`LEAST_ORDER`] for tolerances: the differences shrink twofold as the tolerance falls tenfold.
pub const LEAST_TOLERANCE_ORDER: f64 = 0.3;
/// Largest difference between an observed order and the stated order that it confirms.
pub const ORDER_MARGIN: f64 = 0.5;
/// Least cosine between two successive differences that confirm an order: both must point in one direction.
pub const LEAST_ALIGNMENT: f64 = 0.5;

/// Margin in the order for a scene whose forces [jump](Rough::Jumps): if three runs show the method's formal order within it,
/// the solution is treated as smooth at these steps. A wider margin would admit accidental orders between those of the jumps
/// and of the method.
pub const SMOOTH_MARGIN: f64 = 0.25;
/// Value of [`LEAST_ALIGNMENT`] for jumping forces: differences from jumps have any direction. Heun on the paper's gear without
/// jumps has 0.84.
pub const SMOOTH_ALIGNMENT: f64 = 0.8;

/// Non-smooth feature of a scene's forces, which bounds the order of every fixed-step method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rough {
    /// Contacts that open and close with a force of penetration^1.5: the error of a step over such a kink is of order h^2.5.
    Kinks,
    /// Force that sets in within one step, e.g. damping on a ramp that a disc crosses faster. The error of the step is h times
    /// a factor of the jump's position in the step. Steps as short as the ramp resolve its two kinks: h^2.
    Jumps,
    /// Forces that jump from point to point throughout the run.
    Points,
    /// Friction with a ramp of speeds that no explicit step resolves.
    Friction,
}

impl Rough {
    /// Returns the order that the feature allows.
    pub fn order(self) -> f64 {
        match self {
            Self::Kinks => 2.5,
            Self::Jumps | Self::Points | Self::Friction => 1.0,
        }
    }
}

/// Order of the error of runs that resolve the ramp of a [jump](Rough::Jumps).
const RAMPS: f64 = 2.0;
/// Least uncertainty of a finest run whose step does not resolve its friction, as a share of its distance to the next run. Runs
/// with chattering steps differ by as much as they err, at any ratio of steps, and show no order. Measured with `rk4` and
/// rapier on `one-wheel` with friction, steps 1e-5 to 8e-8 s, ratios 2 to 8: 516 of 528 errors are covered without this value
/// and 527 with it.
pub const CHATTER: f64 = 1.5;
/// Order in the tolerance that contacts allow.
pub const KINKS: f64 = 0.5;
/// Order in the tolerance for explicit Runge-Kutta methods, whose few long steps scatter more. Measured with Dormand-Prince on
/// 90 random gears without friction: [`KINKS`] covers 93.8 % of 432 errors, this value 96 %.
pub const KINKS_EXPLICIT: f64 = 0.43;
/// Order assigned to the next coarser difference of runs at several tolerances. On average errors fall in proportion to the
/// tolerance. But the error of a step over a kink or a jump depends on its position in the step, and the method's own estimate
/// misses this error (by a factor of 100 for Dormand-Prince over a jump), so two runs may share an error by accident. Order 1
/// would hide it. Measured on 1 163 errors of 73 gears without friction, 40 of them like `three39` of the tests, by two methods
/// at several tolerances: order 1 covers 93.5 %, with 17 errors above 2 u; these orders cover 97.7 %, with 2 above 2 u. The
/// median of u over the error rises from 5.4 to 8.5. [`LOOSE_EXPLICIT`] is the order for explicit Runge-Kutta methods.
const LOOSE: f64 = 2.0 / 3.0;
const LOOSE_EXPLICIT: f64 = 0.5;
/// Order in the tolerance where forces jump from point to point, which no method resolves: the runs' errors are independent.
pub const SCATTER: f64 = 0.0;

/// Kind of setting that a refinement changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "refined", rename_all = "kebab-case")]
pub enum Method {
    /// Step, mesh or number of points of a method with a known order.
    Step {
        /// Stated order of the method.
        order: f64,
        /// Non-smooth feature that bounds the order; `None` for a smooth scene. Coarse runs may show the method's order while
        /// the error of the finest run already falls with the feature's, so no higher order is used.
        rough: Option<Rough>,
    },
    /// Error tolerance of an adaptive method. Step size control keeps the error proportional to the tolerance within a factor
    /// (Fs = 3); over kinks it falls with the square root (order 2.5 of a method of order 5).
    Tolerance {
        /// Order in the tolerance that the scene allows: 1 for a smooth scene, [`KINKS`], [`SCATTER`].
        order: f64,
    },
}

impl Method {
    /// Returns the method's stated order.
    pub fn stated_order(self) -> f64 {
        match self {
            Self::Step { order, .. } => order,
            Self::Tolerance { .. } => 1.0,
        }
    }

    /// Returns the highest order used: the lower of the method's and the scene's.
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

    /// Returns the method with kinks in place of jumps if three runs show the method's own order, so that no jump is visible.
    /// The second value is the share of the finest difference that a hidden jump may still cause, because the order is known
    /// within a margin only. Otherwise returns `self` and 0.
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

    /// Returns Fs without a confirmed order. A square root of the tolerance is already the worst case.
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
        // Kinks and jumps confirm no order: their position in a step is random, and so is the order of three runs. Friction
        // confirms none either: orders about 1 occur by chance.
        let sound = matches!(self.rough(), None | Some(Rough::Friction));
        sound && (order - ORDER_MARGIN..=order + ORDER_MARGIN).contains(&observed)
    }
}

/// Kind of evidence for an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// Three runs with the stated order: Fs = 1.25.
    Observed,
    /// Three convergent runs with another order than stated: Fs = 3 with the lower of both. Also runs with opening contacts or
    /// jumping forces, which cannot confirm a method of higher order: Fs = 3 with the order of kinks or jumps.
    Unconfirmed,
    /// Two runs: the order is stated, not measured. An error common to both stays hidden.
    TwoLevels,
    /// Runs at several tolerances: the error is taken as proportional to the tolerance, Fs = 3.
    Tolerance,
    /// Runs that differ by rounding only: u is the rounding error.
    Rounding,
    /// Bound of a figure by its series, sharper than the figure's own study.
    Series,
    /// Three times the spread of the runs: runs at several tolerances without an order, or runs beyond the divergence horizon,
    /// where each is a sample.
    Spread,
    /// Stated value: a closed form, or one known to the caller.
    Stated,
}

impl Basis {
    /// True if the size of u was confirmed, not only guarded by a larger factor of safety.
    pub fn is_confirmed(self) -> bool {
        matches!(self, Self::Observed | Self::Rounding | Self::Stated)
    }
}

/// Numerical uncertainty of one figure: a bound of a deterministic error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Uncertainty in the unit of the figure; never negative.
    pub u: f64,
    /// Kind of evidence for the value.
    pub basis: Basis,
    /// Order observed from three runs.
    pub observed_order: Option<f64>,
    /// Order used.
    pub order: Option<f64>,
    /// Factor of safety of the finest difference; coarser differences may have another.
    pub safety: Option<f64>,
}

impl Estimate {
    /// Returns an uncertainty known from elsewhere.
    pub fn stated(u: f64) -> Self {
        Self {
            u,
            basis: Basis::Stated,
            observed_order: None,
            order: None,
            safety: None,
        }
    }

    /// Returns the uncertainty of runs that differ by `apart`, when the evidence favours no run.
    pub fn spread(apart: f64, floor: f64) -> Self {
        Self {
            basis: Basis::Spread,
            safety: Some(SAFETY_UNCONFIRMED),
            ..Self::stated((SAFETY_UNCONFIRMED * apart).max(floor))
        }
    }

    /// Returns the factor by which the step (or tolerance) must fall for u to fall to `target`, at least 1; `None` where no
    /// refinement helps (rounding), or the order is unknown.
    pub fn refinement_for(&self, target: f64) -> Option<f64> {
        if matches!(self.basis, Basis::Rounding) {
            return None;
        }
        let factor = (self.u / target).powf(1.0 / self.order?);
        (target > 0.0 && factor.is_finite()).then(|| factor.max(1.0))
    }
}

/// Reason for a missing uncertainty, and a remedy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unresolved {
    /// Reason for the missing uncertainty.
    pub reason: String,
    /// Action of the user's that would give an uncertainty.
    pub remedy: String,
}

impl Unresolved {
    /// Pairs a reason with a remedy.
    pub fn new(reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }
}

/// Transition from one level to the next coarser one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Ratio of the coarser refinement to the finer one, above 1.
    pub ratio: f64,
    /// Norm of the difference of the two runs.
    pub difference: f64,
}

/// Returns the order p of the two finest differences; `None` if a difference is zero or not finite.
///
/// Solves `e32/e21 = r21^p (r32^p - 1) / (r21^p - 1)`, which for equal ratios is `ln(e32/e21) / ln r`.
/// The result lies between -20 and 20.
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

/// Returns the uncertainty of the finest run.
///
/// `steps`: from the finest level to the coarsest. `alignment`: cosine between the two finest differences, 1 or -1 for single
/// figures. `floor`: rounding error of a difference, in its unit.
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
    let is_coarser = |s: &Step| s.ratio > 1.0 && s.ratio.is_finite();
    if !steps.iter().all(is_coarser) {
        return Err(Unresolved::new(
            "the levels of the refinement study are not ordered from fine to coarse",
            "order them",
        ));
    }
    let observed = steps.get(1).map(|&coarse| observed_order(fine, coarse));
    let observed = observed.map(|order| order.unwrap_or(f64::NEG_INFINITY));
    let (method, hidden) = method.as_seen(observed, steps, alignment);
    let bound = |order: f64, safety: f64| {
        let mut refinement = fine.ratio;
        let mut largest =
            safety * fine.difference * (1.0 / (refinement.powf(order) - 1.0) + hidden);
        // Every level predicts the error of the finest, so that an accident of one difference does not hide the others.
        let (order, safety) = match method.rough() {
            Some(Rough::Kinks) => (order, SAFETY),
            Some(Rough::Jumps) => (RAMPS, safety),
            Some(Rough::Points) => (order, safety),
            // With friction the differences of coarse runs fall with the method's own order.
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
        // An order clearly above the expected one is luck: the finest difference is small by accident, the next one is not.
        let is_luck = observed.is_some_and(|observed| observed > order + ORDER_MARGIN);
        // A loose order already allows for it.
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
    // No two runs differ by more than the sum of all differences.
    let spread = || Estimate::spread(steps.iter().map(|step| step.difference).sum(), floor);
    if method.allowed_order() < method.least_order() {
        return Ok(spread());
    }
    let guarded = method.unconfirmed_safety();
    let (shared_error, lowest) = match method {
        Method::Step { .. } => (Basis::TwoLevels, Basis::Rounding),
        // Rounding of runs at tolerances includes their common error, which nothing reveals.
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
        let order = match observed.is_finite() {
            true => format!("{observed:.1}"),
            false => "none".to_owned(),
        };
        let (coarse, fine, least) = (coarse.difference, fine.difference, method.least_order());
        return Err(Unresolved::new(
            format!(
                "it does not converge: from level to level the runs differ by {coarse:.1e} and then by {fine:.1e} (observed order \
                 {order}, at least {least} needed)"
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
        // The deficit of the order indicates its uncertainty, so it is subtracted twice.
        let order = (lower - (allowed - lower)).max(LEAST_ORDER);
        return known(Basis::Observed, Some(observed), order, SAFETY);
    }
    let basis = match method {
        Method::Step { .. } => Basis::Unconfirmed,
        Method::Tolerance { .. } => Basis::Tolerance,
    };
    known(basis, Some(observed), lower, guarded)
}
