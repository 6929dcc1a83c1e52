//! From distances, uncertainties and limits to a verdict.

use crate::limits::{NEGLIGIBLE_SHARE, fits};
use crate::metrics::{Metric, PairMetrics};
use crate::model::{self, ModelTolerance, Prediction};
use crate::participant::{Context, Participant, Track};
use crate::quantities::Quantity;
use crate::rules::Rules;
use crate::uncertainty::{Estimate, Final, QuantityUncertainty, Uncertainty, Unresolved};
use crate::validation::Budget;
use crate::verdict::{self, Allowed, Assessment, Side, Verdict};
use crate::windows::Window;

/// What a verdict depends on besides the numbers.
#[derive(Clone, Copy)]
pub(crate) struct Judge<'a> {
    /// Limits, evidence, tolerances.
    pub(crate) rules: &'a Rules<'a>,
    /// Whether the scene has friction.
    pub(crate) friction: bool,
    /// The scene, for its divergence horizon.
    pub(crate) context: &'a Context,
    /// Force (N) and torque (N m) below which a load is rounding.
    pub(crate) negligible: Negligible,
}

/// Angles below this are roundings of a radian.
const ROUNDED_RAD: f64 = 1e-15;

/// Loads below these are rounding.
#[derive(Clone, Copy)]
pub(crate) struct Negligible {
    pub(crate) force_n: f64,
    pub(crate) torque_n_m: f64,
}

impl Negligible {
    /// From the scene's own sizes, or where they are not stated from the largest loads there are.
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
        let force_n = context
            .scales
            .force_n
            .unwrap_or_else(|| largest(Quantity::is_force));
        let torque_n_m = context
            .scales
            .torque_n_m
            .unwrap_or_else(|| largest(Quantity::is_torque));
        Self {
            force_n: NEGLIGIBLE_SHARE * force_n.abs(),
            torque_n_m: NEGLIGIBLE_SHARE * torque_n_m.abs(),
        }
    }

    /// Of one quantity; `None` for what is neither a load nor an angle.
    fn below(&self, quantity: &Quantity) -> Option<f64> {
        if quantity.is_force() {
            Some(self.force_n)
        } else {
            quantity.is_torque().then_some(self.torque_n_m).or_else(|| {
                // An angle has no size to scale with: a gear that stands still turns by roundings of a radian.
                (quantity.unit == "rad").then_some(ROUNDED_RAD)
            })
        }
    }
}

/// The uncertainties of both sides of a pair; `None` where no evidence was given.
pub(crate) type Uncertainties<'a> = [Option<&'a QuantityUncertainty>; 2];

/// Two engines and the track they are compared on.
#[derive(Clone, Copy)]
pub(crate) struct Sides<'a> {
    pub(crate) track: Track,
    pub(crate) a: &'a Participant,
    pub(crate) b: &'a Participant,
}

/// In the mean the contact forces on the output shaft balance the load, whatever law and engine: to this share of it.
pub const LOAD_BALANCE: f64 = 1e-4;

impl Judge<'_> {
    /// What is inconclusive, with nothing to act on where its participant says why it has to be so, or where the scene itself
    /// parts runs by their roundings.
    fn settled(&self, found: Assessment, pointwise: bool) -> Assessment {
        let parted = || {
            Final {
            group: "figures of windows in which a rounding parts two runs",
            reason: "a rounding parts two runs here, so figures are samples: only a longer run makes them sharper"
                .to_owned(),
        }
        };
        let own = found.participant.as_ref();
        let own = own.and_then(|name| self.rules.evidence_of(name));
        let why = own.and_then(|e| e.is_final.clone());
        match why.or_else(|| (!pointwise).then(parted)) {
            Some(why) => found.beyond_settings(&why),
            None => found,
        }
    }

    /// Judges one quantity of a pair in one window, in one metric or several.
    pub(crate) fn pair(
        &self,
        sides: Sides<'_>,
        quantity: &Quantity,
        window: &Window,
        metrics: &PairMetrics,
        uncertainties: Uncertainties<'_>,
    ) -> Vec<Assessment> {
        let below = self.negligible.below(quantity).zip(metrics.larger_peak);
        if let Some((below, _)) = below.filter(|(below, peak)| peak < below) {
            return vec![Assessment::not_compared(format!(
                "both stay below {below:.0e} {}: only rounding at the size of this scene",
                quantity.unit
            ))];
        }
        let pointwise = self.context.is_pointwise(window.to_s);
        let (found, otherwise) = if sides.track == Track::Measured {
            let mut found = self.limits(sides, quantity, window, metrics);
            found.extend(self.measured(sides, quantity, metrics, uncertainties));
            let nothing =
                "measured data: no limit and no uncertainty is stated for this quantity and window";
            (found, nothing)
        } else if self.rules.evidence.is_empty() {
            (Vec::new(), "no numerical uncertainties are given")
        } else if sides.track == Track::OwnContact {
            (
                self.models(sides, quantity, window, metrics, uncertainties),
                "",
            )
        } else {
            (self.one_law(sides, window, metrics, uncertainties), "")
        };
        let mut found: Vec<Assessment> = found
            .into_iter()
            .map(|one| self.settled(one, pointwise))
            .collect();
        if !found.iter().any(|one| one.decides) {
            found.push(Assessment::not_compared(otherwise));
        }
        found
    }

    /// Limits stated for measured data.
    fn limits(
        &self,
        Sides { a, b, .. }: Sides<'_>,
        quantity: &Quantity,
        window: &Window,
        metrics: &PairMetrics,
    ) -> Vec<Assessment> {
        let rows = self.rules.stated.iter().filter(|row| {
            [&a.name, &b.name].contains(&&row.engine)
                && row.window == window.kind
                && fits(&row.quantity, &quantity.name)
        });
        rows.map(|row| {
            let value = (row.metric.row().of)(metrics);
            Assessment::limit(row.metric, value, row.limit, &row.reason)
        })
        .collect()
    }

    /// Two participants of one law: any difference beyond the uncertainties is a finding.
    fn one_law(
        &self,
        Sides { a, b, .. }: Sides<'_>,
        window: &Window,
        metrics: &PairMetrics,
        [of_a, of_b]: Uncertainties<'_>,
    ) -> Vec<Assessment> {
        let pointwise = self.context.is_pointwise(window.to_s);
        let decides = |metric| {
            if pointwise {
                metric == Metric::RelativeL2
            } else {
                matches!(metric, Metric::Mean | Metric::Rms)
            }
        };
        let metrics_there = Metric::of_pairs().filter(|metric| pointwise || !metric.is_pointwise());
        metrics_there
            .filter_map(|metric| {
                let sides = [
                    &side(a, of_a, metric, metrics),
                    &side(b, of_b, metric, metrics),
                ];
                let found = match (metric.row().of)(metrics) {
                    Some(d) => verdict::pair(metric, d, sides, self.rules.resolution),
                    None if decides(metric) => not_finite(metric, a, b),
                    None => return None,
                };
                Some(Assessment {
                    decides: decides(metric),
                    ..found
                })
            })
            .collect()
    }

    /// At least one contact model of its own: the interval of the difference, against what the engine states.
    fn models(
        &self,
        Sides { a, b, .. }: Sides<'_>,
        quantity: &Quantity,
        window: &Window,
        metrics: &PairMetrics,
        [of_a, of_b]: Uncertainties<'_>,
    ) -> Vec<Assessment> {
        let pointwise = self.context.is_pointwise(window.to_s);
        let tolerance = |engine: &Participant, metric: Metric| {
            let stated = self.rules.tolerances.iter();
            let mut own = stated.filter(|(name, _)| *name == engine.name);
            let here = |t: &ModelTolerance| {
                t.metric == metric && t.applies(self.friction, window.kind, &quantity.name)
            };
            own.find_map(|(_, t)| here(t).then_some(t))
        };
        let assess = |metric: Metric, distance: Option<f64>, allowed: Result<Allowed, &str>| {
            let sides = [
                &side(a, of_a, metric, metrics),
                &side(b, of_b, metric, metrics),
            ];
            match distance {
                Some(d) => verdict::model(metric, d, sides, self.rules.resolution, allowed),
                None => not_finite(metric, a, b),
            }
        };
        let mut found = Vec::new();
        for metric in Metric::of_pairs().filter(|m| pointwise || !m.is_pointwise()) {
            let own = [a, b].into_iter().filter(|p| p.track != Track::Native);
            let Some(tolerances) = own
                .map(|p| tolerance(p, metric))
                .collect::<Option<Vec<&ModelTolerance>>>()
            else {
                continue;
            };
            let energy = tolerances
                .iter()
                .any(|t| t.predicted == Prediction::LawEnergy);
            let predicted = energy.then(|| model::predicted(a, b, window)).flatten();
            // A prediction has a sign, and so has the difference that is held against it.
            let distance = match predicted {
                Some(_) => metrics.signed_mean_difference(),
                None => (metric.row().of)(metrics),
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
            found.push(assess(metric, distance, allowed));
        }
        if found.is_empty() {
            let metric = if pointwise {
                Metric::RelativeL2
            } else {
                Metric::Mean
            };
            let nothing =
                "models that differ on purpose state no tolerance for this quantity and window";
            found.push(assess(metric, (metric.row().of)(metrics), Err(nothing)));
        }
        found
    }

    /// A simulation against measured data whose owner states their uncertainty.
    fn measured(
        &self,
        Sides { a, b, .. }: Sides<'_>,
        quantity: &Quantity,
        metrics: &PairMetrics,
        [of_a, of_b]: Uncertainties<'_>,
    ) -> Vec<Assessment> {
        let (data, simulation, of_simulation, sign) = match (a.track, b.track) {
            (Track::Measured, Track::Measured) => return Vec::new(),
            // E = S - D.
            (Track::Measured, _) => (a, b, of_b, -1.0),
            _ => (b, a, of_a, 1.0),
        };
        let about = |d: &&crate::DataUncertainty| {
            d.engine == data.name && fits(&d.quantity, &quantity.name)
        };
        let Some(stated) = self.rules.data.iter().find(about) else {
            return Vec::new();
        };
        let metrics_there = [Metric::RelativeL2, Metric::Mean, Metric::Peak, Metric::Rms];
        let assess = |metric: Metric| {
            let one = side(simulation, of_simulation, metric, metrics);
            let other = Side::known(&data.name, Estimate::stated(stated.data));
            let sides = if sign > 0.0 {
                [&one, &other]
            } else {
                [&other, &one]
            };
            let plain = (metric.row().of)(metrics);
            let distance = match metric {
                Metric::Mean => metrics.signed_mean_difference().map(|d| sign * d).or(plain),
                _ => plain,
            };
            let found = match (distance, &one.uncertainty) {
                (None, _) => not_finite(metric, a, b),
                (Some(error), Ok(numerical)) => {
                    let budget = Budget::new(numerical.u, stated.input, stated.data);
                    verdict::measured(metric, error, sides, budget)
                }
                (Some(error), Err(_)) => {
                    verdict::pair(metric, error.abs(), sides, self.rules.resolution)
                }
            };
            Assessment {
                decides: metric == Metric::RelativeL2,
                ..found
            }
        };
        metrics_there.into_iter().map(assess).collect()
    }

    /// Judges the mean output torque of one engine against the load, on any scene: this is mechanics. `u`: the
    /// uncertainty of that mean, N m, which widens the limit; where it is not known, a mean beyond the limit is inconclusive.
    pub(crate) fn load(
        &self,
        engine: &Participant,
        mean: Option<f64>,
        load_n_m: f64,
        u: Option<&Uncertainty>,
    ) -> Assessment {
        if load_n_m.abs() <= self.negligible.torque_n_m {
            return Assessment::not_compared("the scene has no load to compare with");
        }
        if engine.cost.recorded.is_some() {
            // One sample a millisecond aliases the ripple into the mean: 1e-4 of it for 40 sleeves.
            return Assessment::not_compared("a recording has too few samples for this mean");
        }
        let value = mean.map(|mean| (mean + load_n_m).abs() / load_n_m.abs());
        let share = u.and_then(Uncertainty::u).unwrap_or(0.0) / load_n_m.abs();
        let found = Assessment {
            u_a: Some(share),
            ..Assessment::limit(
                Metric::MeanAgainstLoad,
                value,
                LOAD_BALANCE + share,
                "In the mean the contact forces on the output shaft balance the load, whatever the law and engine.",
            )
        };
        let found = if !(share <= self.rules.resolution) {
            let reason = format!(
                "the mean is uncertain by {share:.1e} of the load, above the resolution of {:.0e}",
                self.rules.resolution
            );
            found.inconclusive(&engine.name, reason, format!("refine {}", engine.name))
        } else if let (Some(Uncertainty::Unknown(missing)), Verdict::Differ) = (u, found.verdict)
            && value.is_some()
        {
            let (reason, remedy) = (missing.reason.clone(), missing.remedy.clone());
            found.inconclusive(&engine.name, reason, remedy)
        } else {
            found
        };
        self.settled(found, self.context.is_pointwise(f64::INFINITY))
    }
}

/// One side's uncertainty in a metric, relative as the metric is.
fn side<'a>(
    participant: &'a Participant,
    of: Option<&QuantityUncertainty>,
    metric: Metric,
    metrics: &PairMetrics,
) -> Side<'a> {
    let row = metric.row();
    let uncertainty = match of.map(|of| of.of(row.norm)) {
        None => Err(Unresolved::new(
            "its numerical uncertainty is not known",
            "give the runs of its refinement study, or a recording that holds its uncertainty",
        )),
        Some(Uncertainty::Unknown(missing)) => Err(missing.clone()),
        Some(Uncertainty::Known(estimate)) => {
            let relative = match (row.scale)(metrics) {
                _ if estimate.u == 0.0 => Some(0.0),
                Some(scale) => Some(row.sensitivity * estimate.u / scale),
                None => None,
            };
            match relative.filter(|u| u.is_finite()) {
                Some(u) => Ok(Estimate { u, ..*estimate }),
                None => Err(Unresolved::new(
                    "the quantity is zero throughout and its uncertainty is not",
                    "look at the runs of its refinement study",
                )),
            }
        }
    };
    Side {
        name: &participant.name,
        uncertainty,
    }
}

/// A distance that has no value.
fn not_finite(metric: Metric, a: &Participant, b: &Participant) -> Assessment {
    let spoiled = |p: &&&Participant| {
        let channels = p.time_series.channels();
        channels
            .iter()
            .any(|c| c.values.iter().any(|v| !v.is_finite()))
    };
    let who = [a, b].iter().find(spoiled).map_or(a, |p| *p);
    let found = Assessment {
        metric: Some(metric),
        ..Assessment::not_compared("")
    };
    let remedy = format!("look at the time series of {}", who.name);
    found.inconclusive(&who.name, "a value is not finite".to_owned(), remedy)
}
