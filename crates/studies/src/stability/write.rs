//! An atlas as files, and back: one that was stopped goes on from them.

use std::path::Path;

use pinwheel_timeseries::table::Table;
use serde::{Deserialize, Serialize};

use super::{Atlas, Cell, Failure, Method, Options, SceneRow};
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
        write_with(dir, "stability.csv", |sink| self.table().write_csv(sink))?;
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

impl Atlas {
    /// One row a scene and method; one of a scene that was refused.
    #[must_use]
    pub fn table(&self) -> Table {
        let refused = |row: &SceneRow| row.cells.is_empty().then_some(None);
        let rows = self.done().flat_map(|row| {
            let cells = row.cells.iter().map(Some);
            cells.chain(refused(row)).map(move |cell| (row, cell))
        });
        let method = |cell: &Option<&Cell>, of: fn(&Method) -> &str| {
            cell.map_or_else(String::new, |cell| of(&cell.method).to_owned())
        };
        let word = |failure: Option<&Failure>| failure.map_or("", Failure::word);
        Table::of("Every scene with every method", rows)
            .text("scene", "Scene", |(row, _)| &row.scene)
            .text("formulation", "Formulation", |(_, cell)| {
                method(cell, Method::form)
            })
            .text("integrator", "Integrator", |(_, cell)| {
                method(cell, |method| &method.integrator)
            })
            .number("tolerance", "Tolerance", |(_, cell)| {
                cell.and_then(|cell| cell.method.tolerance)
            })
            .number("error_forces", "Forces", |(_, cell)| {
                cell.and_then(|cell| Some(cell.error?.forces))
            })
            .number("error_driver_torque", "Driver torque", |(_, cell)| {
                cell.and_then(|cell| Some(cell.error?.driver_torque))
            })
            .text("failure", "Failure", |(_, cell)| {
                word(cell.and_then(|cell| cell.failure.as_ref()))
            })
            .number("largest_step_s", "Largest step", |(_, cell)| {
                cell.and_then(|cell| cell.largest_step_s)
            })
            .text("never_failed", "", |(_, cell)| {
                cell.map_or_else(String::new, |cell| cell.never_failed.to_string())
            })
            .text("fails_first", "Fails first", |(_, cell)| {
                word(cell.and_then(|cell| cell.fails_first.as_ref()))
            })
            .text("fails_first_how", "", |(_, cell)| {
                let first = cell.and_then(|cell| cell.fails_first.as_ref());
                first.map_or_else(String::new, Failure::sentence)
            })
            .number("energy_remainder_share", "Energy", |(_, cell)| {
                cell.and_then(|cell| cell.energy_remainder_share)
            })
            .number("joint_drift_m", "Joints", |(_, cell)| {
                cell.map(|cell| cell.joint_drift_m)
            })
            .whole("evaluations", "Evaluations", |(_, cell)| {
                cell.map(|cell| cell.evaluations)
            })
            .text("refused", "Refused", |(row, cell)| {
                let reason = row.refused.as_deref().filter(|_| cell.is_none());
                reason.unwrap_or_default()
            })
            .done()
    }
}
