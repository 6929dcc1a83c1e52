//! Everything that was held against a limit on one track, and everything that was not.

use pinwheel_compare::comparison::{EngineEntry, PairEntry};
use pinwheel_compare::{Check, Comparison, Metric, Track, Verdict, WindowKind};

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
    /// Number of the reason below the table, from 1.
    pub(super) reason: usize,
}

/// Comparisons without a limit, joined where the reason is one and the same.
pub(super) struct UnjudgedRow {
    pub(super) subject: String,
    pub(super) window: &'static str,
    pub(super) quantities: String,
    pub(super) reason: String,
}

/// The verdicts of one track.
#[derive(Default)]
pub(super) struct Checks {
    /// Exceeded ones first, then by how much of the limit is used.
    pub(super) rows: Vec<CheckRow>,
    /// Why the limits are what they are; rows refer to them by number.
    pub(super) reasons: Vec<String>,
    pub(super) unjudged: Vec<UnjudgedRow>,
}

/// Everything judged and not judged on one track.
pub(super) fn of_track(comparison: &Comparison, track: Track) -> Checks {
    let (mut judged, mut unjudged) = (Vec::new(), Vec::new());
    let mut take = |subject: &str, quantity: &str, window, checks: &[Check], verdict: &Verdict| {
        let label = quantity_label(comparison, quantity);
        judged.extend(checks.iter().map(|check| {
            let share = share(check);
            (
                share,
                check.reason.clone(),
                row(subject, label, window, check, share),
            )
        }));
        if let Verdict::NotJudged { reason } = verdict {
            not_judged(&mut unjudged, subject, label, window, reason);
        }
    };
    for engine in comparison.engines.iter().filter(|e| e.track == track) {
        for EngineEntry {
            quantity,
            window,
            checks,
            verdict,
        } in &engine.judged
        {
            take(&engine.name, quantity, *window, checks, verdict);
        }
    }
    for pair in comparison.pairs.iter().filter(|p| p.track == track) {
        let subject = pair_label(&pair.a, &pair.b);
        for PairEntry {
            quantity,
            window,
            checks,
            verdict,
            ..
        } in &pair.entries
        {
            take(&subject, quantity, *window, checks, verdict);
        }
    }
    judged.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
    let mut found = Checks {
        unjudged,
        ..Checks::default()
    };
    for (_, reason, mut row) in judged {
        let place = found.reasons.iter().position(|known| *known == reason);
        row.reason = 1 + place.unwrap_or_else(|| {
            found.reasons.push(reason);
            found.reasons.len() - 1
        });
        found.rows.push(row);
    }
    found
}

/// The check that comes closest to its limit, or exceeds it most.
pub(super) fn closest(comparison: &Comparison) -> Option<String> {
    let alone = comparison.engines.iter().flat_map(|engine| {
        let entries = engine.judged.iter();
        entries.flat_map(|e| {
            e.checks
                .iter()
                .map(|c| (engine.name.clone(), &e.quantity, c))
        })
    });
    let pairs = comparison.pairs.iter().flat_map(|pair| {
        let label = pair_label(&pair.a, &pair.b);
        let entries = pair.entries.iter();
        entries.flat_map(move |e| {
            let label = label.clone();
            e.checks
                .iter()
                .map(move |c| (label.clone(), &e.quantity, c))
        })
    });
    let (subject, quantity, check) = alone
        .chain(pairs)
        .max_by(|(.., a), (.., b)| share(a).total_cmp(&share(b)))?;
    let quantity = quantity_label(comparison, quantity).to_lowercase();
    let how = if check.within {
        "Closest to its limit"
    } else {
        "Furthest beyond its limit"
    };
    Some(format!(
        "{how}: {subject}, {quantity}, {} of it",
        share_label(share(check))
    ))
}

fn pair_label(a: &str, b: &str) -> String {
    format!("{a} \u{2194} {b}")
}

/// Value over limit; infinite where the value is not finite.
fn share(check: &Check) -> f64 {
    check
        .value
        .map_or(f64::INFINITY, |value| value / check.limit)
}

/// Adds a comparison without a limit, to the row before where the reason is the same.
fn not_judged(
    rows: &mut Vec<UnjudgedRow>,
    subject: &str,
    label: &str,
    window: WindowKind,
    reason: &str,
) {
    let same = rows.last_mut().filter(|row| {
        row.subject == subject && row.window == window.word() && row.reason == reason
    });
    match same {
        Some(row) => {
            row.quantities.push_str(", ");
            row.quantities.push_str(&label.to_lowercase());
        }
        None => rows.push(UnjudgedRow {
            subject: subject.to_owned(),
            window: window.word(),
            quantities: label.to_owned(),
            reason: reason.to_owned(),
        }),
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
        share: share_label(share),
        share_key: key(share),
        measured: check
            .measured
            .map_or_else(|| format::NONE.to_owned(), format::relative),
        mark: mark(&verdict),
        reason: 0,
    }
}

/// How much of a limit is used, without more digits than anyone reads.
fn share_label(share: f64) -> String {
    match share {
        s if !s.is_finite() => "not finite".to_owned(),
        s if s < 0.01 => "<\u{202f}1\u{202f}%".to_owned(),
        s if s < 10.0 => format!("{:.0}\u{202f}%", 100.0 * s),
        s => format!("{}\u{202f}\u{d7}", format::significant(s, 2)),
    }
}

pub(super) fn metric_label(metric: Metric) -> &'static str {
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
