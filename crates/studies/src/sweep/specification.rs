//! Limits on the figures of a sweep.

use pinwheel_files::{Document, FileError, Item};
use serde::{Deserialize, Serialize};

/// Limit of a specification on a column of the results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with `least` or `most`")]
pub struct Limit {
    /// Name of the column.
    #[serde(skip_deserializing)]
    pub figure: String,
    /// Least permitted value.
    pub least: Option<f64>,
    /// Largest permitted value.
    pub most: Option<f64>,
}

impl Limit {
    /// True if a figure is within the limit; a missing figure is not.
    pub fn holds(&self, value: Option<f64>) -> bool {
        value.is_some_and(|x| {
            self.least.is_none_or(|least| x >= least) && self.most.is_none_or(|most| x <= most)
        })
    }
}

/// Reads the limit on the column `figure`.
pub(super) fn read(
    document: &Document<'_>,
    figure: &str,
    item: &Item<'_>,
) -> Result<Limit, FileError> {
    const FORM: &str =
        "write lost_motion_arcmin = { most = 1.0 }, with least = ... for what must not be below";
    let limit: Limit = document.read(figure, item, FORM)?;
    let ends = [limit.least, limit.most];
    let wrong = match ends {
        [None, None] => "has no `least` or `most`",
        [Some(least), Some(most)] if least > most => "has a `least` above its `most`",
        _ if ends.iter().flatten().any(|end| !end.is_finite()) => {
            "has a limit that is no finite number"
        }
        _ => {
            let figure = figure.to_owned();
            return Ok(Limit { figure, ..limit });
        }
    };
    Err(document.fault(item.line, format!("`{figure}` {wrong}"), FORM))
}
