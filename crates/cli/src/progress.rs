//! Progress: on a terminal a bar with piece, clock and remaining time if known; elsewhere a line a minute.

use std::io::IsTerminal as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel::studies::{Control, Progress};

use crate::{interrupt, screen};

/// Duration of a task before it gets a bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Milliseconds between two redraws: engines report every sample, millions of them.
const REDRAW_MS: u64 = 100;
/// Time between two lines without a terminal.
const LINE: Duration = Duration::from_secs(60);
/// Parts of the bar.
const PARTS: u64 = 1000;

/// Runs work under a bar with the command's name; a stop by the user is a separate failure.
pub(crate) fn watched<T, E>(work: impl FnOnce(&Control<'_>) -> Result<T, E>) -> Result<T, E> {
    interrupt::watched();
    let bar = Bar {
        started: Instant::now(),
        visible: !screen::manner().quiet,
        terminal: std::io::stderr().is_terminal(),
        drawn_ms: AtomicU64::new(0),
        sentence: Mutex::default(),
        bar: OnceLock::new(),
    };
    let report = |progress: Progress<'_>| bar.show(progress);
    let result = std::thread::scope(|scope| {
        // Dropped when the work is done, also by a panic.
        let (_working, ended) = mpsc::channel::<()>();
        if bar.visible && !bar.terminal {
            let bar = &bar;
            scope.spawn(move || {
                while ended.recv_timeout(LINE) == Err(RecvTimeoutError::Timeout) {
                    bar.tell();
                }
            });
        }
        work(&Control::new(interrupt::flag(), &report))
    });
    if let Some(bar) = bar.bar.get() {
        bar.finish_and_clear();
    }
    result
}

/// Progress bar, inactive without a reader.
struct Bar {
    started: Instant,
    visible: bool,
    terminal: bool,
    drawn_ms: AtomicU64,
    /// Sentence of the last report, where there is no terminal.
    sentence: Mutex<String>,
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
        // The start of a piece is always drawn, because the next report can take long.
        if progress.simulated_s.is_some() && (elapsed < PATIENCE || !due) {
            return;
        }
        self.drawn_ms.store(now_ms, Ordering::Relaxed);
        if !self.terminal {
            if let Ok(mut text) = self.sentence.lock() {
                *text = progress.sentence();
            }
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let bar = ProgressBar::new(PARTS);
            if let Ok(style) =
                ProgressStyle::with_template("{prefix} [{bar:8}] {elapsed_precise}: {wide_msg}")
            {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_prefix(screen::manner().command);
            // Single pieces take many seconds, so a running clock shows activity.
            bar.enable_steady_tick(Duration::from_millis(500));
            bar
        });
        let share = match (progress.simulated_s, progress.left_s) {
            (_, Some(left)) => elapsed.as_secs_f64() / (elapsed.as_secs_f64() + left),
            (Some([at, of]), None) => at / of,
            (None, None) => progress.done as f64 / progress.total.max(1) as f64,
        };
        bar.set_position((share * PARTS as f64) as u64);
        bar.set_message(progress.sentence());
    }

    /// Writes the last report with the elapsed time, even without a new report.
    fn tell(&self) {
        let text = self.sentence.lock().map(|text| text.clone());
        let command = screen::manner().command;
        screen::show_on_stderr(&line(
            command,
            &text.unwrap_or_default(),
            self.started.elapsed(),
        ));
    }
}

/// `compare, 2 min: 3 of 14, exudyn-explicit, 40 s left`.
fn line(command: &str, text: &str, elapsed: Duration) -> String {
    let minutes = elapsed.as_secs() / 60;
    format!("{command}, {minutes} min: {text}")
        .trim_end_matches([':', ' '])
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_where_it_is() {
        let at = Progress {
            left_s: Some(40.0),
            ..Progress::new(2, 14, "rapier-shared-law, exudyn-own-contact")
        };
        let text = |at: Progress<'_>| line("compare", &at.sentence(), Duration::from_secs(130));
        assert_eq!(
            text(at),
            "compare, 2 min: 3 of 14, rapier-shared-law, exudyn-own-contact, 40 s left"
        );
        let unknown = Progress { left_s: None, ..at };
        assert!(!text(unknown).contains("left"));
        assert_eq!(line("run", "", Duration::from_secs(60)), "run, 1 min");
    }
}
