//! Verdicts from distances, uncertainties and limits.

use std::ops::Range;

use crate::balance;
use crate::limits::{NEGLIGIBLE_SHARE, fits};
use crate::metrics::{Metric, PairMetrics};
use crate::model::{self, ModelTolerance, Prediction};
use crate::participant::{Context, Participant, SharedModel};
use crate::quantities::Quantity;
use crate::rules::Rules;
use crate::uncertainty::{Estimate, QuantityUncertainty, Uncertainty, Unresolved};
use crate::validation::Budget;
use crate::verdict::{self, Allowed, Assessment, Side, Verdict};
use crate::windows::Window;

/// Inputs of a verdict beside the figures.
#[derive(Clone, Copy)]
pub(crate) struct Judge<'a> {
    /// Limits, evidence, tolerances.
    pub(crate) rules: &'a Rules<'a>,
    /// Facts of the scene, with its friction and divergence horizon.
    pub(crate) context: &'a Context,
    /// Windows of the runs.
    pub(crate) windows: &'a [Window],
    /// Quantities of all time series.
    pub(crate) quantities: &'a [Quantity],
    /// Force (N) and torque (N m) below which a load is rounding.
    pub(crate) negligible: Negligible,
}

/// Angle below which a difference is a rounding, rad.
const ROUNDED_RAD: f64 = 1e-15;

/// Loads below which a figure is rounding.
#[derive(Clone, Copy)]
pub(crate) struct Negligible {
    force_n: f64,
    pub(crate) torque_n_m: f64,
}

impl Negligible {
    /// Returns the negligible loads from the scene's scales, or from the largest loads of the time series where the scene
    /// states none.
    pub(crate) fn of(
        context: &Context,
        finished: &[&Participant],
        quantities: &[Quantity],
    ) -> Self {
        let largest = |wanted: fn(&Quantity) -> bool| {
            let loads = quantities.iter().filter(|q| wanted(q));
            loads
                .flat_map(|q| &q.channels)
                .flat_map(|name| finished.iter().filter_map(|p| p.time_series.channel(name)))
                .flatten()
                .filter(|v| v.is_finite())
                .fold(0.0_f64, |most, v| most.max(v.abs()))
        };
        let share = |stated: Option<f64>, wanted: fn(&Quantity) -> bool| {
            NEGLIGIBLE_SHARE * stated.unwrap_or_else(|| largest(wanted)).abs()
        };
        Self {
            force_n: share(context.scales.force_n, Quantity::is_force),
            torque_n_m: share(context.scales.torque_n_m, Quantity::is_torque),
        }
    }

    /// Returns the negligible size of a quantity in its unit; `None` for quantities that are neither a load nor an angle.
    pub(crate) fn below(&self, quantity: &Quantity) -> Option<f64> {
        match quantity.unit.as_str() {
            "N" => Some(self.force_n),
            "N m" => Some(self.torque_n_m),
            // An angle has no scale: a gear that stands still turns by roundings of a radian.
            "rad" => Some(ROUNDED_RAD),
            _ => None,
        }
    }
}

/// Two engines and the model that they share.
#[derive(Clone, Copy)]
pub(crate) struct Sides<'a> {
    pub(crate) track: SharedModel,
    pub(crate) a: &'a Participant,
    pub(crate) b: &'a Participant,
}

/// Quantity of a pair in one window.
pub(crate) struct Case<'a> {
    pub(crate) sides: Sides<'a>,
    pub(crate) quantity: &'a Quantity,
    pub(crate) window: &'a Window,
    pub(crate) metrics: &'a PairMetrics,
    /// Uncertainties of both sides; `None` without evidence.
    pub(crate) uncertainties: [Option<&'a QuantityUncertainty>; 2],
    /// True if runs may be compared sample by sample.
    pub(crate) pointwise: bool,
}

impl<'a> Case<'a> {
    /// Returns the metrics that are meaningful here.
    fn metrics(&self) -> impl Iterator<Item = Metric> {
        let pointwise = self.pointwise;
        Metric::of_pairs().filter(move |metric| pointwise || !metric.is_pointwise())
    }

    /// Returns both sides of the pair with their uncertainty in a metric.
    fn sides(&self, metric: Metric) -> [Side<'a>; 2] {
        let [of_a, of_b] = self.uncertainties;
        [(self.sides.a, of_a), (self.sides.b, of_b)].map(|(participant, of)| Side {
            name: &participant.name,
            uncertainty: relative(of, metric, self.metrics),
        })
    }

    /// Assesses a distance that is not finite.
    fn not_finite(&self, metric: Metric) -> Assessment {
        let Sides { a, b, .. } = self.sides;
        let spoiled = |p: &&Participant| {
            let mut values = p.time_series.channels().iter().flat_map(|c| &c.values);
            values.any(|v| !v.is_finite())
        };
        let who = &[a, b].into_iter().find(spoiled).unwrap_or(a).name;
        let result = Assessment {
            metric: Some(metric),
            ..Assessment::not_compared("")
        };
        let remedy = format!("look at the time series of {who}");
        result.inconclusive(who, "a value is not finite".to_owned(), remedy)
    }
}

impl Judge<'_> {
    /// Marks an inconclusive verdict as one without an action, if its participant has a final reason or the scene amplifies
    /// rounding.
    fn settled(&self, result: Assessment, pointwise: bool) -> Assessment {
        let own = result.participant.as_ref();
        let own = own.and_then(|name| self.rules.evidence_of(name));
        match own.and_then(|evidence| evidence.is_final.as_ref()) {
            Some(why) => result.beyond_settings(why.group, &why.reason),
            None if pointwise => result,
            None => result.beyond_settings(
                "figures of windows in which a rounding parts two runs",
                "a rounding parts two runs here, so figures are samples: only a longer run makes them sharper",
            ),
        }
    }

    /// Judges one quantity of a pair in one window, in one metric or several.
    pub(crate) fn pair(&self, case: &Case<'_>) -> Vec<Assessment> {
        let below = self.negligible.below(case.quantity);
        let below = below.zip(case.metrics.larger_peak);
        if let Some((below, _)) = below.filter(|(below, peak)| peak < below) {
            return vec![Assessment::not_compared(format!(
                "both stay below {below:.0e} {}: only rounding at the size of this scene",
                case.quantity.unit
            ))];
        }
        let (assessments, otherwise) = match case.sides.track {
            SharedModel::Measured => (
                [self.limits(case), self.measured(case)].concat(),
                "measured data: its map states neither `[[limits]]` nor `uncertainty` for this quantity and window",
            ),
            _ if self.rules.evidence.is_empty() => {
                (Vec::new(), "no numerical uncertainties are given")
            }
            SharedModel::OwnContact => (self.models(case), ""),
            SharedModel::Native | SharedModel::SharedLaw => (self.one_law(case), ""),
        };
        let settled = assessments.into_iter();
        let settled = settled.map(|one| self.settled(one, case.pointwise));
        let mut assessments: Vec<Assessment> = settled.collect();
        if !assessments.iter().any(|one| one.decides) {
            assessments.push(Assessment::not_compared(otherwise));
        }
        assessments
    }

    /// Compares a pair with the limits stated for measured data.
    fn limits(&self, case: &Case<'_>) -> Vec<Assessment> {
        let Sides { a, b, .. } = case.sides;
        let rows = self.rules.stated.iter().filter(|row| {
            [&a.name, &b.name].contains(&&row.engine)
                && row.window == case.window.kind
                && fits(&row.quantity, &case.quantity.name)
        });
        rows.map(|row| {
            let value = row.metric.of(case.metrics);
            Assessment::limit(row.metric, value, row.limit, &row.reason)
        })
        .collect()
    }

    /// Compares two participants with one contact law: any difference beyond the uncertainties is a finding.
    fn one_law(&self, case: &Case<'_>) -> Vec<Assessment> {
        let assess = |metric: Metric| {
            let decides = match case.pointwise {
                true => metric == Metric::RelativeL2,
                false => matches!(metric, Metric::Mean | Metric::Rms),
            };
            let sides = case.sides(metric);
            let result = match metric.of(case.metrics) {
                Some(d) => verdict::pair(metric, d, sides.each_ref(), self.rules.resolution),
                None if decides => case.not_finite(metric),
                None => return None,
            };
            Some(Assessment { decides, ..result })
        };
        case.metrics().filter_map(assess).collect()
    }

    /// Compares two participants of which at least one has its own contact model: interval of the difference against the stated
    /// tolerance.
    fn models(&self, case: &Case<'_>) -> Vec<Assessment> {
        let Sides { a, b, .. } = case.sides;
        let friction = self.context.friction_coefficient > 0.0;
        let tolerance = |engine: &Participant, metric: Metric| {
            let stated = self.rules.tolerances.iter();
            let mut own = stated.filter(|(name, _)| *name == engine.name);
            let here = |t: &ModelTolerance| {
                t.metric == metric && t.applies(friction, case.window.kind, &case.quantity.name)
            };
            own.find_map(|(_, t)| here(t).then_some(t))
        };
        let assess = |metric: Metric, distance: Option<f64>, allowed: Result<Allowed, &str>| {
            let (sides, resolution) = (case.sides(metric), self.rules.resolution);
            match distance {
                Some(d) => verdict::model(metric, d, sides.each_ref(), resolution, allowed),
                None => case.not_finite(metric),
            }
        };
        let mut assessments = Vec::new();
        for metric in case.metrics() {
            let own = [a, b]
                .into_iter()
                .filter(|p| p.track != SharedModel::Native);
            let own: Option<Vec<&ModelTolerance>> = own.map(|p| tolerance(p, metric)).collect();
            let Some(tolerances) = own else { continue };
            let mut predictions = tolerances.iter().map(|t| t.predicted);
            let energy = predictions.any(|of| of == Prediction::LawEnergy);
            let predicted = model::predicted(a, b, case.window).filter(|_| energy);
            // A prediction has a sign, so the difference compared with it needs one too.
            let distance = match predicted {
                Some(_) => case.metrics.signed_mean_difference(),
                None => metric.of(case.metrics),
            };
            let allowed = if energy && predicted.is_none() {
                Err("no energy account predicts this difference")
            } else {
                Ok(Allowed {
                    predicted: predicted.unwrap_or(0.0),
                    tolerance: tolerances.iter().map(|t| t.tolerance).sum(),
                    reason: tolerances.first().map_or("", |t| t.reason),
                })
            };
            assessments.push(assess(metric, distance, allowed));
        }
        if assessments.is_empty() {
            let metric = match case.pointwise {
                true => Metric::RelativeL2,
                false => Metric::Mean,
            };
            let nothing =
                "models that differ on purpose state no tolerance for this quantity and window";
            assessments.push(assess(metric, metric.of(case.metrics), Err(nothing)));
        }
        assessments
    }

    /// Compares a simulation with measured data of stated uncertainty.
    fn measured(&self, case: &Case<'_>) -> Vec<Assessment> {
        // E = S - D: index of the simulation S, and the sign that turns a - b into E.
        let (simulation, sign) = match [case.sides.a, case.sides.b].map(|p| p.track) {
            [SharedModel::Measured, SharedModel::Measured] => return Vec::new(),
            [SharedModel::Measured, _] => (1, -1.0),
            _ => (0, 1.0),
        };
        let data = &[case.sides.b, case.sides.a][simulation].name;
        let about = |d: &&crate::DataUncertainty| {
            d.engine == *data && fits(&d.quantity, &case.quantity.name)
        };
        let Some(stated) = self.rules.data.iter().find(about) else {
            return Vec::new();
        };
        let assess = |metric: Metric| {
            let mut sides = case.sides(metric);
            sides[1 - simulation] = Side::known(data, Estimate::stated(stated.data));
            let plain = metric.of(case.metrics);
            let signed = case.metrics.signed_mean_difference();
            let distance = match metric {
                Metric::Mean => signed.map(|d| sign * d).or(plain),
                _ => plain,
            };
            let result = match (distance, sides[simulation].u()) {
                (None, _) => case.not_finite(metric),
                (Some(error), Some(numerical)) => {
                    let budget = Budget::new(numerical, stated.input, stated.data);
                    verdict::measured(metric, error, sides.each_ref(), budget)
                }
                (Some(error), None) => {
                    verdict::pair(metric, error.abs(), sides.each_ref(), self.rules.resolution)
                }
            };
            Assessment {
                decides: metric == Metric::RelativeL2,
                ..result
            }
        };
        let metrics = [Metric::RelativeL2, Metric::Mean, Metric::Peak, Metric::Rms];
        metrics.map(assess).into()
    }

    /// Judges the torque balance of one engine's output shaft in a window of constant load. The uncertainty `u` of the mean
    /// torque, N m, widens the bound; if it is unknown, a larger remainder is inconclusive.
    pub(crate) fn load(
        &self,
        engine: &Participant,
        samples: Range<usize>,
        [load_n_m, inertia]: [f64; 2],
        u: Option<&Uncertainty>,
    ) -> Assessment {
        if load_n_m.abs() <= self.negligible.torque_n_m {
            return Assessment::not_compared("the scene has no load to compare with");
        }
        let steps = engine.cost.steps as f64 / engine.time_series.len() as f64;
        let result = balance::of(&engine.time_series, samples, load_n_m, inertia, steps);
        let Some(balance) = result else {
            return Assessment::not_compared("too few samples for the balance of the output shaft");
        };
        let share = |torque: f64| torque / load_n_m.abs();
        let rounding = share(self.negligible.torque_n_m + balance.rounding);
        let own = share(u.and_then(Uncertainty::u).unwrap_or(0.0));
        let quadrature = share(balance.quadrature);
        if quadrature > self.rules.resolution {
            return Assessment::not_compared(format!(
                "the samples are too far apart for the mean output torque, which is uncertain by {quadrature:.1e} of the load"
            ));
        }
        let left_over = share(balance.left_over.abs());
        let result = Assessment {
            u_a: Some(own),
            ..Assessment::limit(
                Metric::MeanAgainstLoad,
                left_over.is_finite().then_some(left_over),
                rounding + quadrature + own,
                "On average, contact forces and load give the output shaft its acceleration, for any law and engine.",
            )
        };
        let result = if !(own <= self.rules.resolution) {
            let reason = format!(
                "the mean is uncertain by {own:.1e} of the load, above the resolution of {:.0e}",
                self.rules.resolution
            );
            result.inconclusive(&engine.name, reason, format!("refine {}", engine.name))
        } else if let (Some(Uncertainty::Unknown(missing)), Verdict::Differ) = (u, result.verdict)
            && left_over.is_finite()
        {
            let (reason, remedy) = (missing.reason.clone(), missing.remedy.clone());
            result.inconclusive(&engine.name, reason, remedy)
        } else {
            result
        };
        self.settled(result, self.context.is_pointwise(f64::INFINITY))
    }
}

/// Returns one side's uncertainty in a metric, relative as the metric is.
fn relative(
    of: Option<&QuantityUncertainty>,
    metric: Metric,
    metrics: &PairMetrics,
) -> Result<Estimate, Unresolved> {
    let norm = metric.row().norm;
    match of.map(|of| of.of(norm)) {
        None => Err(Unresolved::new(
            "its numerical uncertainty is not known",
            "give the runs of its refinement study, or a recording with its uncertainty",
        )),
        Some(Uncertainty::Unknown(missing)) => Err(missing.clone()),
        Some(Uncertainty::Known(estimate)) => {
            let u = match metrics.larger(norm) {
                _ if estimate.u == 0.0 => Some(0.0),
                larger => larger.map(|larger| metric.sensitivity() * estimate.u / larger),
            };
            let known = u.filter(|u| u.is_finite());
            known.map(|u| Estimate { u, ..*estimate }).ok_or_else(|| {
                Unresolved::new(
                    "the quantity is zero throughout and its uncertainty is not",
                    "look at the runs of its refinement study",
                )
            })
        }
    }
}
