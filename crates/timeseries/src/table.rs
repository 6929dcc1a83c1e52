//! Tables: one definition for files, pages and terminals.
//!
//! A column has a name for files and a label for people. Files omit a column without a name, displays one without a label.
//!
//! ```
//! use pinwheel_timeseries::table::{Mark, Shown, Table};
//!
//! let runs = [("native", Some(1.4529), 120), ("rapier", None, 60_000)];
//! let table = Table::of("Driver torque", runs)
//!     .text("engine", "Engine", |run| run.0)
//!     .number("mean_input_torque_n_m", "Mean torque", |run| run.1)
//!     .unit("N m")
//!     .uncertain(|_| Some(0.003))
//!     .marked(|run| Mark::bad(run.1.is_none()))
//!     .integers("steps", "Steps", |run| Some(run.2))
//!     .done();
//!
//! let mut csv = Vec::new();
//! table.write_csv(&mut csv)?;
//! assert_eq!(
//!     String::from_utf8_lossy(&csv),
//!     "engine,mean_input_torque_n_m,steps\nnative,1.4529,120\nrapier,,60000\n"
//! );
//! # Ok::<(), pinwheel_timeseries::TimeSeriesError>(())
//! ```

use std::io::Write;

use serde::{Serialize, Serializer};

use crate::figure::definitions::DIGITS;
use crate::{TimeSeries, TimeSeriesError, digits};

/// Number of bytes of CSV that are passed on at a time.
const BLOCK: usize = 1 << 16;

/// Columns of the same length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Sentence that describes the table.
    pub caption: String,
    /// Columns, left to right; for people the first one names the row.
    pub columns: Vec<Column>,
}

/// Column of a [`Table`]. The lists beside the values have their length, or are empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Name in files, with the unit at its end; empty to omit the column.
    pub name: String,
    /// Heading for people, without the unit; empty to omit the column.
    pub label: String,
    /// Unit for people, e.g. `N m`; may be empty.
    pub unit: String,
    /// Values; each may be missing.
    pub values: Values,
    /// Uncertainty of each value, in the values' unit, which limits the digits shown.
    pub uncertainty: Vec<Option<f64>>,
    /// Format of numbers.
    pub shown: Shown,
    /// Text for people instead of the value.
    pub display: Vec<Option<String>>,
    /// Mark of each cell.
    pub marks: Vec<Mark>,
    /// Shade of each cell's background from 0 (none) to 1 (full).
    pub shades: Vec<Option<f64>>,
    /// Anchors on the page with details of a cell.
    pub links: Vec<Option<String>>,
    /// Colour and dash of each row's line in charts.
    pub colours: Vec<Option<usize>>,
}

/// Values of one column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers.
    Number(Vec<Option<f64>>),
    /// Integers.
    Integers(Vec<Option<i64>>),
    /// Words.
    Text(Vec<Option<String>>),
}

impl Default for Values {
    fn default() -> Self {
        Self::Text(Vec::new())
    }
}

/// Format of a number without uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Number of significant digits.
    Digits(u8),
    /// Number of decimals.
    Decimals(u8),
    /// Share of one: per cent with two digits, small shares as a power of ten.
    Relative,
    /// Share of one in per cent with two decimals.
    Percent,
    /// Time in s, with a prefix.
    Seconds,
    /// Length in m, with a prefix.
    Metres,
    /// Setting with its original digits.
    Setting,
}

impl Default for Shown {
    fn default() -> Self {
        Self::Digits(5)
    }
}

/// Mark of a cell: a sign and a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    /// No mark.
    #[default]
    None,
    /// Satisfied.
    Good,
    /// Violated.
    Bad,
    /// Warning.
    Warn,
    /// Less prominent.
    Muted,
}

impl Mark {
    /// [`Mark::Good`] or [`Mark::Bad`].
    pub fn of(good: bool) -> Self {
        if good { Self::Good } else { Self::Bad }
    }

    /// [`Mark::Good`] or [`Mark::Warn`].
    pub fn good(good: bool) -> Self {
        if good { Self::Good } else { Self::Warn }
    }

    /// [`Mark::Bad`] or no mark.
    pub fn bad(bad: bool) -> Self {
        if bad { Self::Bad } else { Self::None }
    }

    /// [`Mark::Warn`] or no mark.
    pub fn warn(warn: bool) -> Self {
        if warn { Self::Warn } else { Self::None }
    }
}

/// Builder of a table: [`text`](Self::text), [`number`](Self::number) and [`integers`](Self::integers) add a column, all other calls
/// change the last one.
#[must_use]
#[derive(Debug)]
pub struct TableOf<R> {
    rows: Vec<R>,
    table: Table,
}

impl Table {
    /// Begins a table with a row for each of `rows`.
    pub fn of<R>(caption: impl Into<String>, rows: impl IntoIterator<Item = R>) -> TableOf<R> {
        TableOf {
            rows: rows.into_iter().collect(),
            table: Self {
                caption: caption.into(),
                columns: Vec::new(),
            },
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the column with the name `name`.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Returns the number in a row of the column `name`.
    pub fn number(&self, name: &str, row: usize) -> Option<f64> {
        self.column(name)?.values.number(row)
    }

    /// Returns the table of the rows that `keep` selects by their number.
    #[must_use]
    pub fn rows(mut self, keep: impl Fn(usize) -> bool) -> Self {
        fn pick<T: Clone>(list: &mut Vec<T>, keep: &impl Fn(usize) -> bool) {
            let mut row = 0..;
            list.retain(|_| row.next().is_some_and(keep));
        }
        for column in &mut self.columns {
            match &mut column.values {
                Values::Number(values) => pick(values, &keep),
                Values::Integers(values) => pick(values, &keep),
                Values::Text(values) => pick(values, &keep),
            }
            pick(&mut column.uncertainty, &keep);
            pick(&mut column.display, &keep);
            pick(&mut column.marks, &keep);
            pick(&mut column.shades, &keep);
            pick(&mut column.links, &keep);
            pick(&mut column.colours, &keep);
        }
        self
    }

    /// Returns a table of the columns `names`, in that order; names without a column are skipped.
    pub fn only(&self, names: &[&str]) -> Self {
        let columns = names.iter().filter_map(|name| self.column(name).cloned());
        Self {
            caption: self.caption.clone(),
            columns: columns.collect(),
        }
    }

    /// Returns the table without its empty columns.
    #[must_use]
    pub fn without_empty(mut self) -> Self {
        self.columns.retain(|column| {
            let values = &column.values;
            (0..values.len()).any(|row| !values.text(row).is_empty())
        });
        self
    }

    /// Columns that are written to files.
    pub(crate) fn named(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().filter(|column| !column.name.is_empty())
    }

    /// Writes CSV: a header row, `.` decimals, numbers that read back bit for bit, empty cells for missing values.
    ///
    /// # Errors
    /// Error of the writer.
    pub fn write_csv(&self, sink: impl Write) -> Result<(), TimeSeriesError> {
        let columns: Vec<&Column> = self.named().collect();
        let names = columns.iter().map(|column| column.name.as_str());
        let cells = |row: usize| columns.iter().map(move |column| column.values.cell(row));
        write_rows(sink, names, (0..self.len()).map(cells))
    }
}

/// Writes the CSV of rows of cells under a header of names.
pub(crate) fn write_rows<'a>(
    mut sink: impl Write,
    names: impl Iterator<Item = &'a str>,
    rows: impl Iterator<Item = impl Iterator<Item = Cell<'a>>>,
) -> Result<(), TimeSeriesError> {
    let mut text = Vec::with_capacity(2 * BLOCK);
    write_row(&mut text, names.map(Cell::Text));
    for cells in rows {
        write_row(&mut text, cells);
        if text.len() > BLOCK {
            sink.write_all(&text).map_err(csv::Error::from)?;
            text.clear();
        }
    }
    sink.write_all(&text).map_err(csv::Error::from)?;
    Ok(sink.flush().map_err(csv::Error::from)?)
}

/// Appends a row of CSV.
#[inline(always)]
fn write_row<'a>(text: &mut Vec<u8>, cells: impl Iterator<Item = Cell<'a>>) {
    let begin = text.len();
    for cell in cells {
        match cell {
            // A pin without contact.
            Cell::Number(value) if value.to_bits() == 0 => text.push(b'0'),
            Cell::Number(value) => digits::append(text, value),
            Cell::Integer(value) => text.extend_from_slice(value.to_string().as_bytes()),
            Cell::Text(words) if words.contains([',', '"', '\n', '\r']) => {
                let words = words.replace('"', "\"\"");
                text.extend_from_slice(format!("\"{words}\"").as_bytes());
            }
            Cell::Text(words) => text.extend_from_slice(words.as_bytes()),
            Cell::Empty => {}
        }
        text.push(b',');
    }
    // A row of one empty cell is no empty line.
    if text.len() < begin + 2 {
        text.truncate(begin);
        text.extend_from_slice(b"\"\",");
    }
    if let Some(last) = text.last_mut() {
        *last = b'\n';
    }
}

impl Column {
    /// Makes a column of numbers for files; values that are not finite are missing.
    pub fn numbers(name: impl Into<String>, values: &[f64]) -> Self {
        let number = |value: &f64| Some(*value).filter(|value| value.is_finite());
        Self {
            name: name.into(),
            values: Values::Number(values.iter().map(number).collect()),
            ..Self::default()
        }
    }
}

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Number(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// True without values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number in a row; `None` for words.
    pub fn number(&self, row: usize) -> Option<f64> {
        match self.cell(row) {
            Cell::Number(value) => Some(value),
            Cell::Integer(value) => Some(value as f64),
            Cell::Text(_) | Cell::Empty => None,
        }
    }

    /// Returns the words in a row; `None` for numbers.
    pub fn words(&self, row: usize) -> Option<&str> {
        match self.cell(row) {
            Cell::Text(words) => Some(words),
            _ => None,
        }
    }

    /// Returns the value in a row with every digit; empty if missing.
    pub fn text(&self, row: usize) -> String {
        match self.cell(row) {
            Cell::Number(value) => value.to_string(),
            Cell::Integer(value) => value.to_string(),
            Cell::Text(words) => words.to_owned(),
            Cell::Empty => String::new(),
        }
    }

    fn cell(&self, row: usize) -> Cell<'_> {
        let cell = match self {
            Self::Number(values) => values.get(row).copied().flatten().map(Cell::Number),
            Self::Integers(values) => values.get(row).copied().flatten().map(Cell::Integer),
            Self::Text(values) => values.get(row).and_then(Option::as_deref).map(Cell::Text),
        };
        cell.unwrap_or(Cell::Empty)
    }

    /// True if the values are numbers.
    pub fn is_numeric(&self) -> bool {
        !matches!(self, Self::Text(_))
    }
}

impl<R> TableOf<R> {
    /// Adds a column of words; empty ones are missing.
    pub fn text<W: Into<String>>(self, name: &str, label: &str, of: impl Fn(&R) -> W) -> Self {
        let words = |row| Some(of(row).into()).filter(|words: &String| !words.is_empty());
        let values = self.rows.iter().map(words).collect();
        self.column(name, label, Values::Text(values))
    }

    /// Adds a column of numbers; values that are not finite are missing.
    pub fn number<V: Into<Option<f64>>>(
        self,
        name: &str,
        label: &str,
        of: impl Fn(&R) -> V,
    ) -> Self {
        let number = |row| of(row).into().filter(|value: &f64| value.is_finite());
        let values = self.rows.iter().map(number).collect();
        self.column(name, label, Values::Number(values))
    }

    /// Adds a column of a design's numbers, for people only, with the digits of a data sheet.
    pub fn figure<V: Into<Option<f64>>>(
        self,
        label: &str,
        unit: &str,
        of: impl Fn(&R) -> V,
    ) -> Self {
        let column = self.number("", label, of).unit(unit);
        column.shown(Shown::Digits(DIGITS))
    }

    /// Adds a column of integers.
    pub fn integers<V: TryInto<i64>>(
        self,
        name: &str,
        label: &str,
        of: impl Fn(&R) -> Option<V>,
    ) -> Self {
        let integers = |row| of(row).and_then(|value| value.try_into().ok());
        let values = self.rows.iter().map(integers).collect();
        self.column(name, label, Values::Integers(values))
    }

    /// Adds a column of existing values.
    pub fn column(mut self, name: &str, label: &str, values: Values) -> Self {
        self.table.columns.push(Column {
            name: name.to_owned(),
            label: label.to_owned(),
            values,
            ..Column::default()
        });
        self
    }

    /// Sets the unit of the last column, for people.
    pub fn unit(self, unit: &str) -> Self {
        self.last(|_, column| unit.clone_into(&mut column.unit))
    }

    /// Sets the format of numbers of the last column.
    pub fn shown(self, shown: Shown) -> Self {
        self.last(|_, column| column.shown = shown)
    }

    /// Sets the uncertainty of values of the last column.
    pub fn uncertain(self, of: impl Fn(&R) -> Option<f64>) -> Self {
        self.last(|rows, column| column.uncertainty = rows.iter().map(of).collect())
    }

    /// Sets the texts that replace values of the last column for people; `None` keeps the value.
    pub fn display<W: Into<Option<String>>>(self, of: impl Fn(&R) -> W) -> Self {
        self.last(|rows, column| column.display = rows.iter().map(|row| of(row).into()).collect())
    }

    /// Sets the marks of cells of the last column.
    pub fn marked(self, of: impl Fn(&R) -> Mark) -> Self {
        self.last(|rows, column| column.marks = rows.iter().map(of).collect())
    }

    /// Sets the shades of cells of the last column, from 0 to 1.
    pub fn shaded(self, of: impl Fn(&R) -> Option<f64>) -> Self {
        self.last(|rows, column| column.shades = rows.iter().map(of).collect())
    }

    /// Sets the places on the page to which cells of the last column link.
    pub fn linked(self, of: impl Fn(&R) -> Option<String>) -> Self {
        self.last(|rows, column| column.links = rows.iter().map(of).collect())
    }

    /// Sets the colour and dash in charts for cells of the last column.
    pub fn coloured(self, of: impl Fn(&R) -> Option<usize>) -> Self {
        self.last(|rows, column| column.colours = rows.iter().map(of).collect())
    }

    fn last(mut self, change: impl FnOnce(&[R], &mut Column)) -> Self {
        if let Some(column) = self.table.columns.last_mut() {
            change(&self.rows, column);
        }
        self
    }

    /// Returns the table with the columns added so far.
    pub fn so_far(&self) -> &Table {
        &self.table
    }

    /// Returns the table.
    pub fn done(self) -> Table {
        self.table
    }
}

/// `time_s` and all channels.
impl From<&TimeSeries> for Table {
    fn from(time_series: &TimeSeries) -> Self {
        let column = |name: &str, values: &[f64]| Column {
            name: name.to_owned(),
            values: Values::Number(values.iter().copied().map(Some).collect()),
            ..Column::default()
        };
        let channels = time_series.channels().iter();
        let channels = channels.map(|channel| column(&channel.name, &channel.values));
        Self {
            caption: String::new(),
            columns: std::iter::once(column("time_s", time_series.time_s()))
                .chain(channels)
                .collect(),
        }
    }
}

/// List of rows, each with its values by column name, null if missing.
impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq((0..self.len()).map(|row| Row { table: self, row }))
    }
}

struct Row<'a> {
    table: &'a Table,
    row: usize,
}

impl Serialize for Row<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let cells = self.table.named();
        serializer.collect_map(cells.map(|column| (&column.name, column.values.cell(self.row))))
    }
}

/// Value of a cell.
#[derive(Serialize)]
#[serde(untagged)]
pub(crate) enum Cell<'a> {
    Number(f64),
    Integer(i64),
    Text(&'a str),
    Empty,
}
