//! What can be wrong with a map or a foreign file. Every message is one line with its remedy.

use pinwheel_files::FileError;

/// A row that could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadRow {
    /// Line of the file, the first being 1.
    pub line: usize,
    /// Why.
    pub reason: String,
}

/// Faults of mapping and reading.
#[derive(Debug, thiserror::Error)]
pub enum ForeignError {
    /// The map is not understood, or contradicts itself.
    #[error(transparent)]
    Map(#[from] FileError),
    /// A column the map names is not in the file.
    #[error("`{key}`: the file has no column `{column}`; it has {}", listed(.there))]
    Column {
        /// The map's key.
        key: String,
        /// The column it names.
        column: String,
        /// Those there are.
        there: Vec<String>,
    },
    /// A column feeds more of ours than anybody means.
    #[error("`{key}`: column `{}` feeds more than {most} columns; map it once", short(.column))]
    Uses {
        /// The map's key that is one too many.
        key: String,
        /// The file's column.
        column: String,
        /// How many it may feed.
        most: usize,
    },
    /// Rows that cannot be read.
    #[error("{}; mend them, or write bad = \"skip\" under [rows] of the map to leave them out", rows(.bad, *.total))]
    Rows {
        /// All bad rows.
        bad: Vec<BadRow>,
        /// Rows of the file.
        total: usize,
    },
    /// Too little is left.
    #[error("{good} of {total} rows can be read, too few to compare{}", first(.bad))]
    Few {
        /// Rows that could be read.
        good: usize,
        /// Rows of the file.
        total: usize,
        /// Bad rows.
        bad: Vec<BadRow>,
    },
    /// The times of the file and of the run have nothing in common.
    #[error(
        "the file covers {from_s} to {to_s} s, none of it in the run's {run_from_s} to {run_to_s} s; set time.unit and time.offset_s of the map"
    )]
    Apart {
        /// Start of the file, s.
        from_s: f64,
        /// End of the file, s.
        to_s: f64,
        /// Start of the run, s.
        run_from_s: f64,
        /// End of the run, s.
        run_to_s: f64,
    },
    /// The file cannot be read.
    #[error("cannot be read: {0}; give a text file of separated values")]
    Io(String),
}

/// Names in backquotes, not too many.
fn listed(names: &[String]) -> String {
    const MOST: usize = 12;
    let mut text: Vec<String> = names
        .iter()
        .take(MOST)
        .map(|name| format!("`{}`", short(name)))
        .collect();
    if names.len() > MOST {
        text.push(format!("{} more", names.len() - MOST));
    }
    if text.is_empty() {
        "none: check file.separator".to_owned()
    } else {
        text.join(", ")
    }
}

/// `3 of 600 rows are bad: line 7: ...; line 9: ...; 1 more`.
pub(super) fn rows(bad: &[BadRow], total: usize) -> String {
    const MOST: usize = 5;
    let mut text: Vec<String> = bad
        .iter()
        .take(MOST)
        .map(|row| format!("line {}: {}", row.line, row.reason))
        .collect();
    if bad.len() > MOST {
        text.push(format!("{} more", bad.len() - MOST));
    }
    format!("{} of {total} rows are bad: {}", bad.len(), text.join("; "))
}

fn first(bad: &[BadRow]) -> String {
    bad.first().map_or_else(String::new, |row| {
        format!("; the first bad one is line {}: {}", row.line, row.reason)
    })
}

/// A foreign text inside a message: one line, short.
pub(super) fn short(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut line: String = text
        .chars()
        .take(LONGEST)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().count() > LONGEST {
        line.push_str("...");
    }
    line
}
