//! Progress bar: on a terminal only, with the piece, the clock, and rate and time left of long runs.

use std::io::IsTerminal as _;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel::studies::{Control, Progress};

use crate::{interrupt, screen};

/// Time that a task must take before it gets a bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Milliseconds between two redraws: engines report every sample, millions of them.
const REDRAW_MS: u64 = 100;
/// Parts of the bar.
const PARTS: u64 = 1000;

/// Works under a bar with the command's name; a stop that the user asked for is a failure of its own.
pub(crate) fn watched<T, E>(work: impl FnOnce(&Control<'_>) -> Result<T, E>) -> Result<T, E> {
    interrupt::watched();
    let bar = Bar {
        started: Instant::now(),
        visible: std::io::stderr().is_terminal() && !screen::manner().quiet,
        drawn_ms: AtomicU64::new(0),
        bar: OnceLock::new(),
    };
    let report = |progress: Progress<'_>| bar.show(progress);
    let found = work(&Control::new(interrupt::flag(), &report));
    if let Some(bar) = bar.bar.get() {
        bar.finish_and_clear();
    }
    found
}

/// A bar that is nothing where nobody sees it.
struct Bar {
    started: Instant,
    visible: bool,
    drawn_ms: AtomicU64,
    bar: OnceLock<ProgressBar>,
}

impl Bar {
    fn show(&self, progress: Progress<'_>) {
        if !self.visible {
            return;
        }
        let elapsed = self.started.elapsed();
        let now_ms = u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX);
        let due = now_ms.saturating_sub(self.drawn_ms.load(Ordering::Relaxed)) >= REDRAW_MS;
        // The beginning of a piece is always drawn: the next report can be long in coming.
        if progress.simulated_s.is_some() && (elapsed < PATIENCE || !due) {
            return;
        }
        self.drawn_ms.store(now_ms, Ordering::Relaxed);
        let bar = self.bar.get_or_init(|| {
            let bar = ProgressBar::new(PARTS);
            if let Ok(style) =
                ProgressStyle::with_template("{prefix} [{bar:12}] {elapsed}: {wide_msg}")
            {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_prefix(screen::manner().command);
            // Single pieces take many seconds: the clock shows that something happens.
            bar.enable_steady_tick(Duration::from_millis(500));
            bar
        });
        let share = match progress.simulated_s {
            Some([at, of]) => at / of,
            None => progress.done as f64 / progress.total.max(1) as f64,
        };
        bar.set_position((share * PARTS as f64) as u64);
        bar.set_message(progress.sentence(elapsed.as_secs_f64()));
    }
}
