//! Every statement of a track that rests on numerical uncertainty: D, U and what follows.

use pinwheel_compare::{Comparison, Outcome, Track, Verdict};

use super::checks::metric_label;
use super::{Mark, mark, quantity_label};
use crate::format::{self, relative, relative_or_none};

/// One distance against the uncertainty of both.
pub(super) struct Statement {
    pub(super) subject: String,
    pub(super) window: &'static str,
    pub(super) quantity: String,
    pub(super) metric: &'static str,
    pub(super) distance: (String, String),
    pub(super) u: [String; 2],
    pub(super) combined: (String, String),
    pub(super) said: String,
    pub(super) mark: Mark,
}

/// The gravest first, then the least sharp.
pub(super) fn of_track(comparison: &Comparison, track: Track) -> Vec<Statement> {
    let mut found: Vec<(Outcome, f64, Statement)> = Vec::new();
    for pair in comparison.pairs.iter().filter(|p| p.track == track) {
        for entry in &pair.entries {
            for judgement in entry.judgements.iter().filter(|j| j.counts) {
                let combined = judgement.combined();
                let key = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
                let statement = Statement {
                    subject: format!("{} \u{2194} {}", pair.a, pair.b),
                    window: entry.window.word(),
                    quantity: quantity_label(comparison, &entry.quantity).to_owned(),
                    metric: metric_label(judgement.metric),
                    distance: (
                        relative_or_none(judgement.distance),
                        key(judgement.distance),
                    ),
                    u: [judgement.u_a, judgement.u_b].map(relative_or_none),
                    combined: (relative_or_none(combined), key(combined)),
                    said: said(&judgement.verdict),
                    mark: mark(&judgement.verdict),
                };
                let blunt = combined.unwrap_or(f64::INFINITY);
                found.push((judgement.verdict.outcome(), blunt, statement));
            }
        }
    }
    found.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)));
    found
        .into_iter()
        .map(|(_, _, statement)| statement)
        .collect()
}

/// A verdict as a sentence with its numbers.
fn said(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Agree { to } => format!("agree to {}", relative(*to)),
        Verdict::Differ { at_least } => format!("differ by at least {}", relative(*at_least)),
        Verdict::NotResolved {
            participant,
            reason,
            remedy,
            stated,
            ..
        } => {
            let remedy = if *stated {
                String::new()
            } else {
                format!("; {remedy}")
            };
            format!("{participant}: {reason}{remedy}")
        }
        Verdict::ModelDifference {
            low,
            high,
            predicted,
            tolerance,
            ..
        } => {
            let interval = format!(
                "the models differ by {} to {}",
                relative(*low),
                relative(*high)
            );
            let aim = if *predicted == 0.0 {
                String::new()
            } else {
                format!("; {} is predicted", relative(*predicted))
            };
            let stated = tolerance.map_or_else(
                || "; nothing is stated of it".to_owned(),
                |t| format!("; the engine states {}", relative(t)),
            );
            format!("{interval}{aim}{stated}")
        }
        Verdict::NotDistinguishable { level } => {
            format!("no model error above {}", relative(*level))
        }
        Verdict::ModelError { low, high } => {
            format!("model error of {} to {}", relative(*low), relative(*high))
        }
        Verdict::Within | Verdict::Exceeded => verdict.word().to_owned(),
        Verdict::NotJudged { .. } => format::NONE.to_owned(),
    }
}
