//! Common parts of all sections of a comparison's page.

use std::collections::BTreeMap;

use crate::format;
use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::{Assessment, Comparison, Verdict, WindowKind};
use pinwheel_timeseries::table::{Mark, Table, TableOf};

use super::words;
use crate::pages::colours;

/// Common data of the parts of the page.
pub(super) struct Page<'a> {
    pub(super) comparison: &'a Comparison,
    /// Colour and dash of each engine by its name.
    styles: BTreeMap<&'a str, usize>,
}

impl<'a> Page<'a> {
    pub(super) fn new(comparison: &'a Comparison) -> Self {
        let names = comparison.engines.iter().map(|e| e.name.as_str());
        let styles = colours::by_name(names);
        Self { comparison, styles }
    }

    /// Creates a table with a row for each engine, named in the first column.
    pub(super) fn of_engines<R>(
        &self,
        caption: &str,
        rows: impl IntoIterator<Item = R>,
        engine: impl Fn(&R) -> &'a EngineSummary,
    ) -> TableOf<R> {
        Table::of(caption, rows)
            .text("", "Engine", |row| &engine(row).name)
            .coloured(|row| self.styles.get(engine(row).name.as_str()).copied())
    }

    /// Returns the label of a quantity.
    pub(super) fn quantity(&self, name: &'a str) -> &'a str {
        words::label(self.comparison, name)
    }

    /// Returns a quantity and a window, e.g. `driver torque, steady`.
    pub(super) fn place(&self, quantity: &'a str, window: WindowKind) -> String {
        let label = self.quantity(quantity).to_lowercase();
        format!("{label}, {}", window.word())
    }

    /// Returns the label of a window, e.g. `Steady, 0.3–0.6 s`.
    pub(super) fn window(&self, kind: WindowKind) -> String {
        let word = match kind {
            WindowKind::Steady => "Steady",
            WindowKind::Transient => "Transient",
            WindowKind::Whole => "Whole run",
        };
        let mut windows = self.comparison.windows.iter();
        match windows.find(|window| window.kind == kind) {
            Some(window) => format!("{word}, {}", span(window.from_s, window.to_s)),
            None => word.to_owned(),
        }
    }
}

/// Returns the mark of a verdict; open ones are muted.
pub(super) fn mark(result: &Assessment) -> Mark {
    match result.verdict {
        Verdict::Agree => Mark::Good,
        Verdict::Differ => Mark::Bad,
        Verdict::Inconclusive if result.actionable => Mark::Warn,
        Verdict::Inconclusive | Verdict::NotCompared => Mark::Muted,
    }
}

/// Formats an interval of time, `0.3–0.6 s`.
pub(super) fn span(from_s: f64, to_s: f64) -> String {
    let [from, to] = [from_s, to_s].map(format::plain);
    format!("{from}\u{2013}{to}\u{202f}s")
}
