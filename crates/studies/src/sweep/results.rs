//! The table of a sweep: a row a run, a column a key or figure.

use std::io::Write;

use pinwheel_compare::limits::fits;
use pinwheel_courses::{CoursesError, Ending};

use crate::sweep::axis::Value;
use crate::sweep::record::RunRecord;
use crate::sweep::spread::FIGURES;
use crate::sweep::{Limit, Plan, PlannedRun, statics};

/// Values of one column, row by row.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// Numbers, with the unit in the column's name.
    Number(Vec<Option<f64>>),
    /// Whole numbers.
    Whole(Vec<Option<i64>>),
    /// Words.
    Text(Vec<Option<String>>),
}

/// A table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Results {
    /// Names and values; all have as many rows as there are runs.
    pub columns: Vec<(String, Column)>,
}

/// Column that says whether a run keeps the specification: 1 or 0.
const WITHIN: &str = "within_specification";

/// The results of all runs, in the plan's order: the same whatever the number of threads.
#[must_use]
pub fn results(plan: &Plan, records: &[RunRecord]) -> Results {
    let mut table = Results::default();
    let rows = || plan.runs.iter().zip(records);
    let text = |of: &dyn Fn(&PlannedRun, &RunRecord) -> String| {
        let cell = |text: String| (!text.is_empty()).then_some(text);
        Column::Text(rows().map(|(run, record)| cell(of(run, record))).collect())
    };
    let number = |of: &dyn Fn(&RunRecord) -> Option<f64>| {
        // What is not finite is no number: its cell is empty, now and when the record is read again.
        let cell = |record: &RunRecord| of(record).filter(|value| value.is_finite());
        Column::Number(rows().map(|(_, record)| cell(record)).collect())
    };
    let whole = |of: &dyn Fn(&PlannedRun, &RunRecord) -> usize| {
        let cell = |value: usize| i64::try_from(value).ok();
        Column::Whole(rows().map(|(run, record)| cell(of(run, record))).collect())
    };
    let mut push = |name: &str, column: Column| table.columns.push((name.to_owned(), column));
    push("run", whole(&|run, _| run.number));
    push("engine", text(&|run, _| run.engine.clone()));
    for (place, key) in plan.keys().enumerate() {
        push(key, varied(plan, place));
    }
    push("status", text(&|_, record| record.ending.word().to_owned()));
    let diverged = |record: &RunRecord| match record.ending {
        Ending::Diverged { time_s, .. } => Some(time_s),
        _ => None,
    };
    push("diverged_at_s", number(&diverged));
    push("window_from_s", number(&|record| Some(record.window_s[0])));
    push("window_to_s", number(&|record| Some(record.window_s[1])));
    push("efficiency", number(&|record| record.efficiency));
    push(
        "efficiency_accounted",
        number(&|record| record.efficiency_accounted),
    );
    push(
        "energy_remainder_share",
        number(&|record| record.energy_remainder_share),
    );
    push("steps", whole(&|_, record| record.steps as usize));
    push("rhs_calls", whole(&|_, record| record.rhs_calls as usize));
    for quantity in quantities(plan, records) {
        for (figure, of) in FIGURES {
            let value = |record: &RunRecord| record.figures.get(quantity).map(of);
            push(&format!("{figure}_{quantity}"), number(&value));
        }
    }
    for (name, _) in statics::FIGURES {
        let wanted = plan.sweep.measure.iter().any(|pattern| fits(pattern, name));
        if wanted && records.iter().any(|r| r.balances.contains_key(name)) {
            push(name, number(&|record| record.balances.get(name).copied()));
        }
    }
    let limits = &plan.sweep.specification;
    if !limits.is_empty() {
        let kept = (0..records.len()).map(|row| Some(i64::from(table.keeps(limits, row))));
        let kept = Column::Whole(kept.collect());
        table.columns.push((WITHIN.to_owned(), kept));
    }
    let mut push = |name: &str, column: Column| table.columns.push((name.to_owned(), column));
    push("reason", text(&|_, record| record.reason()));
    table
}

/// What each run cost: not part of the results, as no two runs cost the same.
#[must_use]
pub fn costs(plan: &Plan, records: &[RunRecord]) -> Results {
    let rows = || plan.runs.iter().zip(records);
    let columns = vec![
        (
            "run",
            Column::Whole(
                rows()
                    .map(|(run, _)| i64::try_from(run.number).ok())
                    .collect(),
            ),
        ),
        (
            "engine",
            Column::Text(rows().map(|(run, _)| Some(run.engine.clone())).collect()),
        ),
        (
            "wall_s",
            Column::Number(rows().map(|(_, record)| Some(record.wall_s)).collect()),
        ),
        (
            "cpu_s",
            Column::Number(rows().map(|(_, record)| Some(record.cpu_s)).collect()),
        ),
    ];
    Results {
        columns: columns
            .into_iter()
            .map(|(name, column)| (name.to_owned(), column))
            .collect(),
    }
}

/// Quantities of the records that the sweep measures, in the order they first appear.
fn quantities<'a>(plan: &Plan, records: &'a [RunRecord]) -> Vec<&'a str> {
    let mut list: Vec<&str> = Vec::new();
    for name in records.iter().flat_map(|record| &record.quantities) {
        let wanted = plan.sweep.measure.iter().any(|pattern| fits(pattern, name));
        if wanted && !list.contains(&name.as_str()) {
            list.push(name);
        }
    }
    list
}

/// The column of a varied key: numbers if all of its values are.
fn varied(plan: &Plan, place: usize) -> Column {
    let values: Vec<&Value> = plan.runs.iter().map(|run| &run.values[place].1).collect();
    let whole = |value: &&Value| match value {
        Value::Whole(x) => Some(*x),
        _ => None,
    };
    if values.iter().all(|value| whole(value).is_some()) {
        Column::Whole(values.iter().map(whole).collect())
    } else if values.iter().all(|value| value.number().is_some()) {
        Column::Number(values.iter().map(|value| value.number()).collect())
    } else {
        Column::Text(values.iter().map(|value| Some(value.to_string())).collect())
    }
}

impl Results {
    /// The column of a name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, column)| column)
    }

    /// The number in a row of a column.
    #[must_use]
    pub fn number(&self, name: &str, row: usize) -> Option<f64> {
        match self.column(name)? {
            Column::Number(values) => values.get(row).copied().flatten(),
            Column::Whole(values) => values.get(row).copied().flatten().map(|x| x as f64),
            Column::Text(_) => None,
        }
    }

    /// Whether a run keeps a whole specification.
    pub(super) fn keeps(&self, limits: &[Limit], row: usize) -> bool {
        let holds = |limit: &Limit| limit.holds(self.number(&limit.figure, row));
        limits.iter().all(holds)
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }

    /// Writes CSV: a header row, numbers with every digit, empty cells where there is no value.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_csv(&self, sink: impl Write) -> Result<(), CoursesError> {
        let mut writer = csv::Writer::from_writer(sink);
        writer.write_record(self.columns.iter().map(|(name, _)| name))?;
        for row in 0..self.rows() {
            writer.write_record(self.columns.iter().map(|(_, column)| column.cell(row)))?;
        }
        writer.flush().map_err(csv::Error::from)?;
        Ok(())
    }

    /// Writes Parquet with the same columns.
    ///
    /// # Errors
    /// The writer's.
    #[cfg(feature = "parquet")]
    pub fn write_parquet(
        &self,
        sink: impl Write + Send,
    ) -> Result<(), pinwheel_courses::ParquetFault> {
        use pinwheel_courses::Cells;
        let cells = |column: &Column| match column {
            Column::Number(values) => Cells::Number(values.clone()),
            Column::Whole(values) => Cells::Whole(values.clone()),
            Column::Text(values) => Cells::Text(values.clone()),
        };
        let columns = self
            .columns
            .iter()
            .map(|(name, column)| (name.clone(), cells(column)));
        pinwheel_courses::write_table(sink, &columns.collect::<Vec<_>>())
    }
}

impl Column {
    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Number(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// True without any.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a row as text; empty where there is none.
    #[must_use]
    pub fn cell(&self, row: usize) -> String {
        let text = match self {
            Self::Number(values) => values.get(row).copied().flatten().map(|x| x.to_string()),
            Self::Whole(values) => values.get(row).copied().flatten().map(|x| x.to_string()),
            Self::Text(values) => values.get(row).cloned().flatten(),
        };
        text.unwrap_or_default()
    }
}
