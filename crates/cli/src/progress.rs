//! The one progress bar: on a terminal only, with the piece, the clock, and rate and time left of long runs.

use std::io::IsTerminal as _;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel::studies::{Control, Progress};

use crate::interrupt;

/// What takes less than this needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Milliseconds between two redraws: engines report every sample, millions of them.
const REDRAW_MS: u64 = 100;
/// Parts of the bar.
const PARTS: u64 = 1000;

/// Works under a bar with a label; a stop that the user asked for is a failure of its own.
pub(crate) fn watched<T, E>(
    label: &str,
    work: impl FnOnce(&Control<'_>) -> Result<T, E>,
) -> Result<T, E> {
    interrupt::watched();
    let bar = Bar::new(label);
    let report = |progress: Progress<'_>| bar.show(progress);
    let found = work(&Control {
        cancel: interrupt::flag(),
        progress: &report,
    });
    if let Some(bar) = bar.bar.get() {
        bar.finish_and_clear();
    }
    found
}

/// A bar that is nothing where nobody sees it.
struct Bar {
    label: String,
    started: Instant,
    visible: bool,
    drawn_ms: AtomicU64,
    bar: OnceLock<ProgressBar>,
}

impl Bar {
    fn new(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            started: Instant::now(),
            visible: std::io::stderr().is_terminal(),
            drawn_ms: AtomicU64::new(0),
            bar: OnceLock::new(),
        }
    }

    fn show(&self, progress: Progress<'_>) {
        if !self.visible {
            return;
        }
        let elapsed = self.started.elapsed();
        let now_ms = u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX);
        let due = now_ms.saturating_sub(self.drawn_ms.load(Ordering::Relaxed)) >= REDRAW_MS;
        // The beginning of a piece is always told: the next report can be long in coming.
        if progress.simulated_s.is_some() && (elapsed < PATIENCE || !due) {
            return;
        }
        self.drawn_ms.store(now_ms, Ordering::Relaxed);
        let bar = self.bar.get_or_init(|| {
            let bar = ProgressBar::new(PARTS);
            if let Ok(style) =
                ProgressStyle::with_template("{prefix} [{bar:24}] {elapsed}: {wide_msg}")
            {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_prefix(self.label.clone());
            // Single pieces take many seconds: the clock shows that something happens.
            bar.enable_steady_tick(Duration::from_millis(500));
            bar
        });
        let share = match progress.simulated_s {
            Some([at, of]) => at / of,
            None => progress.done as f64 / progress.total.max(1) as f64,
        };
        bar.set_position((share * PARTS as f64) as u64);
        bar.set_message(words(&progress, elapsed.as_secs_f64()));
    }
}

/// The piece, its number, and the simulated time where that passes.
fn words(progress: &Progress<'_>, elapsed_s: f64) -> String {
    let mut text = progress.piece.to_owned();
    if progress.total > 1 {
        let number = (progress.done + 1).min(progress.total);
        text.push_str(&format!(" ({number} of {})", progress.total));
    }
    if let Some([at, of]) = progress.simulated_s {
        text.push_str(&format!(", {}", message(at, of, elapsed_s)));
    }
    text
}

/// `0.310 of 0.600 s, 0.12 s per second, 3 s left`.
fn message(time_s: f64, duration_s: f64, elapsed_s: f64) -> String {
    let rate = time_s / elapsed_s;
    let mut text = format!("{time_s:.3} of {duration_s:.3} s");
    if rate > 0.0 && rate.is_finite() {
        let left = ((duration_s - time_s) / rate).max(0.0);
        let left = if left < 90.0 {
            format!("{left:.0} s")
        } else if left < 5400.0 {
            format!("{:.0} min", left / 60.0)
        } else {
            format!("{:.1} h", left / 3600.0)
        };
        text.push_str(&format!(", {} simulated s per s, {left} left", short(rate)));
    }
    text
}

/// Two significant digits.
fn short(value: f64) -> String {
    if (0.1..1000.0).contains(&value) {
        format!("{value:.2}")
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_counted() {
        let piece = Progress::new(1, 4, "atlas of steel");
        assert_eq!(words(&piece, 1.0), "atlas of steel (2 of 4)");
        let run = Progress {
            simulated_s: Some([0.3, 0.6]),
            ..Progress::new(0, 1, "native")
        };
        assert!(words(&run, 1.0).starts_with("native, 0.300 of 0.600 s"));
    }

    #[test]
    fn messages() {
        assert_eq!(
            message(0.3, 0.6, 1.0),
            "0.300 of 0.600 s, 0.30 simulated s per s, 1 s left"
        );
        assert_eq!(
            message(1e-4, 0.6, 1.0),
            "0.000 of 0.600 s, 1.0e-4 simulated s per s, 1.7 h left"
        );
        assert_eq!(message(0.0, 0.6, 1.0), "0.000 of 0.600 s");
    }
}
