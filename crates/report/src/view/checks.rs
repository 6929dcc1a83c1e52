//! Everything that was held against a limit on one track, and everything that was not.

use pinwheel_compare::comparison::{EngineEntry, PairEntry};
use pinwheel_compare::{Check, Comparison, Metric, Verdict, WindowKind};

use super::{Mark, mark, quantity_label};
use crate::format;

/// One number against one limit.
pub(super) struct CheckRow {
    pub(super) subject: String,
    pub(super) window: &'static str,
    pub(super) quantity: String,
    pub(super) metric: &'static str,
    pub(super) value: String,
    pub(super) value_key: String,
    pub(super) limit: String,
    pub(super) limit_key: String,
    /// Value over limit in per cent for the bar, at most 100.
    pub(super) bar: String,
    /// Value over limit in words, e.g. `18 %`.
    pub(super) share: String,
    pub(super) share_key: String,
    pub(super) measured: String,
    pub(super) mark: Mark,
    pub(super) reason: String,
}

/// Comparisons without a limit, joined where the reason is one and the same.
pub(super) struct UnjudgedRow {
    pub(super) subject: String,
    pub(super) window: &'static str,
    pub(super) quantities: String,
    pub(super) reason: String,
}

/// Rows of one track, exceeded ones first and then by how much of the limit is used.
pub(super) fn rows(comparison: &Comparison, track: &str) -> (Vec<CheckRow>, Vec<UnjudgedRow>) {
    let (mut judged, mut unjudged) = (Vec::new(), Vec::new());
    for engine in comparison.engines.iter().filter(|e| e.track == track) {
        for EngineEntry {
            quantity,
            window,
            checks,
            verdict,
        } in &engine.judged
        {
            let subject = engine.name.clone();
            take(
                comparison,
                &subject,
                quantity,
                *window,
                checks,
                verdict,
                (&mut judged, &mut unjudged),
            );
        }
    }
    for pair in comparison.pairs.iter().filter(|p| p.track == track) {
        let subject = format!("{} \u{2194} {}", pair.a, pair.b);
        for PairEntry {
            quantity,
            window,
            checks,
            verdict,
            ..
        } in &pair.entries
        {
            take(
                comparison,
                &subject,
                quantity,
                *window,
                checks,
                verdict,
                (&mut judged, &mut unjudged),
            );
        }
    }
    judged.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    (judged.into_iter().map(|(_, row)| row).collect(), unjudged)
}

fn take(
    comparison: &Comparison,
    subject: &str,
    quantity: &str,
    window: WindowKind,
    checks: &[Check],
    verdict: &Verdict,
    (judged, unjudged): (&mut Vec<(f64, CheckRow)>, &mut Vec<UnjudgedRow>),
) {
    let label = quantity_label(comparison, quantity);
    for check in checks {
        let share = check
            .value
            .map_or(f64::INFINITY, |value| value / check.limit);
        judged.push((share, row(subject, label, window, check, share)));
    }
    if let Verdict::NotJudged { reason } = verdict {
        let same = unjudged.last_mut().filter(|row| {
            row.subject == subject && row.window == window.word() && row.reason == *reason
        });
        match same {
            Some(row) => {
                row.quantities.push_str(", ");
                row.quantities.push_str(&label.to_lowercase());
            }
            None => unjudged.push(UnjudgedRow {
                subject: subject.to_owned(),
                window: window.word(),
                quantities: label.to_owned(),
                reason: reason.clone(),
            }),
        }
    }
}

fn row(subject: &str, label: &str, window: WindowKind, check: &Check, share: f64) -> CheckRow {
    let verdict = if check.within {
        Verdict::Within
    } else {
        Verdict::Exceeded
    };
    let key = |value: f64| {
        if value.is_finite() {
            value.to_string()
        } else {
            "1e308".to_owned()
        }
    };
    CheckRow {
        subject: subject.to_owned(),
        window: window.word(),
        quantity: label.to_owned(),
        metric: metric_label(check.metric),
        value: check
            .value
            .map_or_else(|| "not finite".to_owned(), format::relative),
        value_key: key(check.value.unwrap_or(f64::INFINITY)),
        limit: format::limit(check.limit),
        limit_key: key(check.limit),
        bar: format!("{:.1}", (100.0 * share).clamp(0.0, 100.0)),
        share: if share.is_finite() {
            share_label(share)
        } else {
            format::NONE.to_owned()
        },
        share_key: key(share),
        measured: check
            .measured
            .map_or_else(|| format::NONE.to_owned(), format::relative),
        mark: mark(&verdict),
        reason: check.reason.clone(),
    }
}

/// How much of a limit is used, without more digits than anyone reads.
fn share_label(share: f64) -> String {
    match share {
        s if s < 0.01 => "<\u{202f}1\u{202f}%".to_owned(),
        s if s < 10.0 => format!("{:.0}\u{202f}%", 100.0 * s),
        s => format!("{}\u{202f}\u{d7}", format::significant(s, 2)),
    }
}

fn metric_label(metric: Metric) -> &'static str {
    match metric {
        Metric::RelativeL2 => "relative L2",
        Metric::RelativeLinf => "relative L\u{221e}",
        Metric::Mean => "mean",
        Metric::Peak => "peak",
        Metric::Rms => "rms",
        Metric::SpragueGeers => "Sprague\u{2013}Geers C",
        Metric::MeanAgainstLoad => "mean against the load",
    }
}
