//! From distances, uncertainties and limits to a verdict.

use crate::comparison::Judgement;
use crate::limits::{NEGLIGIBLE_SHARE, fits};
use crate::metrics::{Metric, PairMetrics};
use crate::model::{self, ModelTolerance, Prediction};
use crate::participant::{Context, Participant, Track};
use crate::quantities::Quantity;
use crate::rules::Rules;
use crate::uncertainty::{Estimate, QuantityUncertainty, Uncertainty, Unresolved};
use crate::validation::Budget;
use crate::verdict::{self, Check, Outcome, Side, Verdict};
use crate::windows::{Window, WindowKind};

/// What a verdict depends on besides the numbers.
#[derive(Clone, Copy)]
pub(crate) struct Judge<'a> {
    /// Limits, evidence, tolerances.
    pub(crate) rules: &'a Rules<'a>,
    /// Whether the scene has friction.
    pub(crate) friction: bool,
    /// Whether the table of limits guards this scene.
    pub(crate) guarded: bool,
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
                .flat_map(|name| finished.iter().filter_map(|p| p.courses.channel(name)))
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

/// What was found of one quantity of a pair in one window.
pub(crate) struct Judged {
    pub(crate) checks: Vec<Check>,
    pub(crate) judgements: Vec<Judgement>,
    pub(crate) verdict: Verdict,
}

impl Judged {
    fn not(reason: String) -> Self {
        Self {
            checks: Vec::new(),
            judgements: Vec::new(),
            verdict: Verdict::NotJudged { reason },
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

impl Judge<'_> {
    /// What is not resolved, marked as stated where its participant says why it has to be so, or where the scene itself
    /// parts runs by their roundings.
    pub(crate) fn excused(&self, mut verdict: Verdict, pointwise: bool) -> Verdict {
        if let Verdict::NotResolved {
            participant,
            reason,
            stated,
            ..
        } = &mut verdict
        {
            let mut evidence = self.rules.evidence.iter();
            let own = evidence.find(|e| e.engine == *participant);
            if let Some(excuse) = own.and_then(|e| e.excuse.as_ref()) {
                *reason = format!("{reason}; {excuse}");
                *stated = true;
            } else if !pointwise {
                *reason = format!(
                    "{reason}; a rounding parts two runs here, so figures are samples: only a longer run makes them sharper"
                );
                *stated = true;
            }
        }
        verdict
    }

    /// Judges one quantity of a pair in one window.
    pub(crate) fn pair(
        &self,
        sides: Sides<'_>,
        quantity: &Quantity,
        window: &Window,
        metrics: &PairMetrics,
        uncertainties: Uncertainties<'_>,
    ) -> Judged {
        let Sides { a, b, .. } = sides;
        let below = self.negligible.below(quantity);
        if let Some(below) = below
            .zip(metrics.larger_peak)
            .filter(|(below, peak)| peak < below)
        {
            let below = below.0;
            return Judged::not(format!(
                "both stay below {below:.0e} {}: only rounding at the size of this scene",
                quantity.unit
            ));
        }
        let measured = [a, b].iter().any(|p| p.track == Track::Measured);
        let (checks, reason) = if measured {
            self.stated(&[&a.name, &b.name], quantity, window.kind, metrics)
        } else {
            self.guard(sides, quantity, window, metrics)
        };
        let mut judgements = if measured {
            self.validation(sides, quantity, metrics, uncertainties)
        } else if self.rules.evidence.is_empty() {
            Vec::new()
        } else if [Track::Native, Track::SharedLaw].contains(&sides.track) {
            self.one_law(sides, window, metrics, uncertainties)
        } else {
            self.models(sides, quantity, window, metrics, uncertainties)
        };
        for judgement in &mut judgements {
            let pointwise = self.context.is_pointwise(window.to_s);
            judgement.verdict = self.excused(judgement.verdict.clone(), pointwise);
            // Where the guard's table speaks, what a ladder cannot say takes nothing from it.
            let silent = [Outcome::Stated, Outcome::NotResolved];
            judgement.counts &= checks.is_empty() || !silent.contains(&judgement.verdict.outcome());
        }
        let of_checks: Vec<Verdict> = checks.iter().map(Check::verdict).collect();
        let counting = judgements.iter().filter(|j| j.counts).map(|j| &j.verdict);
        let verdict = Verdict::worst(counting.chain(&of_checks))
            .cloned()
            .unwrap_or(Verdict::NotJudged { reason });
        Judged {
            checks,
            judgements,
            verdict,
        }
    }

    /// What is stated for measured data.
    fn stated(
        &self,
        names: &[&String],
        quantity: &Quantity,
        window: WindowKind,
        metrics: &PairMetrics,
    ) -> (Vec<Check>, String) {
        let rows = self.rules.stated.iter().filter(|row| {
            names.contains(&&row.engine)
                && row.window == window
                && fits(&row.quantity, &quantity.name)
        });
        let checks: Vec<Check> = rows
            .map(|row| {
                let value = (row.metric.row().of)(metrics);
                Check {
                    metric: row.metric,
                    value,
                    limit: row.limit,
                    measured: None,
                    reason: row.reason.clone(),
                    within: value.is_some_and(|value| value <= row.limit),
                }
            })
            .collect();
        let reason =
            "measured data: no limit and no uncertainty is stated for this quantity and window";
        (checks, reason.to_owned())
    }

    /// Two participants of one law: any difference beyond the uncertainties is a finding.
    fn one_law(
        &self,
        Sides { a, b, .. }: Sides<'_>,
        window: &Window,
        metrics: &PairMetrics,
        [of_a, of_b]: Uncertainties<'_>,
    ) -> Vec<Judgement> {
        let pointwise = self.context.is_pointwise(window.to_s);
        let counts = |metric| {
            if pointwise {
                metric == Metric::RelativeL2
            } else {
                matches!(metric, Metric::Mean | Metric::Rms)
            }
        };
        let metrics_there = Metric::of_pairs().filter(|metric| pointwise || !metric.is_pointwise());
        metrics_there
            .filter_map(|metric| {
                let (one, other) = (
                    side(a, of_a, metric, metrics),
                    side(b, of_b, metric, metrics),
                );
                let distance = (metric.row().of)(metrics);
                let verdict = match distance {
                    Some(distance) => verdict::pair(distance, &one, &other, self.rules.resolution),
                    None if counts(metric) => not_finite(a, b),
                    None => return None,
                };
                Some(judgement(
                    metric,
                    distance,
                    &one,
                    &other,
                    counts(metric),
                    verdict,
                ))
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
    ) -> Vec<Judgement> {
        let pointwise = self.context.is_pointwise(window.to_s);
        let statement = |engine: &Participant, metric: Metric| {
            self.rules.tolerances.iter().find(|t| {
                t.metric == metric
                    && t.applies(&engine.name, self.friction, window.kind, &quantity.name)
            })
        };
        let mut found = Vec::new();
        for metric in Metric::of_pairs().filter(|m| pointwise || !m.is_pointwise()) {
            let own: Vec<&Participant> = [a, b]
                .into_iter()
                .filter(|p| p.track != Track::Native)
                .collect();
            let Some(statements) = own
                .iter()
                .map(|p| statement(p, metric))
                .collect::<Option<Vec<&ModelTolerance>>>()
            else {
                continue;
            };
            let energy = statements
                .iter()
                .any(|t| t.predicted == Prediction::LawEnergy);
            let predicted = energy.then(|| model::predicted(a, b, window)).flatten();
            // A prediction has a sign, and so has the difference that is held against it.
            let distance = match predicted {
                Some(_) => metrics.signed_mean_difference(),
                None => (metric.row().of)(metrics),
            };
            let (one, other) = (
                side(a, of_a, metric, metrics),
                side(b, of_b, metric, metrics),
            );
            let tolerance = statements.iter().map(|t| t.tolerance).sum();
            let verdict = match distance {
                Some(d) => {
                    let tolerance = (!energy || predicted.is_some()).then_some(tolerance);
                    verdict::model(
                        d,
                        &one,
                        &other,
                        self.rules.resolution,
                        predicted.unwrap_or(0.0),
                        tolerance,
                    )
                }
                None => not_finite(a, b),
            };
            found.push(Judgement {
                reason: statements.first().map_or("", |t| t.reason),
                ..judgement(metric, distance, &one, &other, true, verdict)
            });
        }
        if found.is_empty() {
            let metric = if pointwise {
                Metric::RelativeL2
            } else {
                Metric::Mean
            };
            let (one, other) = (
                side(a, of_a, metric, metrics),
                side(b, of_b, metric, metrics),
            );
            let distance = (metric.row().of)(metrics);
            let verdict = match distance {
                Some(d) => verdict::model(d, &one, &other, self.rules.resolution, 0.0, None),
                None => not_finite(a, b),
            };
            // Nothing is stated of this quantity, so nothing can fail: what is not resolved is told and not counted.
            let counts = matches!(verdict, Verdict::ModelDifference { .. });
            found.push(judgement(metric, distance, &one, &other, counts, verdict));
        }
        found
    }

    /// A simulation against measured data whose owner states their uncertainty.
    fn validation(
        &self,
        Sides { a, b, .. }: Sides<'_>,
        quantity: &Quantity,
        metrics: &PairMetrics,
        [of_a, of_b]: Uncertainties<'_>,
    ) -> Vec<Judgement> {
        let (data, simulation, of_simulation) = match (a.track, b.track) {
            (Track::Measured, Track::Measured) => return Vec::new(),
            (Track::Measured, _) => (a, b, of_b),
            _ => (b, a, of_a),
        };
        let Some(stated) = self
            .rules
            .data
            .iter()
            .find(|d| d.engine == data.name && fits(&d.quantity, &quantity.name))
        else {
            return Vec::new();
        };
        let metrics_there = [Metric::RelativeL2, Metric::Mean, Metric::Peak, Metric::Rms];
        metrics_there
            .into_iter()
            .map(|metric| {
                let one = side(simulation, of_simulation, metric, metrics);
                let nothing = Side::known(&data.name, Estimate::stated(0.0));
                let signed = |d: f64| {
                    // E = S - D.
                    if simulation.name == a.name { d } else { -d }
                };
                let distance = match metric {
                    Metric::Mean => metrics
                        .signed_mean_difference()
                        .map(signed)
                        .or(metrics.mean_difference),
                    _ => (metric.row().of)(metrics),
                };
                let budget = one
                    .uncertainty
                    .as_ref()
                    .ok()
                    .map(|e| Budget::new(e.u, stated.input, stated.data));
                let verdict = match (distance, &budget) {
                    (None, _) => not_finite(a, b),
                    (Some(error), Some(budget)) => budget.verdict(error),
                    (Some(_), None) => verdict::combined(&one, &nothing)
                        .err()
                        .unwrap_or_else(|| not_finite(a, b)),
                };
                let u_of = |p: &Participant| {
                    if p.name == simulation.name {
                        one.uncertainty.as_ref().ok().map(|e| e.u)
                    } else {
                        Some(stated.data)
                    }
                };
                Judgement {
                    metric,
                    distance,
                    u_a: u_of(a),
                    u_b: u_of(b),
                    counts: metric == Metric::RelativeL2,
                    budget,
                    reason: "",
                    verdict,
                }
            })
            .collect()
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
            "give the runs of its ladder, or a recording that holds its uncertainty",
        )),
        Some(Uncertainty::NotResolved(missing)) => Err(missing.clone()),
        Some(Uncertainty::Resolved(estimate)) => {
            let relative = match (row.scale)(metrics) {
                _ if estimate.u == 0.0 => Some(0.0),
                Some(scale) => Some(row.sensitivity * estimate.u / scale),
                None => None,
            };
            match relative.filter(|u| u.is_finite()) {
                Some(u) => Ok(Estimate { u, ..*estimate }),
                None => Err(Unresolved::new(
                    "the quantity is zero throughout and its uncertainty is not",
                    "look at the runs of its ladder",
                )),
            }
        }
    };
    Side {
        name: &participant.name,
        uncertainty,
    }
}

pub(crate) fn judgement(
    metric: Metric,
    distance: Option<f64>,
    a: &Side<'_>,
    b: &Side<'_>,
    counts: bool,
    verdict: Verdict,
) -> Judgement {
    let u = |side: &Side<'_>| side.uncertainty.as_ref().ok().map(|e| e.u);
    Judgement {
        metric,
        distance,
        u_a: u(a),
        u_b: u(b),
        counts,
        budget: None,
        reason: "",
        verdict,
    }
}

/// A distance that has no value.
fn not_finite(a: &Participant, b: &Participant) -> Verdict {
    let spoiled = |p: &&&Participant| {
        let channels = p.courses.channels();
        channels
            .iter()
            .any(|c| c.values.iter().any(|v| !v.is_finite()))
    };
    let who = [a, b].iter().find(spoiled).map_or(a, |p| *p);
    Verdict::NotResolved {
        participant: who.name.clone(),
        u: None,
        reason: "a value is not finite".to_owned(),
        remedy: format!("look at the time series of {}", who.name),
        stated: false,
    }
}
