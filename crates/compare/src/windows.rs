//! Windows: parts of a run that are compared separately.
//!
//! The start-up transient is a hard test of integration and a poor one of geometry, the steady part the reverse; one figure
//! over both would hide either.

use pinwheel_timeseries::TimeSeries;
use serde::{Deserialize, Serialize};

/// Decay time of the paper gearbox's start-up transient, s (measured: about 0.25 s, with 1.2 kHz at 2 % of critical damping). A
/// steady window starts no earlier.
pub const SETTLING_S: f64 = 0.25;
/// Length of the transient window of a gear that settles in [`SETTLING_S`], s; for other gears in proportion to their decay
/// time.
pub const TRANSIENT_S: f64 = 0.05;
/// Fewest samples of a window; with fewer a mean square is meaningless.
pub const FEWEST_SAMPLES: usize = 10;

/// Kind of window: the part of the run that it covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowKind {
    /// Part after the start-up transient: the second half of the run, or the rest after the last load change and the decay of
    /// its transient.
    Steady,
    /// First fifth of the gear's decay time ([`TRANSIENT_S`] of [`SETTLING_S`]).
    Transient,
    /// Entire run; used only where the run has no steady window.
    Whole,
}

impl WindowKind {
    /// Returns the word in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Transient => "transient",
            Self::Whole => "whole",
        }
    }
}

/// Window that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Window {
    /// Kind of window.
    pub kind: WindowKind,
    /// Start, s, included.
    pub from_s: f64,
    /// End, s, included.
    pub to_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Number of load changes; 0 in a steady window.
    #[serde(skip_serializing_if = "is_none")]
    pub load_changes: usize,
}

fn is_none(changes: &usize) -> bool {
    *changes == 0
}

impl Window {
    /// Returns a sentence about the window that readers need beside its times; `None` if there is none.
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

/// Window that cannot be compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbsentWindow {
    /// Kind of window.
    pub kind: WindowKind,
    /// Reason why the window is missing.
    pub reason: String,
}

/// Returns the windows of a run with the sample times of `time_series`, and the windows for which the run is too short.
/// `settling_s`: decay time of the start-up transient. `load_changes_s`: start and end times of load changes, increasing. The
/// transient of the last change within the run also decays in `settling_s` (in [`SETTLING_S`] if that is 0, a start in
/// equilibrium); a steady window is at least a fifth of that long.
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
            let reason = format!("it would have {samples} samples, fewer than {FEWEST_SAMPLES}");
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
    // Tolerance of a rounding, as the duration is a sum of many steps.
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
pub fn rounded(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}
