//! Windows: the parts of a run that are compared apart from each other.
//!
//! The start-up transient is a hard test of integration and a poor one of geometry, the steady
//! part the other way round; one figure over both would hide either.

use pinwheel_timeseries::TimeSeries;
use serde::{Deserialize, Serialize};

/// Time in which the paper gearbox's start-up transient decays, s (measured: about 0.25 s, with
/// 1.2 kHz at 2 % of critical damping). A steady window starts no earlier.
pub const SETTLING_S: f64 = 0.25;
/// Length of the transient window of a gear that settles in [`SETTLING_S`], s; others have the same share of their own.
pub const TRANSIENT_S: f64 = 0.05;
/// Samples a window must hold: with fewer a mean square says nothing.
pub const FEWEST_SAMPLES: usize = 10;

/// Kind of window: the part of the run that it covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowKind {
    /// After the start-up transient: the second half of the run, or what is left of it when the load has changed
    /// for the last time and the transient of that has decayed.
    Steady,
    /// The first fifth of the time in which the gear settles ([`TRANSIENT_S`] of [`SETTLING_S`]).
    Transient,
    /// Entire run; used only where the run has no steady window.
    Whole,
}

impl WindowKind {
    /// The word used in files and tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Transient => "transient",
            Self::Whole => "whole",
        }
    }
}

/// A window that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Window {
    /// Kind of window.
    pub kind: WindowKind,
    /// Start, s, included.
    pub from_s: f64,
    /// End, s, included.
    pub to_s: f64,
    /// Samples in it.
    pub samples: usize,
    /// Changes of the load in it; never any in a steady one.
    #[serde(skip_serializing_if = "is_none")]
    pub load_changes: usize,
}

fn is_none(changes: &usize) -> bool {
    *changes == 0
}

impl Window {
    /// One sentence about the window that a reader must know beside its times; `None`: nothing.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        let word = self.kind.word();
        match self.load_changes {
            0 => None,
            1 => Some(format!("Load or speed changes in the {word} window.")),
            n => Some(format!(
                "Load or speed changes {n} times in the {word} window."
            )),
        }
    }
}

/// A window that cannot be compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbsentWindow {
    /// Kind of window.
    pub kind: WindowKind,
    /// Reason why the window is missing.
    pub reason: String,
}

/// Returns the windows of a run with the sample times of `time_series`, and the windows for which the run is too short.
/// `settling_s`: time in which the start-up transient has decayed. `load_changes_s`: times at which the load
/// changes or comes to the end of a change, increasing; after the last one within the run a transient decays in
/// `settling_s` (of a start in equilibrium, where that is 0, [`SETTLING_S`]), and a steady window has at least a fifth of that
/// after it.
#[must_use]
pub fn windows(
    time_series: &TimeSeries,
    settling_s: f64,
    load_changes_s: &[f64],
) -> (Vec<Window>, Vec<AbsentWindow>) {
    let (mut present, mut absent) = (Vec::new(), Vec::new());
    let time_s = time_series.time_s();
    let (start, end) = match (time_s.first(), time_s.last()) {
        (Some(&start), Some(&end)) => (start, end),
        _ => (0.0, 0.0),
    };
    let duration = end - start;
    let decays_s = if settling_s > 0.0 {
        settling_s
    } else {
        SETTLING_S
    };
    let transient_s = TRANSIENT_S / SETTLING_S * decays_s;
    let mut offer = |kind: WindowKind, from_s: f64, to_s: f64| {
        let samples = time_series.window(from_s, to_s).len();
        if samples < FEWEST_SAMPLES {
            let reason = format!("it would hold {samples} samples, fewer than {FEWEST_SAMPLES}");
            absent.push(AbsentWindow { kind, reason });
            return false;
        }
        let changes = load_changes_s.iter();
        present.push(Window {
            kind,
            from_s,
            to_s,
            samples,
            load_changes: changes.filter(|&&t| from_s < t && t < to_s).count(),
        });
        true
    };
    // A rounding's breadth, as the duration is a sum of many steps.
    let settled = duration / 2.0 * (1.0 + 1e-9) >= settling_s;
    let half = start + duration / 2.0;
    let changed = load_changes_s.iter().rev().find(|&&t| t < end);
    let (from, reached) = match changed {
        Some(last) if last + decays_s > half => {
            let from = last + decays_s;
            (from, from + transient_s <= end * (1.0 + 1e-9))
        }
        _ => (half, true),
    };
    let steady = settled && reached && offer(WindowKind::Steady, from, end);
    offer(WindowKind::Transient, start, end.min(start + transient_s));
    if !steady && duration > transient_s * (1.0 + 1e-9) {
        offer(WindowKind::Whole, start, end);
    }
    let reason = match changed {
        _ if !settled => Some(format!(
            "the run lasts {} s; the start-up transient takes {settling_s} s, so a steady window \
             needs {} s",
            rounded(duration),
            2.0 * settling_s
        )),
        Some(last) if !reached => Some(format!(
            "load or speed still changes at {} s and the transient of that takes {decays_s} s, so a steady window \
             needs a run of {} s",
            rounded(*last),
            rounded(last + decays_s + transient_s)
        )),
        _ => None,
    };
    let kind = WindowKind::Steady;
    absent.extend(reason.map(|reason| AbsentWindow { kind, reason }));
    (present, absent)
}

/// Returns a time without the digits of rounding.
#[doc(hidden)]
#[must_use]
pub fn rounded(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}
