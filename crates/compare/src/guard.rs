//! The table of limits: which rows fit, and what they say.

use crate::judge::{Judge, Sides};
use crate::limits::{Friction, Limit, fits};
use crate::metrics::{Metric, PairMetrics};
use crate::participant::{Participant, Track};
use crate::quantities::Quantity;
use crate::uncertainty::Uncertainty;
use crate::verdict::{Check, Verdict};
use crate::windows::{Window, WindowKind};

/// Whether a row applies, and if not, by how little.
enum Fit {
    Yes,
    /// It would but for this.
    But(String),
    No,
}

impl Judge<'_> {
    /// The table of limits, on the scenes that it guards.
    pub(crate) fn guard(
        &self,
        Sides { track, a, b }: Sides<'_>,
        quantity: &Quantity,
        window: &Window,
        metrics: &PairMetrics,
    ) -> (Vec<Check>, String) {
        if !self.guarded {
            let reason = "no uncertainties are given, and the table of limits was not measured on this scene";
            return (Vec::new(), reason.to_owned());
        }
        let pointwise = self.context.is_pointwise(window.to_s);
        let rows = self.rules.limits.iter().filter(|row| {
            row.metric != Metric::MeanAgainstLoad
                && row.window == window.kind
                && (pointwise || !row.metric.is_pointwise())
                && fits(row.quantity, &quantity.name)
                && fits(row.track, track.as_str())
        });
        let (mut checks, mut reason) = (Vec::new(), None);
        for metric in Metric::of_pairs() {
            for row in rows.clone().filter(|row| row.metric == metric) {
                match self.fit(row, a, b) {
                    Fit::Yes => {
                        let value = (metric.row().of)(metrics);
                        checks.push(check(row, value, row.limit, row.reason.to_owned()));
                        break;
                    }
                    Fit::But(why) => reason = reason.or(Some(why)),
                    Fit::No => {}
                }
            }
        }
        if checks.is_empty() && a.track != Track::Native && b.track != Track::Native {
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
        (checks, reason)
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
                    && fits(row.against, Track::Native.as_str())
                    && fits(row.engine, &engine.name)
                    && row.against_step_at_most_s.is_none()
                    && self.suits(row.friction)
                    && step_suits(engine, row.step_at_most_s)
            })
        };
        Metric::of_pairs()
            .filter_map(|metric| {
                let (one, other) = (leg(a, metric)?, leg(b, metric)?);
                let reason = format!(
                    "Each may be this far from a native run: {:e} + {:e}.",
                    one.limit, other.limit
                );
                let limit = one.limit + other.limit;
                Some(Check {
                    measured: None,
                    ..check(one, (metric.row().of)(metrics), limit, reason)
                })
            })
            .collect()
    }

    /// Judges the mean output torque of one engine against the load, on any scene: this is mechanics. `u`: the
    /// uncertainty of that mean, N m, which widens the limit; where it is not known, a mean beyond the limit is not resolved.
    pub(crate) fn load(
        &self,
        engine: &Participant,
        quantity: &Quantity,
        window: WindowKind,
        mean: Option<f64>,
        load_n_m: f64,
        u: Option<&Uncertainty>,
    ) -> Option<(Vec<Check>, Verdict)> {
        let row = self.rules.limits.iter().find(|row| {
            row.metric == Metric::MeanAgainstLoad
                && row.window == window
                && fits(row.quantity, &quantity.name)
                && fits(row.track, engine.track.as_str())
                && fits(row.engine, &engine.name)
                && self.suits(row.friction)
                && step_suits(engine, row.step_at_most_s)
        })?;
        if load_n_m.abs() <= self.negligible.torque_n_m {
            let reason = "the scene has no load to compare with".to_owned();
            return Some((Vec::new(), Verdict::NotJudged { reason }));
        }
        let value = mean.map(|mean| (mean + load_n_m).abs() / load_n_m.abs());
        let share = u.and_then(Uncertainty::u).unwrap_or(0.0) / load_n_m.abs();
        let unknown = match u {
            Some(Uncertainty::NotResolved(missing)) => Some(missing),
            _ => None,
        };
        if !(share <= self.rules.resolution) {
            let verdict = Verdict::NotResolved {
                participant: engine.name.clone(),
                u: Some(share),
                reason: format!(
                    "the mean is uncertain by {share:.1e} of the load, above the resolution of {:.0e}",
                    self.rules.resolution
                ),
                remedy: format!("refine {}", engine.name),
                stated: false,
            };
            return Some((
                Vec::new(),
                self.excused(verdict, self.context.is_pointwise(f64::INFINITY)),
            ));
        }
        let limit = row.limit + share;
        if let Some(missing) = unknown.filter(|_| value.is_some_and(|value| value > limit)) {
            let verdict = Verdict::NotResolved {
                participant: engine.name.clone(),
                u: None,
                reason: missing.reason.clone(),
                remedy: missing.remedy.clone(),
                stated: false,
            };
            return Some((
                Vec::new(),
                self.excused(verdict, self.context.is_pointwise(f64::INFINITY)),
            ));
        }
        let checks = vec![check(row, value, limit, row.reason.to_owned())];
        let verdict = checks[0].verdict();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::participant::Cost;

    /// A run that tells no step is not one with a short step.
    #[test]
    fn regress_no_step_is_not_a_short_one() {
        let of = |step_s: f64| {
            Participant::that_cost(Cost {
                step_s,
                ..Cost::default()
            })
        };
        let fits = |step_s: f64| step_suits(&of(step_s), Some(1e-5));
        assert!(fits(1e-5) && fits(1e-6) && !fits(1.1e-5));
        assert!(!fits(0.0) && !fits(f64::NAN));
        assert!(step_suits(&of(0.0), None));
    }
}
