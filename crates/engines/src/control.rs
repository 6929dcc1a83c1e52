//! Cancellation and progress, of one run and of a study of many.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Stop requested by the user.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Cancelled;

/// Progress of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'a> {
    /// Number of completed pieces.
    pub done: usize,
    /// Total number of pieces.
    pub total: usize,
    /// Present piece, e.g. a scene's name.
    pub piece: &'a str,
    /// Simulated time of all pieces together, reached and total, s, if pieces are runs.
    pub simulated_s: Option<[f64; 2]>,
    /// CPU time of the run's thread, if another thread reports.
    pub cpu: Option<Duration>,
    /// Remaining time of the study, s, if known.
    pub left_s: Option<f64>,
}

impl<'a> Progress<'a> {
    /// Creates the progress at the start of a piece.
    pub fn new(done: usize, total: usize, piece: &'a str) -> Self {
        Self {
            done,
            total,
            piece,
            simulated_s: None,
            cpu: None,
            left_s: None,
        }
    }

    /// Returns the progress of the piece, a run of `duration_s` like all others, at `time_s`.
    fn reached(self, time_s: f64, duration_s: f64) -> Self {
        let at = self.done as f64 * duration_s + time_s;
        Self {
            simulated_s: Some([at, self.total as f64 * duration_s]),
            ..self
        }
    }

    /// Returns number, piece and remaining time; short, because terminals cut long lines.
    pub fn sentence(&self) -> String {
        let mut text = String::new();
        if self.total > 1 {
            let number = (self.done + 1).min(self.total);
            text.push_str(&format!("{number} of {}, ", self.total));
        }
        text.push_str(self.piece);
        if let Some(left) = self.left_s.filter(|left| left.is_finite()) {
            text.push_str(&format!(", {} left", span(left)));
        }
        text
    }
}

/// Formats seconds, minutes or hours.
fn span(time_s: f64) -> String {
    if time_s < 120.0 {
        format!("{time_s:.0} s")
    } else if time_s < 5400.0 {
        format!("{:.0} min", time_s / 60.0)
    } else {
        format!("{:.1} h", time_s / 3600.0)
    }
}

/// Cancellation and progress; cheap enough for a check at every sample.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Flag for a stop, set from outside (Ctrl-C); checked in every sample of every run.
    pub cancel: &'a AtomicBool,
    /// Callback at the start of every piece of a study, and in every sample of a run.
    pub progress: &'a (dyn Fn(Progress<'_>) + Sync),
    at: Progress<'a>,
    duration_s: f64,
    /// Number of evaluations after which a native run ends as diverged, unless it verifies itself.
    pub evaluations: u64,
}

impl<'a> Control<'a> {
    /// Creates a control that stops when `cancel` is set, and reports to `progress`.
    pub fn new(cancel: &'a AtomicBool, progress: &'a (dyn Fn(Progress<'_>) + Sync)) -> Self {
        Self {
            cancel,
            progress,
            at: Progress::new(0, 1, ""),
            duration_s: 0.0,
            evaluations: u64::MAX,
        }
    }

    /// Returns a control that never stops and reports nothing.
    pub fn quiet() -> Control<'static> {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Control::silent(&NEVER)
    }

    /// Creates a control that stops when `cancel` is set, and reports nothing.
    pub fn silent(cancel: &'a AtomicBool) -> Self {
        Self::new(cancel, &|_| {})
    }

    /// Sets the piece of a study to which the run belongs.
    #[must_use]
    pub fn piece(self, at: Progress<'a>) -> Self {
        Self { at, ..self }
    }

    /// Replaces the receiver of cancellation and progress.
    #[must_use]
    pub fn limited(
        self,
        cancel: &'a AtomicBool,
        progress: &'a (dyn Fn(Progress<'_>) + Sync),
    ) -> Self {
        Self {
            cancel,
            progress,
            ..self
        }
    }

    /// Sets the run's duration, s.
    #[must_use]
    pub fn lasting(self, duration_s: f64) -> Self {
        Self { duration_s, ..self }
    }

    /// Reports the simulated time; returns true if the run must stop.
    pub fn reached(&self, time_s: f64) -> bool {
        (self.progress)(self.at.reached(time_s, self.duration_s));
        self.is_cancelled()
    }

    /// Reports like [`reached`](Self::reached) for a run on another thread with this CPU time.
    #[cfg(feature = "python")]
    pub(crate) fn reached_elsewhere(&self, time_s: f64, cpu: Duration) -> bool {
        (self.progress)(Progress {
            cpu: Some(cpu),
            ..self.at.reached(time_s, self.duration_s)
        });
        self.is_cancelled()
    }

    /// True if the run must stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Returns an error after a stop was requested.
    ///
    /// # Errors
    /// The requested stop.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() {
            return Err(Cancelled);
        }
        Ok(())
    }
}
