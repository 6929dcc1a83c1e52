//! Rows of the results: records of many runs in memory, without their scenes.
//!
//! Numbers and words of all runs are stored in common lists. Separate small blocks would take some kilobytes a run, because
//! they lie among short-lived blocks of every run.

use std::ops::Deref;

use pinwheel_files::fnv;
use pinwheel_timeseries::Ending;

use crate::sweep::record::{Outcome, RunRecord};
use crate::sweep::spread::{FIGURES, WindowStatistics};

/// Rows of a plan's runs, each absent until its record is there.
#[derive(Debug, Default)]
pub struct Rows {
    lines: Vec<Option<Line>>,
    kinds: Vec<Kind>,
    figures: Vec<WindowStatistics>,
    balances: Vec<f64>,
    words: String,
}

/// Engine and names that many runs have in common.
#[derive(Debug, PartialEq)]
struct Kind {
    engine: [String; 3],
    quantities: Vec<String>,
    balances: Vec<String>,
}

/// Numbers of a run, with the places of its kind, first figure, first balance and words.
#[derive(Debug, Clone)]
struct Line {
    kind: usize,
    outcome: Outcome,
    figures: usize,
    balances: usize,
    words: [usize; 2],
    /// True if the words are those of undefined figures; otherwise they are the ending, JSON.
    finished: bool,
    identity: Option<u64>,
    result: u64,
}

/// Record of a run without its scene.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    rows: &'a Rows,
    line: &'a Line,
}

impl Rows {
    /// Returns the rows of `count` runs, all absent.
    pub fn new(count: usize) -> Self {
        Self {
            lines: vec![None; count],
            ..Self::default()
        }
    }

    /// Returns all rows; `None` if one is absent.
    pub fn all(&self) -> Option<Vec<Row<'_>>> {
        let lines = self.lines.iter().map(Option::as_ref);
        lines
            .map(|line| {
                Some(Row {
                    rows: self,
                    line: line?,
                })
            })
            .collect()
    }

    /// Number of rows that are there.
    pub fn done(&self) -> usize {
        self.lines.iter().flatten().count()
    }

    /// Adds the record of a run.
    pub fn put(&mut self, run: usize, mut record: RunRecord) {
        let identity = (!record.scene.is_empty()).then(|| fnv(record.identity().bytes()));
        record.scene.clear();
        let outcome = record.outcome.clone();
        (record.outcome.wall_s, record.outcome.cpu_s) = (0.0, 0.0);
        let result = fnv(serde_json::to_vec(&record).unwrap_or_default());
        let finished = record.ending.is_finished();
        let words = match finished {
            true => record.undefined.join("; "),
            false => serde_json::to_string(&record.ending).unwrap_or_default(),
        };
        let kind = Kind {
            engine: [record.engine, record.engine_version, record.engine_build],
            quantities: record.quantities,
            balances: record.balances.keys().cloned().collect(),
        };
        let place = self.kinds.iter().position(|known| *known == kind);
        let place = place.unwrap_or_else(|| {
            self.kinds.push(kind);
            self.kinds.len() - 1
        });
        let begin = self.words.len();
        self.words.push_str(&words);
        self.lines[run] = Some(Line {
            kind: place,
            outcome,
            figures: self.figures.len(),
            balances: self.balances.len(),
            words: [begin, self.words.len()],
            finished,
            identity,
            result,
        });
        let quantities = self.kinds[place].quantities.iter();
        let figures = quantities.filter_map(|name| record.figures.remove(name));
        self.figures.extend(figures);
        self.balances.extend(record.balances.into_values());
    }
}

impl Deref for Row<'_> {
    type Target = Outcome;

    fn deref(&self) -> &Outcome {
        &self.line.outcome
    }
}

impl<'a> Row<'a> {
    fn kind(self) -> &'a Kind {
        &self.rows.kinds[self.line.kind]
    }

    fn words(self) -> &'a str {
        let [begin, end] = self.line.words;
        &self.rows.words[begin..end]
    }

    /// Returns the record of values that make no gear.
    pub(super) fn record(self) -> RunRecord {
        let [engine, version, build] = &self.kind().engine;
        RunRecord {
            engine_version: version.clone(),
            engine_build: build.clone(),
            ..RunRecord::bare(engine, self.ending(), self.line.outcome.clone())
        }
    }

    /// Returns name and version of the engine.
    pub fn engine(self) -> [&'a str; 2] {
        let [engine, version, _] = &self.kind().engine;
        [engine, version]
    }

    /// True if the run finished.
    pub fn is_finished(self) -> bool {
        self.line.finished
    }

    /// Returns the ending of the run.
    pub fn ending(self) -> Ending {
        match self.line.finished {
            true => Ending::Finished,
            false => serde_json::from_str(self.words()).unwrap_or_else(Ending::failed),
        }
    }

    /// Returns the quantities with figures, in the order of the time series.
    pub fn quantities(self) -> &'a [String] {
        &self.kind().quantities
    }

    /// Returns the figures of a quantity.
    pub fn figure(self, quantity: &str) -> Option<&'a WindowStatistics> {
        let place = self.quantities().iter().position(|name| name == quantity)?;
        self.rows.figures.get(self.line.figures + place)
    }

    /// Returns a figure of equilibria by its column.
    pub fn balance(self, column: &str) -> Option<f64> {
        let mut names = self.kind().balances.iter();
        let place = names.position(|name| name == column)?;
        self.rows.balances.get(self.line.balances + place).copied()
    }

    /// Returns the uncertainty of a column's figure from sampling; `None` if it is no figure of samples.
    pub fn sampling(self, column: &str) -> Option<f64> {
        let (figure, quantity) = column.split_once('_')?;
        let (_, of) = FIGURES.iter().find(|(name, _)| *name == figure)?;
        self.figure(quantity)?.sampling.as_ref().map(of)
    }

    /// Returns the hash of [`RunRecord::identity`]; `None` if the values of a sample make no gear.
    pub(super) fn identity(self) -> Option<u64> {
        self.line.identity
    }

    /// Returns a hash of everything but scene and times.
    pub(super) fn result(self) -> u64 {
        self.line.result
    }

    /// True unless the values of a sample make no gear.
    pub fn is_gear(self) -> bool {
        self.line.identity.is_some()
    }

    /// Returns the reason for empty cells; empty if there are none.
    pub fn reason(self) -> String {
        let reason = self.ending().reason();
        reason.unwrap_or_else(|| self.words().to_owned())
    }
}
