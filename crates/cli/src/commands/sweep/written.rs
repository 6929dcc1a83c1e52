//! The files of a sweep's output folder.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use pinwheel_report::study;
use pinwheel_sweep::{Column, Journal, Plan, Results, RunRecord, costs, results};
use serde::Serialize;
use serde_json::{Map, Value};

use super::{failure, page};
use crate::failure::Failure;
use crate::folder::Folder;
use crate::machine::Machine;
use crate::record;

/// `summary.json`: what was run and every row of the results.
#[derive(Serialize)]
struct Summary<'a> {
    pinwheel_version: &'static str,
    command: &'a str,
    name: &'a str,
    description: &'a str,
    scene: &'a str,
    keys: Vec<&'a str>,
    engines: &'a [String],
    runs: usize,
    finished: usize,
    rows: Vec<Map<String, Value>>,
    machine: &'a Machine,
}

pub(super) fn write(
    folder: &Folder,
    plan: &Plan,
    records: &[RunRecord],
    journal: &Journal,
    command: &str,
) -> Result<(), Failure> {
    let (table, machine, at) = (results(plan, records), Machine::here(), folder.path());
    csv(&table, &at.join("results.csv"))?;
    csv(&costs(plan, records), &at.join("costs.csv"))?;
    #[cfg(feature = "parquet")]
    {
        let path = at.join("results.parquet");
        let file = File::create(&path).map_err(|error| Failure::unwritable(&path, &error))?;
        table
            .write_parquet(file)
            .map_err(|error| Failure::unwritable(&path, &error))?;
    }
    record::write_text(&at.join("sweep.toml"), &plan.sweep.text)?;
    let runs = at.join("runs");
    fs::create_dir_all(&runs).map_err(|error| Failure::unwritable(&runs, &error))?;
    for (run, record) in plan.runs.iter().zip(records) {
        journal.copy(record, run.number, &runs).map_err(failure)?;
    }
    let html = study::render(&page::page(plan, records, &table, command, &machine))
        .map_err(|error| Failure::engine(format!("the report cannot be made: {error}")))?;
    record::write_text(&at.join("index.html"), &html)?;
    let sweep = &plan.sweep;
    record::write_json(
        &at.join("summary.json"),
        &Summary {
            pinwheel_version: env!("CARGO_PKG_VERSION"),
            command,
            name: &sweep.name,
            description: &sweep.description,
            scene: &sweep.scene,
            keys: plan.keys().collect(),
            engines: &sweep.engines,
            runs: records.len(),
            finished: records
                .iter()
                .filter(|record| record.outcome.word() == "finished")
                .count(),
            rows: rows(&table),
            machine: &machine,
        },
    )
}

fn csv(table: &Results, path: &Path) -> Result<(), Failure> {
    let file = File::create(path).map_err(|error| Failure::unwritable(path, &error))?;
    table
        .write_csv(BufWriter::new(file))
        .map_err(|error| Failure::unwritable(path, &error))
}

fn rows(table: &Results) -> Vec<Map<String, Value>> {
    let cell = |column: &Column, row: usize| match column {
        Column::Number(values) => values[row].map(Value::from),
        Column::Whole(values) => values[row].map(Value::from),
        Column::Text(values) => values[row].clone().map(Value::from),
    };
    (0..table.rows())
        .map(|row| {
            let columns = table.columns.iter();
            columns
                .map(|(name, column)| (name.clone(), cell(column, row).unwrap_or(Value::Null)))
                .collect()
        })
        .collect()
}
