//! An atlas as files, and back: one that was stopped goes on from them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Atlas, Cell, Failure, Options, SceneRow};
use crate::StudyError;
use crate::output::{OutputError, write_with};
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Studied<'a> {
    /// False after a stop: scenes that are not done are null.
    finished: bool,
    atlas: &'a Atlas,
}

/// What going on needs of it.
#[derive(Deserialize)]
struct Earlier {
    atlas: Atlas,
}

impl Atlas {
    /// Writes `summary.json` and `stability.csv` into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, made: &Provenance) -> Result<(), OutputError> {
        write_with(dir, "stability.csv", |sink| write_csv(self, sink))?;
        let studied = Studied {
            finished: self.rows.iter().all(Option::is_some),
            atlas: self,
        };
        Summary::new(made, studied).write(dir)
    }

    /// The atlas of `options` that was stopped and left its files in `dir`.
    ///
    /// # Errors
    /// There is none, or it was made with other options.
    pub fn resume(dir: &Path, options: &Options) -> Result<Self, StudyError> {
        let place = dir.join("summary.json");
        let refuse = |what: String| {
            StudyError::Input(format!(
                "--resume: {}: {what}; leave out --resume to begin anew",
                place.display()
            ))
        };
        let text = std::fs::read_to_string(&place)
            .map_err(|error| refuse(format!("cannot be read: {error}")))?;
        let Earlier { atlas } = serde_json::from_str(&text)
            .map_err(|error| refuse(format!("holds no study to go on with: {error}")))?;
        // What was read back from a file may be anything.
        if atlas.options != *options || atlas.rows.len() != options.scenes.len() {
            return Err(refuse(
                "was made with other scenes, another length or another version".to_owned(),
            ));
        }
        Ok(atlas)
    }
}

const HEAD: [&str; 15] = [
    "scene",
    "formulation",
    "integrator",
    "tolerance",
    "error_forces",
    "error_driver_torque",
    "failure",
    "largest_step_s",
    "never_failed",
    "fails_first",
    "fails_first_how",
    "energy_remainder_share",
    "joint_drift_m",
    "evaluations",
    "refused",
];

/// One line a scene and method.
fn write_csv(atlas: &Atlas, sink: impl std::io::Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record(HEAD)?;
    for row in atlas.done() {
        if row.cells.is_empty() {
            let mut record = vec![String::new(); HEAD.len()];
            record[0].clone_from(&row.scene);
            record[HEAD.len() - 1] = row.refused.clone().unwrap_or_default();
            writer.write_record(record)?;
        }
        for cell in &row.cells {
            writer.write_record(line(row, cell))?;
        }
    }
    writer.flush().map_err(csv::Error::from)
}

fn line(row: &SceneRow, cell: &Cell) -> Vec<String> {
    let figure = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:e}"));
    let method = &cell.method;
    let first = cell.fails_first.as_ref();
    vec![
        row.scene.clone(),
        method.form().to_owned(),
        method.integrator.clone(),
        figure(method.tolerance),
        figure(cell.error.map(|e| e.forces)),
        figure(cell.error.map(|e| e.driver_torque)),
        cell.failure.as_ref().map_or("", Failure::word).to_owned(),
        figure(cell.largest_step_s),
        cell.never_failed.to_string(),
        first.map_or("", Failure::word).to_owned(),
        first.map(Failure::sentence).unwrap_or_default(),
        figure(cell.energy_remainder_share),
        format!("{:e}", cell.joint_drift_m),
        cell.evaluations.to_string(),
        String::new(),
    ]
}
