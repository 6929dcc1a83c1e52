//! From the table of limits to a verdict.

use crate::limits::{Friction, Limit, Metric, NEGLIGIBLE, StatedLimit, fits};
use crate::metrics::PairMetrics;
use crate::participant::{Context, Participant, track};
use crate::quantities::Quantity;
use crate::verdict::{Check, Verdict};
use crate::windows::{Window, WindowKind};

/// Metrics that judge a pair, in the order of a report.
const PAIR_METRICS: [Metric; 6] = [
    Metric::RelativeL2,
    Metric::RelativeLinf,
    Metric::Mean,
    Metric::Peak,
    Metric::Rms,
    Metric::SpragueGeers,
];

/// What a verdict depends on besides the numbers.
#[derive(Clone, Copy)]
pub(crate) struct Judge<'a> {
    /// The table.
    pub(crate) limits: &'a [Limit],
    /// Limits of measured participants.
    pub(crate) stated: &'a [StatedLimit],
    /// Whether the scene has friction.
    pub(crate) friction: bool,
    /// The scene, for its divergence horizon.
    pub(crate) context: &'a Context,
}

/// Two engines and the track they are compared on.
#[derive(Clone, Copy)]
pub(crate) struct Sides<'a> {
    pub(crate) track: &'a str,
    pub(crate) a: &'a Participant,
    pub(crate) b: &'a Participant,
}

/// Whether a row applies, and if not, by how little.
enum Fit {
    Yes,
    /// It would but for this.
    But(String),
    No,
}

impl Judge<'_> {
    /// Judges one quantity of a pair in one window.
    pub(crate) fn pair(
        &self,
        Sides { track, a, b }: Sides<'_>,
        quantity: &Quantity,
        window: &Window,
        metrics: &PairMetrics,
    ) -> (Vec<Check>, Verdict) {
        let pointwise = self.context.is_pointwise(window.to_s);
        if quantity.is_load() && metrics.larger_peak.is_some_and(|peak| peak < NEGLIGIBLE) {
            let reason = format!(
                "both stay below {NEGLIGIBLE:e} {}: only rounding",
                quantity.unit
            );
            return (Vec::new(), Verdict::NotJudged { reason });
        }
        if [a, b].iter().any(|p| p.track == track::MEASURED) {
            return self.measured(&[&a.name, &b.name], quantity, window.kind, metrics);
        }
        let rows = self.limits.iter().filter(|row| {
            row.metric != Metric::MeanAgainstLoad
                && row.window == window.kind
                && (pointwise || !row.metric.is_pointwise())
                && fits(row.quantity, &quantity.name)
                && fits(row.track, track)
        });
        let (mut checks, mut reason) = (Vec::new(), None);
        for metric in PAIR_METRICS {
            for row in rows.clone().filter(|row| row.metric == metric) {
                match self.fit(row, a, b) {
                    Fit::Yes => {
                        let value = value(metrics, metric);
                        checks.push(check(row, value, row.limit, row.reason.to_owned()));
                        break;
                    }
                    Fit::But(why) => reason = reason.or(Some(why)),
                    Fit::No => {}
                }
            }
        }
        if checks.is_empty() && a.track != track::NATIVE && b.track != track::NATIVE {
            let rows: Vec<_> = rows.collect();
            checks = self.through_native(&rows, a, b, metrics);
        }
        let reason = reason.unwrap_or_else(|| {
            if pointwise {
                "no limit for this pair and window".to_owned()
            } else {
                "beyond the divergence horizon, where only statistics are judged, and no limit for them"
                    .to_owned()
            }
        });
        let verdict = verdict(&checks, reason);
        (checks, verdict)
    }

    /// Judges a pair of which one is measured: by what is stated for it, by nothing else.
    fn measured(
        &self,
        names: &[&String],
        quantity: &Quantity,
        window: WindowKind,
        metrics: &PairMetrics,
    ) -> (Vec<Check>, Verdict) {
        let rows = self.stated.iter().filter(|row| {
            names.contains(&&row.engine)
                && row.window == window
                && fits(&row.quantity, &quantity.name)
        });
        let checks: Vec<Check> = rows
            .map(|row| {
                let value = value(metrics, row.metric);
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
        let reason = "measured data: no limit is stated for this quantity and window".to_owned();
        let verdict = verdict(&checks, reason);
        (checks, verdict)
    }

    /// Two foreign engines without a limit of their own may be as far apart as both are allowed
    /// to be from a native run: the triangle inequality.
    fn through_native(
        &self,
        rows: &[&Limit],
        a: &Participant,
        b: &Participant,
        metrics: &PairMetrics,
    ) -> Vec<Check> {
        let leg = |engine: &Participant, metric: Metric| {
            rows.iter().copied().find(|row| {
                row.metric == metric
                    && fits(row.against, track::NATIVE)
                    && fits(row.engine, &engine.name)
                    && row.against_step_at_most_s.is_none()
                    && self.suits(row.friction)
                    && step_suits(engine, row.step_at_most_s)
            })
        };
        PAIR_METRICS
            .iter()
            .filter_map(|&metric| {
                let (one, other) = (leg(a, metric)?, leg(b, metric)?);
                let reason = format!(
                    "Each may be this far from a native run: {:e} + {:e}.",
                    one.limit, other.limit
                );
                let limit = one.limit + other.limit;
                Some(Check {
                    measured: None,
                    ..check(one, value(metrics, metric), limit, reason)
                })
            })
            .collect()
    }

    /// Judges the mean output torque of one engine against the load.
    pub(crate) fn load(
        &self,
        engine: &Participant,
        quantity: &Quantity,
        window: WindowKind,
        mean: Option<f64>,
        load_n_m: f64,
    ) -> Option<(Vec<Check>, Verdict)> {
        let row = self.limits.iter().find(|row| {
            row.metric == Metric::MeanAgainstLoad
                && row.window == window
                && fits(row.quantity, &quantity.name)
                && fits(row.track, &engine.track)
                && fits(row.engine, &engine.name)
                && self.suits(row.friction)
                && step_suits(engine, row.step_at_most_s)
        })?;
        if load_n_m.abs() < NEGLIGIBLE {
            let reason = "the scene has no load to compare with".to_owned();
            return Some((Vec::new(), Verdict::NotJudged { reason }));
        }
        let value = mean.map(|mean| (mean + load_n_m).abs() / load_n_m.abs());
        let checks = vec![check(row, value, row.limit, row.reason.to_owned())];
        let verdict = verdict(&checks, String::new());
        Some((checks, verdict))
    }

    fn suits(&self, friction: Friction) -> bool {
        match friction {
            Friction::Any => true,
            Friction::With => self.friction,
            Friction::Without => !self.friction,
        }
    }

    fn fit(&self, row: &Limit, a: &Participant, b: &Participant) -> Fit {
        let mut almost = Fit::No;
        for (engine, other) in [(a, b), (b, a)] {
            // Two native runs may both fit `native*`: a row is about two engines.
            if !fits(row.engine, &engine.name) || !fits(row.against, &other.name) {
                continue;
            }
            if !self.suits(row.friction) {
                let scenes = if self.friction { "without" } else { "with" };
                almost = Fit::But(format!("the limit is for scenes {scenes} friction"));
                continue;
            }
            let steps = [
                (engine, row.step_at_most_s),
                (other, row.against_step_at_most_s),
            ];
            match steps
                .iter()
                .find(|(engine, largest)| !step_suits(engine, *largest))
            {
                None => return Fit::Yes,
                Some((engine, largest)) => {
                    almost = Fit::But(format!(
                        "the limit is for steps of {} up to {:e} s; this run used {:e} s",
                        engine.name,
                        largest.unwrap_or(f64::NAN),
                        engine.cost.step_s
                    ));
                }
            }
        }
        almost
    }
}

fn step_suits(engine: &Participant, largest_s: Option<f64>) -> bool {
    // The mean step of an adaptive run is a quotient: allow for its rounding.
    largest_s.is_none_or(|largest| {
        engine.cost.step_s > 0.0 && engine.cost.step_s <= largest * (1.0 + 1e-9)
    })
}

fn check(row: &Limit, value: Option<f64>, limit: f64, reason: String) -> Check {
    // What has no value, because a course is not finite, is never within.
    let within = value.is_some_and(|value| value <= limit);
    Check {
        metric: row.metric,
        value,
        limit,
        measured: row.measured,
        reason,
        within,
    }
}

fn value(metrics: &PairMetrics, metric: Metric) -> Option<f64> {
    match metric {
        Metric::RelativeL2 => metrics.relative_l2,
        Metric::RelativeLinf => metrics.relative_linf,
        Metric::Mean => metrics.mean_difference,
        Metric::Peak => metrics.peak_difference,
        Metric::Rms => metrics.rms_difference,
        Metric::SpragueGeers => metrics.sprague_geers_c,
        Metric::MeanAgainstLoad => None,
    }
}

fn verdict(checks: &[Check], otherwise: String) -> Verdict {
    if checks.is_empty() {
        Verdict::NotJudged { reason: otherwise }
    } else if checks.iter().all(|check| check.within) {
        Verdict::Within
    } else {
        Verdict::Exceeded
    }
}

/// The worst of several verdicts: exceeded before within before not judged.
pub(crate) fn worst<'a>(verdicts: impl IntoIterator<Item = &'a Verdict>) -> Verdict {
    let mut worst = None;
    for verdict in verdicts {
        match (verdict, &worst) {
            (Verdict::Exceeded, _) => return Verdict::Exceeded,
            (Verdict::Within, _) => worst = Some(Verdict::Within),
            (Verdict::NotJudged { .. }, None) => worst = Some(verdict.clone()),
            (Verdict::NotJudged { .. }, Some(_)) => {}
        }
    }
    worst.unwrap_or_else(|| Verdict::NotJudged {
        reason: "nothing to compare".to_owned(),
    })
}
