//! Progress of one engine: shown after a second, on a terminal only, with rate and time left.

use std::io::IsTerminal as _;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// What takes less than this needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Milliseconds between two redraws: engines report every sample, millions of them.
const REDRAW_MS: u64 = 100;
/// Parts of the bar.
const PARTS: u64 = 1000;

/// Progress of one run.
pub(crate) struct Progress {
    label: String,
    duration_s: f64,
    started: Instant,
    visible: bool,
    drawn_ms: AtomicU64,
    bar: OnceLock<ProgressBar>,
}

impl Progress {
    /// Starts the clock for `duration_s` of simulated time.
    pub(crate) fn new(label: impl Into<String>, duration_s: f64) -> Self {
        Self {
            label: label.into(),
            duration_s,
            started: Instant::now(),
            visible: std::io::stderr().is_terminal(),
            drawn_ms: AtomicU64::new(0),
            bar: OnceLock::new(),
        }
    }

    /// The engine reached `time_s`.
    pub(crate) fn reached(&self, time_s: f64) {
        self.reached_with(time_s, &String::new);
    }

    /// The same with more to say, asked for when the bar is drawn.
    pub(crate) fn reached_with(&self, time_s: f64, more: &dyn Fn() -> String) {
        if !self.visible {
            return;
        }
        let elapsed = self.started.elapsed();
        let now_ms = u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX);
        let due = now_ms.saturating_sub(self.drawn_ms.load(Ordering::Relaxed)) >= REDRAW_MS;
        if elapsed < PATIENCE || !due {
            return;
        }
        self.drawn_ms.store(now_ms, Ordering::Relaxed);
        let bar = self.bar.get_or_init(|| {
            let bar = ProgressBar::new(PARTS);
            if let Ok(style) = ProgressStyle::with_template("{prefix} [{bar:30}] {msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_prefix(self.label.clone());
            bar
        });
        bar.set_position((time_s / self.duration_s * PARTS as f64) as u64);
        let mut text = more();
        if !text.is_empty() {
            text.push_str(", ");
        }
        text.push_str(&message(time_s, self.duration_s, elapsed.as_secs_f64()));
        bar.set_message(text);
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

/// `0.31 of 0.6 s, 0.12 s per second, 3 s left`.
fn message(time_s: f64, duration_s: f64, elapsed_s: f64) -> String {
    let rate = time_s / elapsed_s;
    let mut text = format!("{time_s:.3} of {duration_s} s");
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
    fn messages() {
        assert_eq!(
            message(0.3, 0.6, 1.0),
            "0.300 of 0.6 s, 0.30 simulated s per s, 1 s left"
        );
        assert_eq!(
            message(1e-4, 0.6, 1.0),
            "0.000 of 0.6 s, 1.0e-4 simulated s per s, 1.7 h left"
        );
        assert_eq!(message(0.0, 0.6, 1.0), "0.000 of 0.6 s");
    }
}
