//! Files of an atlas, from which an interrupted atlas is resumed.

use std::path::Path;

use pinwheel_timeseries::table::Table;
use serde::{Deserialize, Serialize};

use super::{Atlas, Cell, Failure, Options, SceneRow};
use crate::StudyError;
use crate::output::{OutputError, write_with};
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Studied<'a> {
    /// False after an interruption; missing scenes are null.
    finished: bool,
    atlas: &'a Atlas,
}

/// Part of an earlier study required for its continuation.
#[derive(Deserialize)]
struct Earlier {
    atlas: Atlas,
}

impl Atlas {
    /// Writes `summary.json` and `stability.csv` into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, origin: &Provenance) -> Result<(), OutputError> {
        write_with(dir, "stability.csv", |sink| self.table().write_csv(sink))?;
        let studied = Studied {
            finished: self.rows.iter().all(Option::is_some),
            atlas: self,
        };
        Summary::new(origin, studied).write(dir)
    }

    /// Reads the interrupted atlas of `options` from its files in `dir`.
    ///
    /// # Errors
    /// No atlas in `dir`, or one with other options.
    pub fn resume(dir: &Path, options: &Options) -> Result<Self, StudyError> {
        let place = dir.join("summary.json");
        let refuse = |what: String| {
            let place = place.display();
            let what = format!("--resume: {place}: {what}; leave out --resume to start again");
            StudyError::Input(what)
        };
        let text = std::fs::read_to_string(&place)
            .map_err(|error| refuse(format!("cannot be read: {error}")))?;
        let Earlier { atlas } = serde_json::from_str(&text)
            .map_err(|error| refuse(format!("has no study to resume: {error}")))?;
        // The file may have been edited.
        if atlas.options != *options || atlas.rows.len() != options.scenes.len() {
            return Err(refuse(
                "was made with other scenes, another length or another version".to_owned(),
            ));
        }
        Ok(atlas)
    }

    /// Returns a table with a row for each scene and method, and one for each scene without a converged run.
    pub fn table(&self) -> Table {
        let rows = self.done().flat_map(|row| {
            let refused = row.cells.is_empty().then_some(None);
            let cells = row.cells.iter().map(Some).chain(refused);
            cells.map(move |cell| (row, cell))
        });
        type Row<'a> = (&'a SceneRow, Option<&'a Cell>);
        let word = |of: fn(&Cell) -> String| move |row: &Row<'_>| row.1.map(of).unwrap_or_default();
        let failure = word(|cell| text_of(cell.failure.as_ref(), Failure::word));
        let dear = word(|cell| {
            let than = cell.dearer_than;
            than.map_or_else(String::new, |than| {
                format!("dearer than {than} evaluations")
            })
        });
        let first = word(|cell| text_of(cell.fails_first.as_ref(), Failure::word));
        let how = word(|cell| text_of(cell.fails_first.as_ref(), Failure::sentence));
        let never = word(|cell| cell.never_failed.to_string());
        Table::of("Every scene with every method", rows)
            .text("scene", "Scene", |(row, _)| &row.scene)
            .text("formulation", "Formulation", |row| {
                row.1.map_or("", |cell| cell.method.form())
            })
            .text("integrator", "Integrator", |row| {
                row.1.map_or("", |cell| &cell.method.integrator)
            })
            .number("tolerance", "Tolerance", |row| row.1?.method.tolerance)
            .number("error_forces", "Forces", |row| Some(row.1?.error?.forces))
            .number("error_driver_torque", "Driver torque", |row| {
                Some(row.1?.error?.driver_torque)
            })
            .text("failure", "Failure", failure)
            .text("not_run_to_the_end", "", dear)
            .number("largest_step_s", "Largest step", |row| {
                row.1?.largest_step_s
            })
            .text("never_failed", "", never)
            .text("fails_first", "Fails first", first)
            .text("fails_first_how", "", how)
            .number("energy_remainder_share", "Energy", |row| {
                row.1?.energy_remainder_share
            })
            .number("joint_drift_m", "Joints", |row| Some(row.1?.joint_drift_m))
            .integers("evaluations", "Evaluations", |row| Some(row.1?.evaluations))
            .text("refused", "Refused", |(row, cell)| {
                let reason = row.refused.as_deref().filter(|_| cell.is_none());
                reason.unwrap_or_default()
            })
            .done()
    }
}

/// Returns a text about a failure; empty without one.
fn text_of<W: Into<String>>(failure: Option<&Failure>, of: fn(&Failure) -> W) -> String {
    failure.map_or_else(String::new, |failure| of(failure).into())
}
