//! Files of a sweep's output folder.

use std::path::Path;

use pinwheel_timeseries::table::Table;
use serde::Serialize;

use super::{Journal, Limit, Plan, Row, SampleResult, costs, idle, tolerances};
use crate::StudyError;
use crate::output::{self, write_text, write_with};
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`: the sweep and every row of the results.
#[derive(Serialize)]
struct Payload<'a> {
    name: &'a str,
    description: &'a str,
    scene: &'a str,
    keys: Vec<&'a str>,
    engines: &'a [String],
    runs: usize,
    finished: usize,
    /// Keys without an effect on any run, to the bit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    no_effect: Vec<String>,
    rows: &'a Table,
    #[serde(skip_serializing_if = "<[Limit]>::is_empty")]
    specification: &'a [Limit],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    sample: Vec<SampleResult>,
}

/// Writes the results (`table`, of [`results`](super::results)) as CSV and, with the feature, as Parquet, the costs, the
/// sweep's file, every run's record and `summary.json` into the folder `dir`.
///
/// # Errors
/// A file cannot be written, or a record in the journal cannot be read.
pub fn write(
    dir: &Path,
    plan: &Plan,
    rows: &[Row<'_>],
    table: &Table,
    journal: &Journal,
    origin: &Provenance,
) -> Result<(), StudyError> {
    write_with(dir, "results.csv", |sink| table.write_csv(sink))?;
    let costs = costs(rows);
    write_with(dir, "costs.csv", |sink| costs.write_csv(sink))?;
    #[cfg(feature = "parquet")]
    {
        let path = dir.join("results.parquet");
        let failed = |error: &dyn std::fmt::Display| output::OutputError::new(&path, error);
        let file = std::fs::File::create(&path).map_err(|error| failed(&error))?;
        table.write_parquet(file).map_err(|error| failed(&error))?;
    }
    write_text(&dir.join("sweep.toml"), &plan.sweep.text)?;
    let runs = output::folder(dir, "runs")?;
    for (run, row) in rows.iter().copied().enumerate() {
        journal.copy(row, plan.sweep.time_series, run + 1, &runs)?;
    }
    let sweep = &plan.sweep;
    let finished = rows.iter().filter(|row| row.is_finished());
    let payload = Payload {
        name: &sweep.name,
        description: &sweep.description,
        scene: &sweep.scene,
        keys: plan.keys().collect(),
        engines: &sweep.engines,
        runs: rows.len(),
        finished: finished.count(),
        no_effect: idle(plan, rows),
        rows: table,
        specification: &sweep.specification,
        sample: tolerances(plan, table),
    };
    Ok(Summary::new(origin, payload).write(dir)?)
}
