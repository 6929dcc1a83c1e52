//! A survey as files, and back: one that was stopped goes on from them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Plan, Survey, table};
use crate::StudyError;
use crate::output::{OutputError, write_with};
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Found<'a> {
    /// False after a stop: pieces that are not done are null.
    finished: bool,
    survey: &'a Survey,
}

/// What going on needs of it.
#[derive(Deserialize)]
struct Earlier {
    survey: Survey,
}

impl Survey {
    /// Writes `summary.json` and `stability.csv` into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, made: &Provenance) -> Result<(), OutputError> {
        write_with(dir, "stability.csv", |sink| table::write(self, sink))?;
        let (done, all) = self.done();
        let found = Found {
            finished: done == all,
            survey: self,
        };
        Summary::new(made, found).write(dir)
    }

    /// The survey of `plan` that was stopped and left its files in `dir`.
    ///
    /// # Errors
    /// There is none, or it was made by another plan.
    pub fn resume(dir: &Path, plan: &Plan) -> Result<Self, StudyError> {
        let place = dir.join("summary.json");
        let refuse = |what: String| {
            StudyError::Input(format!(
                "--resume: {}: {what}; leave out --resume to begin anew",
                place.display()
            ))
        };
        let text = std::fs::read_to_string(&place)
            .map_err(|error| refuse(format!("cannot be read: {error}")))?;
        let Earlier { survey } = serde_json::from_str(&text)
            .map_err(|error| refuse(format!("holds no study to go on with: {error}")))?;
        if survey.plan != *plan || !survey.is_whole() {
            return Err(refuse(
                "was made with other scenes, another length or another version".to_owned(),
            ));
        }
        Ok(survey)
    }
}
