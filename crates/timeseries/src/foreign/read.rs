//! Reading a foreign file: columns found, cells converted, bad rows named.

use std::collections::{HashMap, HashSet};
use std::io::{BufRead as _, BufReader, Read};

use super::error::{ForeignError, first_of, short};
use super::map::{BadRows, ColumnRef, FileFormat, Map};
use crate::{TimeSeries, units};

/// Bad rows kept with their reason; the others are counted as one.
const MOST_NAMED: usize = 1000;
/// Rows that must be left.
const FEWEST_ROWS: usize = 10;

/// Columns of ours that one of the file may feed: thousands would make a small file a large one in memory.
const MOST_USES: usize = 16;

/// Columns of a file without a header at most.
const MOST_COLUMNS: usize = 10_000;

/// Largest magnitude of a value in our units: squares and sums of such stay finite.
const LARGEST: f64 = 1e100;

/// What a foreign file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// The mapped columns on the file's own times, in our units.
    pub time_series: TimeSeries,
    /// Rows that were left out.
    pub bad: Vec<String>,
    /// Rows of data in the file.
    pub rows: usize,
}

/// One of our columns and where its value comes from.
struct Wanted {
    name: String,
    /// Indices of the file's columns; several give a magnitude.
    from: Vec<usize>,
    factor: f64,
    offset: f64,
}

/// Reads a file by its map.
///
/// # Errors
/// A column that is not there; bad rows, unless the map skips them; too few rows that can be read.
pub fn read(source: impl Read, map: &Map) -> Result<Foreign, ForeignError> {
    let mut lines = Lines::new(source, &map.file)?;
    let header = lines.header(&map.file)?;
    let time_column = header.find("time.column", &map.time.column)?;
    // The unit is known: the map was checked.
    let time_factor = map.time.factor * units::factor("time_s", &map.time.unit).unwrap_or(1.0);
    let wanted = wanted(map, &header)?;
    let decimal_comma = map.file.decimal == ",";

    let mut times: Vec<f64> = Vec::new();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
    let (mut bad, mut rows) = (Vec::new(), 0);
    let mut row_values = vec![0.0; wanted.len()];
    while let Some((line, cells)) = lines.next()? {
        rows += 1;
        let cell = |index: usize| -> Result<f64, String> {
            let text = cells.get(index).map(|text| text.trim()).unwrap_or_default();
            if text.is_empty() {
                return Err(format!("column `{}` is empty", short(&header.name(index))));
            }
            let number = if decimal_comma {
                text.replace(',', ".").parse()
            } else {
                text.parse()
            };
            match number {
                Ok(value) if f64::is_finite(value) => Ok(value),
                _ => Err(format!(
                    "column `{}`: `{}` is not a number",
                    short(&header.name(index)),
                    short(text)
                )),
            }
        };
        let mut one = || -> Result<f64, String> {
            let bounded = |name: &str, value: f64| {
                // NaN, too, is not within.
                if value.abs() <= LARGEST {
                    return Ok(value);
                }
                Err(format!("`{}` is too large: {value:e}", short(name)))
            };
            let time = cell(time_column)? * time_factor + map.time.offset_s.seconds();
            let time = bounded("time_s", time)?;
            if let Some(&before) = times.last()
                && !(time > before)
            {
                return Err(format!("time does not increase: {time} s after {before} s"));
            }
            for (slot, wanted) in row_values.iter_mut().zip(&wanted) {
                let value = match wanted.from.as_slice() {
                    [single] => cell(*single)?,
                    several => {
                        let mut squares = 0.0;
                        for &index in several {
                            squares += cell(index)?.powi(2);
                        }
                        squares.sqrt()
                    }
                };
                *slot = bounded(&wanted.name, value * wanted.factor + wanted.offset)?;
            }
            Ok(time)
        };
        match one() {
            Ok(time) => {
                times.push(time);
                for (column, value) in values.iter_mut().zip(&row_values) {
                    column.push(*value);
                }
            }
            Err(reason) => bad.push(format!("line {line}: {reason}")),
        }
    }
    if !bad.is_empty() && map.rows.bad == BadRows::Refuse {
        return Err(ForeignError(format!(
            "{} of {rows} rows are bad: {}; mend them, or write bad = \"skip\" under [rows] of the map to leave them out",
            bad.len(),
            first_of(&bad, 5, "; ")
        )));
    }
    if times.len() < FEWEST_ROWS || 2 * times.len() < rows {
        let first = bad.first();
        let first = first.map_or_else(String::new, |bad| format!("; the first bad one is {bad}"));
        let good = times.len();
        return Err(ForeignError(format!(
            "{good} of {rows} rows can be read, too few to compare{first}"
        )));
    }
    bad.truncate(MOST_NAMED);
    let mut time_series = TimeSeries::new(times).map_err(ForeignError::unreadable)?;
    for (wanted, column) in wanted.into_iter().zip(values) {
        time_series
            .push(wanted.name, column)
            .map_err(ForeignError::unreadable)?;
    }
    Ok(Foreign {
        time_series,
        bad,
        rows,
    })
}

/// Names of the file's columns.
struct Header {
    names: Vec<String>,
    /// Where each name stands first; empty without a header, where columns go by number only.
    places: HashMap<String, usize>,
}

impl Header {
    fn name(&self, index: usize) -> String {
        let name = self.names.get(index).cloned();
        name.unwrap_or_else(|| (index + 1).to_string())
    }

    fn find(&self, key: &str, column: &ColumnRef) -> Result<usize, ForeignError> {
        let found = match column {
            ColumnRef::Name(name) => self.places.get(name.trim()).copied(),
            ColumnRef::Number(number) => {
                let index = number.checked_sub(1);
                index.filter(|index| *index < self.names.len())
            }
        };
        found.ok_or_else(|| {
            let names = self.names.iter().map(|name| format!("`{}`", short(name)));
            let there = match names.collect::<Vec<_>>() {
                none if none.is_empty() => "none: check file.separator".to_owned(),
                names => first_of(&names, 12, ", "),
            };
            let column = match column {
                ColumnRef::Name(name) => name.clone(),
                ColumnRef::Number(number) => number.to_string(),
            };
            ForeignError(format!(
                "`{key}`: the file has no column `{column}`; it has {there}"
            ))
        })
    }
}

/// Our columns, `*` written out; a plain name wins over a pattern.
fn wanted(map: &Map, header: &Header) -> Result<Vec<Wanted>, ForeignError> {
    let mut list: Vec<Wanted> = Vec::new();
    let mut known: HashSet<String> = HashSet::new();
    let (patterns, plain): (Vec<_>, Vec<_>) =
        map.columns.iter().partition(|(name, _)| name.contains('*'));
    for (name, source) in plain.into_iter().chain(patterns) {
        let full = source.full();
        let unit = full.unit.as_ref();
        let unit = unit.map_or(1.0, |unit| units::factor(name, unit).unwrap_or(1.0));
        let mut add = |name: String, from: Vec<usize>| {
            if known.insert(name.clone()) {
                list.push(Wanted {
                    name,
                    from,
                    factor: full.factor * unit,
                    offset: full.offset,
                });
            }
        };
        if !name.contains('*') {
            let from = full.columns().map(|column| header.find(name, column));
            add(name.clone(), from.collect::<Result<_, _>>()?);
            continue;
        }
        for number in 0.. {
            let written = |column: &ColumnRef| match column {
                ColumnRef::Name(column) => {
                    ColumnRef::Name(column.replace('*', &(full.first + number).to_string()))
                }
                ColumnRef::Number(number) => ColumnRef::Number(*number),
            };
            let from = full
                .columns()
                .map(|column| header.find(name, &written(column)));
            match from.collect::<Result<_, _>>() {
                Ok(from) => add(name.replace('*', &number.to_string()), from),
                Err(error) if number == 0 => return Err(error),
                Err(_) => break,
            }
        }
    }
    let mut uses = vec![0; header.names.len()];
    for wanted in &list {
        for &index in &wanted.from {
            uses[index] += 1;
            if uses[index] > MOST_USES {
                return Err(ForeignError(format!(
                    "`{}`: column `{}` feeds more than {MOST_USES} columns; map it once",
                    wanted.name,
                    short(&header.name(index))
                )));
            }
        }
    }
    Ok(list)
}

/// Rows of cells with their line numbers.
struct Lines<R> {
    reader: csv::Reader<BufReader<R>>,
    record: csv::ByteRecord,
    /// Lines before the reader's first.
    skipped: usize,
    /// Any number of blanks stands between cells; comments may be indented then.
    blanks: bool,
    comment: Option<u8>,
}

impl<R: Read> Lines<R> {
    fn new(source: R, format: &FileFormat) -> Result<Self, ForeignError> {
        let mut source = BufReader::new(source);
        for _ in 0..format.skip_lines {
            source.skip_until(b'\n').map_err(ForeignError::unreadable)?;
        }
        let comment = format.comment.as_ref().and_then(|text| text.bytes().next());
        let separator = format.separator_byte();
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(separator.unwrap_or(b' '))
            .quoting(separator.is_some())
            .comment(comment)
            .from_reader(source);
        Ok(Self {
            reader,
            record: csv::ByteRecord::new(),
            skipped: format.skip_lines,
            blanks: separator.is_none(),
            comment,
        })
    }

    /// The next row that is not empty.
    fn next(&mut self) -> Result<Option<(usize, Vec<String>)>, ForeignError> {
        let unreadable = ForeignError::unreadable;
        while (self.reader.read_byte_record(&mut self.record)).map_err(unreadable)? {
            let mut cells = Vec::new();
            for cell in &self.record {
                // Old exports are Latin-1: names and units may hold what is no UTF-8.
                let cell = String::from_utf8_lossy(cell);
                if self.blanks {
                    cells.extend(cell.split_whitespace().map(str::to_owned));
                } else {
                    cells.push(cell.into_owned());
                }
            }
            let first = cells.first().and_then(|cell| cell.bytes().next());
            let is_comment = self.blanks && first.is_some() && first == self.comment;
            if !cells.is_empty() && !is_comment {
                let line = self.record.position().map_or(0, csv::Position::line);
                return Ok(Some((line as usize + self.skipped, cells)));
            }
        }
        Ok(None)
    }

    fn header(&mut self, format: &FileFormat) -> Result<Header, ForeignError> {
        if !format.header {
            return Ok(Header {
                names: (1..=MOST_COLUMNS)
                    .map(|number| number.to_string())
                    .collect(),
                places: HashMap::new(),
            });
        }
        let (_, cells) = self.next()?.unwrap_or_default();
        for _ in 0..format.lines_after_header {
            self.next()?;
        }
        let clean = |name: &String| {
            let name = name.trim().trim_start_matches('\u{feff}');
            name.trim_matches('"').trim().to_owned()
        };
        let names: Vec<String> = cells.iter().map(clean).collect();
        let mut places = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            places.entry(name.clone()).or_insert(index);
        }
        Ok(Header { names, places })
    }
}
