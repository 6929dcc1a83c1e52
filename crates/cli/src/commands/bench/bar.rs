//! Progress of a study: its pieces counted, the running one named; on a terminal only.

use std::io::IsTerminal as _;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel_studies::Progress;

/// A bar that is nothing where nobody sees it.
pub(super) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar with a label.
    pub(super) fn new(label: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::new(1);
        if let Ok(style) =
            ProgressStyle::with_template("{prefix} [{bar:24}] {pos} of {len}, {elapsed}: {msg}")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(label.to_owned());
        // Single runs take many seconds: the clock shows that something happens.
        bar.enable_steady_tick(Duration::from_millis(500));
        Self(Some(bar))
    }

    /// A piece begins.
    pub(super) fn at(&self, progress: Progress<'_>) {
        if let Some(bar) = &self.0 {
            bar.set_length(progress.total as u64);
            bar.set_position(progress.done as u64);
            bar.set_message(progress.piece.to_owned());
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
