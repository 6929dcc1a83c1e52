//! From an accepted and a new run to a verdict.

use serde::Serialize;

use super::file::{CaseQuantity, CaseRecord, ReferenceQuantity};
use super::limits;
use super::quantity::{Quantity, Values, rms, sketched_distance};
use super::runner::Costs;

/// What became of a figure; the most urgent last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Same to rounding.
    Same,
    /// Moved, and is as good as before.
    Changed,
    /// Not in the baseline: nothing was compared.
    New,
    /// Closer to the converged result, or cheaper.
    Better,
    /// Farther from the converged result, or dearer.
    Worse,
}

impl Verdict {
    /// In words.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Same => "same to rounding",
            Self::Changed => "changed within limits",
            Self::New => "not in the baseline",
            Self::Better => "better",
            Self::Worse => "worse",
        }
    }
}

/// A course before and after, for the eye.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// Number of the channel that moved most.
    pub channel: usize,
    /// Times of the kept samples, s.
    pub kept_s: Vec<f64>,
    /// Accepted, at the kept samples.
    pub before: Vec<f64>,
    /// Converged, at the kept samples.
    pub converged: Vec<f64>,
    /// All sample times, s.
    pub time_s: Vec<f64>,
    /// New, at all samples.
    pub after: Vec<f64>,
    /// New, at the kept samples.
    pub after_kept: Vec<f64>,
}

/// One quantity of one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityCheck {
    /// Its key.
    pub key: &'static str,
    /// In words.
    pub label: &'static str,
    /// Unit of mean and peak.
    pub unit: &'static str,
    /// Root mean square change against the accepted run, a share of the quantity's size.
    pub change: f64,
    /// Up to here a change is a rounding.
    pub rounding_limit: f64,
    /// Error of the accepted run against the converged one, a share of the size.
    pub error_before: f64,
    /// Error of the new run.
    pub error_after: f64,
    /// What the error may move by without being better or worse.
    pub error_limit: f64,
    /// Means, accepted and new.
    pub mean: [f64; 2],
    /// Largest magnitudes, accepted and new.
    pub peak: [f64; 2],
    /// What it comes to.
    pub verdict: Verdict,
    /// Courses, where there are any.
    #[serde(skip)]
    pub overlay: Option<Overlay>,
}

/// One cost of one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostCheck {
    /// Which.
    pub label: &'static str,
    /// Accepted.
    pub before: f64,
    /// New.
    pub after: f64,
    /// What it may move by.
    pub limit: f64,
    /// What it comes to.
    pub verdict: Verdict,
}

/// `values`: new; `time_s`: their sample times. `None` if their shape is not that of the record.
pub(super) fn quantity(
    values: &Values,
    time_s: &[f64],
    accepted: &CaseQuantity,
    reference: &ReferenceQuantity,
) -> Option<QuantityCheck> {
    let scale = reference.scale;
    let (before, converged) = (accepted.samples(reference)?, reference.samples()?);
    let after = values.kept();
    let fits = |other: &[Vec<f64>]| {
        other.len() == after.len() && other.iter().zip(&after).all(|(a, b)| a.len() == b.len())
    };
    if !fits(&before) || !fits(&converged) {
        return None;
    }
    let apart = |other: &[Vec<f64>]| {
        let pairs = other.iter().flatten().zip(after.iter().flatten());
        rms(pairs.map(|(a, b)| a - b)) / scale
    };
    let seen = apart(&before);
    // Below the quanta of the kept courses only the sketches tell.
    let change = if seen > 2.0 * accepted.quantum / scale {
        seen
    } else {
        sketched_distance(&accepted.sketch, &values.sketch(), values.count()) / scale
    };
    let rounding_limit = limits::same_up_to(accepted.rounding);
    let (error_before, error_after) = (accepted.error, apart(&converged));
    let error_limit = limits::ERROR_SHARE * error_before + reference.own_error + rounding_limit;
    let verdict = if change <= rounding_limit {
        Verdict::Same
    } else if error_after < error_before - error_limit {
        Verdict::Better
    } else if error_after <= error_before + error_limit {
        Verdict::Changed
    } else {
        Verdict::Worse
    };
    let Quantity {
        key, label, unit, ..
    } = *values.quantity;
    Some(QuantityCheck {
        key,
        label,
        unit,
        change,
        rounding_limit,
        error_before,
        error_after,
        error_limit,
        mean: [accepted.mean, values.mean()],
        peak: [accepted.peak, values.peak()],
        verdict,
        overlay: overlay(values, time_s, before, converged),
    })
}

fn overlay(
    values: &Values,
    time_s: &[f64],
    before: Vec<Vec<f64>>,
    converged: Vec<Vec<f64>>,
) -> Option<Overlay> {
    let every = values.quantity.every;
    if every == 0 {
        return None;
    }
    let kept = values.kept();
    let moved = |k: usize| rms(kept[k].iter().zip(&before[k]).map(|(a, b)| a - b));
    let channel = (0..kept.len()).max_by(|&a, &b| moved(a).total_cmp(&moved(b)))?;
    Some(Overlay {
        channel,
        kept_s: time_s.iter().step_by(every).copied().collect(),
        before: before.into_iter().nth(channel)?,
        converged: converged.into_iter().nth(channel)?,
        time_s: time_s.to_vec(),
        after: values.channels.get(channel)?.clone(),
        after_kept: kept.into_iter().nth(channel)?,
    })
}

/// All costs of a case. `adaptive`: a step control chose the steps. `comparable`: instructions are of the same build
/// and processor.
pub(super) fn costs(
    accepted: &CaseRecord,
    after: &Costs,
    adaptive: bool,
    comparable: bool,
) -> Vec<CostCheck> {
    let before = accepted.costs;
    let steps = before.steps as f64;
    let share = if adaptive {
        limits::ADAPTIVE_COUNT_SHARE.max(limits::FLIP_MARGIN * accepted.count_spread)
    } else {
        0.0
    };
    let mut found = vec![
        cost(
            "right-hand sides",
            before.right_hand_sides as f64,
            after.right_hand_sides as f64,
            share,
            0.0,
        ),
        cost("steps", steps, after.steps as f64, share, 0.0),
    ];
    if adaptive {
        let room = limits::REJECTIONS + share * steps;
        found.push(cost(
            "rejections",
            before.rejections as f64,
            after.rejections as f64,
            0.0,
            room,
        ));
    }
    if before.newton_steps + after.newton_steps > 0 {
        let share = limits::NEWTON_SHARE.max(share);
        found.push(cost(
            "Newton steps",
            before.newton_steps as f64,
            after.newton_steps as f64,
            share,
            0.0,
        ));
    }
    if let (Some(a), Some(b), true) = (before.instructions, after.instructions, comparable) {
        let share = limits::INSTRUCTION_SHARE.max(share);
        found.push(cost("instructions", a as f64, b as f64, share, 0.0));
    }
    found
}

/// A figure of which less is better; it may move by `share` of itself and `room`.
pub(super) fn cost(
    label: &'static str,
    before: f64,
    after: f64,
    share: f64,
    room: f64,
) -> CostCheck {
    let limit = share * before + room;
    let verdict = if after - before > limit {
        Verdict::Worse
    } else if before - after > limit {
        Verdict::Better
    } else {
        Verdict::Same
    };
    CostCheck {
        label,
        before,
        after,
        limit,
        verdict,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baseline::quantity::QUANTITIES;

    fn course(shift: f64) -> Values {
        let wave = |k: i32| 100.0 + shift + (f64::from(k) * 0.3).sin();
        Values {
            quantity: &QUANTITIES[0],
            channels: vec![(0..40).map(wave).collect()],
        }
    }

    /// An accepted run 1e-3 off the converged one, judged against others.
    fn judged(shift: f64) -> QuantityCheck {
        let (converged, ours) = (course(0.0), course(0.1));
        let lines = |values: &[Vec<f64>], q: f64| {
            values
                .iter()
                .map(|c| super::super::quantised::to_line(c, q))
                .collect()
        };
        let reference = ReferenceQuantity {
            key: "driver_torque".into(),
            scale: 100.0,
            own_error: 1e-7,
            quantum: 1e-5,
            courses: lines(&converged.kept(), 1e-5),
        };
        let accepted = CaseQuantity {
            key: "driver_torque".into(),
            mean: ours.mean(),
            peak: ours.peak(),
            sketch: ours.sketch(),
            error: 1e-3,
            rounding: 1e-14,
            quantum: 1e-3,
            differences: vec!["100 ".repeat(converged.kept()[0].len())],
        };
        let time: Vec<f64> = (0..40).map(f64::from).collect();
        quantity(&course(shift), &time, &accepted, &reference).unwrap()
    }

    #[test]
    fn verdicts() {
        let verdict = |shift| judged(shift).verdict;
        assert_eq!(verdict(0.1), Verdict::Same);
        assert_eq!(verdict(0.1 + 1e-12), Verdict::Same);
        assert_eq!(verdict(0.1 + 1e-8), Verdict::Changed);
        assert_eq!(verdict(0.105), Verdict::Changed);
        assert_eq!(verdict(0.12), Verdict::Worse);
        assert_eq!(verdict(0.08), Verdict::Better);
        // As far off, on the other side: moved by twice the error, and as good as before.
        assert_eq!(verdict(-0.1), Verdict::Changed);
        assert_eq!(verdict(f64::NAN), Verdict::Worse);
        let check = judged(-0.1);
        assert!((check.change - 2e-3).abs() < 1e-5 && (check.error_after - 1e-3).abs() < 1e-6);
        // The sketch sees what the kept samples cannot: 1e-8 of 100 is 1e-10.
        assert!((0.1..10.0).contains(&(judged(0.1 + 1e-8).change / 1e-10)));
    }

    /// What is drawn at a time is the value of that time.
    #[test]
    fn overlays_are_in_step() {
        let overlay = judged(0.12).overlay.unwrap();
        assert!(overlay.kept_s.len() > 2);
        for (time, value) in overlay.kept_s.iter().zip(&overlay.after_kept) {
            let k = overlay.time_s.iter().position(|t| t == time).unwrap();
            assert_eq!(overlay.after[k], *value);
        }
    }

    #[test]
    fn costs_have_room_only_where_rounding_moves_them() {
        assert_eq!(
            cost("steps", 2000.0, 2001.0, 0.0, 0.0).verdict,
            Verdict::Worse
        );
        assert_eq!(
            cost("steps", 2000.0, 1999.0, 0.0, 0.0).verdict,
            Verdict::Better
        );
        assert_eq!(
            cost("steps", 2000.0, 2010.0, 0.03, 0.0).verdict,
            Verdict::Same
        );
    }
}
