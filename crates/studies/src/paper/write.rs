//! Files of the study of the paper.

use std::path::Path;

use pinwheel_timeseries::table::{Column, Table};
use serde::Serialize;

use super::{Options, PaperResult, Plot};
use crate::output::{self, OutputError};
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`.
#[derive(Serialize)]
struct PaperSummary<'a> {
    /// Name of the run in place of Adams.
    against: Option<&'a str>,
    #[serde(flatten)]
    paper: &'a PaperResult,
}

impl PaperResult {
    /// Writes `summary.json`, `claims.md` and the curves of every plot, `KEY/courses.csv`, into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(
        &self,
        dir: &Path,
        options: &Options,
        origin: &Provenance,
    ) -> Result<(), OutputError> {
        for plot in self.figures.iter().flat_map(|figure| &figure.plots) {
            let place = output::folder(dir, &plot.key)?;
            output::write_with(&place, "courses.csv", |sink| table(plot).write_csv(sink))?;
        }
        let summary = PaperSummary {
            against: options.peer.as_ref().map(|peer| peer.name.as_str()),
            paper: self,
        };
        output::write_text(&dir.join("claims.md"), &self.claims_table())?;
        Summary::new(origin, summary).write(dir)
    }

    /// Returns the claims as a table in Markdown for `docs/physics.md`, one line each after its head.
    pub fn claims_table(&self) -> String {
        let mut text = String::from(
            "| claim | where | our figure | verdict | remark |\n|---|---|---|---|---|\n",
        );
        for judged in &self.claims {
            let claim = &judged.claim;
            let cells = [
                claim.claim.as_str(),
                &claim.place,
                &judged.figure,
                judged.verdict.words(),
                &claim.remark,
            ];
            text.push_str(&format!("| {} |\n", cells.join(" | ")));
        }
        text
    }
}

/// Returns a plot's curves: the first column is the horizontal axis, cells are empty where a curve has no value.
pub fn table(plot: &Plot) -> Table {
    let first = match plot.x_label.as_str() {
        "Time (s)" => "time_s",
        label => label,
    };
    let mut columns = vec![Column::numbers(first, &plot.x)];
    columns.extend(plot.curves.iter().map(|curve| {
        let name = format!("{}: {}", plot.y_label, curve.label);
        Column::numbers(name, &curve.y)
    }));
    let caption = plot.title.clone();
    Table { caption, columns }
}
