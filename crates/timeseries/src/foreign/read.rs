//! Reading of a foreign file: columns by the map, cells converted, bad rows named.

use std::collections::HashSet;
use std::io::Read;

use super::cells::{clock, number};
use super::error::{ForeignError, first_of, short};
use super::lines::{Header, Lines};
use super::map::{BadRows, ColumnRef, Map, Twice, Unwrap};
use crate::{TimeSeries, columns, group_of, units};

/// Largest number of bad rows listed with their reason.
const MOST_NAMED: usize = 1000;
/// Smallest number of good rows.
const FEWEST_ROWS: usize = 10;

/// Largest number of Pinwheel's columns from one column of the file, so that a small file needs no large memory.
const MOST_USES: usize = 16;

/// Largest magnitude of a value in Pinwheel's units, whose squares and sums stay finite.
const LARGEST: f64 = 1e100;

/// Spacing, as a share of the mean, below which two times are equal: so steep a step cannot be interpolated.
const ONE_INSTANT: f64 = 1e-6;

/// Largest negative value of a force magnitude, as a share of its largest value: noise and drift of load cells.
const BELOW_ZERO: f64 = 0.05;

/// Content of a foreign file.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// Mapped columns on the file's own times, in Pinwheel's units.
    pub time_series: TimeSeries,
    /// Rows that were left out.
    pub bad: Vec<String>,
    /// Rows of data in the file.
    pub rows: usize,
    /// Number of repeated times, and the first of them, s.
    pub twice: Option<(usize, f64)>,
}

/// Column of Pinwheel with the source of its values in the file.
struct Wanted {
    name: String,
    /// Columns of the file; several for a magnitude or a sum.
    from: Vec<Term>,
    is_magnitude: bool,
    factor: f64,
    offset: f64,
    /// One turn in the file's numbers, for an angle.
    turn: Option<f64>,
    unwrap: bool,
}

/// Column of the file with its weight in a sum, last value and last change.
struct Term {
    index: usize,
    weight: f64,
    last: f64,
    step: f64,
}

impl Wanted {
    /// Returns the value from the numbers `cell` of a row; calls `wraps` with the column if an angle restarts.
    fn value(
        &mut self,
        cell: impl Fn(usize) -> Result<f64, String>,
        mut wraps: impl FnMut(&str, usize, [f64; 2]),
    ) -> Result<f64, String> {
        let (mut sum, mut squares) = (0.0, 0.0);
        for term in &mut self.from {
            let mut value = cell(term.index)?;
            if let Some(turn) = self.turn {
                let step = value - term.last;
                if self.unwrap && step.is_finite() {
                    value -= turn * (step / turn).round();
                } else if step.abs() > 0.5 * turn && step * term.step < 0.0 {
                    wraps(&self.name, term.index, [term.last, value]);
                }
                (term.step, term.last) = (value - term.last, value);
            }
            sum += term.weight * value;
            squares += value * value;
        }
        let value = if self.is_magnitude {
            squares.sqrt()
        } else {
            sum
        };
        within(&self.name, value * self.factor + self.offset)
    }
}

fn within(name: &str, value: f64) -> Result<f64, String> {
    // NaN fails the comparison, too.
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(format!("`{}` is too large: {value:e}", short(name)))
}

/// Reads a file by its map.
///
/// # Errors
/// A missing or repeated column; bad rows, unless the map skips them; too few good rows; values that are no angle, force or
/// time.
pub fn read<'a>(source: impl Read + 'a, map: &Map) -> Result<Foreign, ForeignError> {
    let mut lines = Lines::new(source, &map.file)?;
    let header = lines.header(&map.file)?;
    let time_column = header.place("time.column", &map.time.column)?;
    // The unit is known, because the map was checked.
    let time_unit = units::factor("time_s", &map.time.unit).unwrap_or(1.0);
    let mut wanted = wanted(map, &header)?;
    let is_name = |column: &ColumnRef| matches!(column, ColumnRef::Name(_));
    let sources = map.columns.values().flat_map(|s| s.full().columns());
    // No cell can be empty between blanks: a missing one shifts all that follow.
    let exact = lines.blanks
        && (is_name(&map.time.column) || sources.into_iter().any(|(column, _)| is_name(&column)));
    let (mut last_clock, mut midnights) = (0.0, 0.0);
    let mut wrapped: Option<String> = None;

    let mut times: Vec<f64> = Vec::new();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
    let (mut bad, mut rows, mut falls) = (Vec::new(), 0, 0);
    let mut row_values = vec![0.0; wanted.len()];
    while let Some((line, cells)) = lines.next()? {
        rows += 1;
        let text = |index: usize| -> Result<&str, String> {
            let text = cells.get(index).map(|text| text.trim()).unwrap_or_default();
            if text.is_empty() {
                return Err(format!("column `{}` is empty", short(&header.name(index))));
            }
            Ok(text)
        };
        let named =
            |index: usize, what: String| format!("column `{}`: {what}", short(&header.name(index)));
        let cell = |index: usize| -> Result<f64, String> {
            number(text(index)?, &map.file).map_err(|what| named(index, what))
        };
        let mut one = || -> Result<f64, String> {
            let filled = cells.iter().rposition(|cell| !cell.trim().is_empty());
            let count = filled.map_or(0, |last| last + 1);
            let width = header.names.len();
            if count > width || exact && count < width {
                return Err(format!("{count} cells, but the header has {width}"));
            }
            let time = match clock(text(time_column)?) {
                Some(_) if time_unit != 1.0 => {
                    let what = "a clock time: leave time.unit out of the map".to_owned();
                    return Err(named(time_column, what));
                }
                Some(seconds) => {
                    // The clock fell by most of a day: midnight.
                    midnights += f64::from(u8::from(seconds < last_clock - 43_200.0));
                    last_clock = seconds;
                    86_400.0 * midnights + seconds
                }
                None => cell(time_column)?,
            };
            let time = time * time_unit * map.time.factor + map.time.offset_s.seconds();
            let time = within("time_s", time)?;
            if let Some(&before) = times.last()
                && time < before
            {
                falls += 1;
                return Err(format!("time falls from {before} to {time} s"));
            }
            for (slot, wanted) in row_values.iter_mut().zip(&mut wanted) {
                *slot = wanted.value(cell, |name, index, [from, to]| {
                    wrapped.get_or_insert_with(|| {
                        let column = short(&header.name(index));
                        format!(
                            "line {line}: column `{column}` goes from {from} to {to}, as an angle that begins anew after each \
                             turn; write unwrap = true for `{name}` in the map"
                        )
                    });
                })?;
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
    if 2 * falls > rows {
        return Err(ForeignError(format!(
            "time falls in {falls} of {rows} rows; sort them by time, or for an angle that falls write a time.factor below 0"
        )));
    }
    if !bad.is_empty() && map.rows.bad == BadRows::Refuse {
        return Err(ForeignError(format!(
            "{} of {rows} rows are bad: {}; correct them, or write bad = \"skip\" under [rows] of the map to leave them out",
            bad.len(),
            first_of(&bad, 5, "; ")
        )));
    }
    if let Some(wrapped) = wrapped {
        return Err(ForeignError(wrapped));
    }
    let good = times.len();
    let twice = once(&mut times, &mut values, map.rows.twice);
    if let Some((count, first)) = twice
        && map.rows.twice == Twice::Refuse
    {
        return Err(ForeignError(format!(
            "{count} instants are written more than once, the first {first} s; write twice = \"last\" or \"first\" under [rows] of \
             the map to take that row of each"
        )));
    }
    if times.len() < FEWEST_ROWS || 2 * good < rows {
        let first = bad.first();
        let first = first.map_or_else(String::new, |bad| format!("; the first bad one is {bad}"));
        let left = times.len();
        return Err(ForeignError(format!(
            "{left} of {rows} rows can be read, too few to compare{first}"
        )));
    }
    if good > 2 * times.len() {
        return Err(ForeignError(format!(
            "{good} rows have only {} instants; write the time with more digits",
            times.len()
        )));
    }
    bad.truncate(MOST_NAMED);
    let mut time_series = TimeSeries::new(times).map_err(ForeignError::unreadable)?;
    for (wanted, column) in wanted.into_iter().zip(values) {
        let lowest = column.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = column.iter().copied().fold(0.0, f64::max);
        let magnitude = [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE];
        if magnitude.contains(&group_of(&wanted.name).0) && -lowest > BELOW_ZERO * highest {
            return Err(ForeignError(format!(
                "`{}` goes down to {lowest} N, but is the magnitude of a force; write factor = -1.0, or magnitude_of with its \
                 components",
                wanted.name
            )));
        }
        time_series
            .push(wanted.name, column)
            .map_err(ForeignError::unreadable)?;
    }
    Ok(Foreign {
        time_series,
        bad,
        rows,
        twice,
    })
}

/// Keeps one row of each time. Returns the number of repeated times and the first of them, s.
fn once(times: &mut Vec<f64>, values: &mut [Vec<f64>], twice: Twice) -> Option<(usize, f64)> {
    let (first, last) = (*times.first()?, *times.last()?);
    let near = ONE_INSTANT * (last - first) / (times.len() - 1).max(1) as f64;
    let mut kept: Vec<usize> = Vec::with_capacity(times.len());
    let (mut began, mut repeated): (f64, Vec<f64>) = (f64::NEG_INFINITY, Vec::new());
    for (row, &time) in times.iter().enumerate() {
        if time - began > near {
            began = time;
            kept.push(row);
            continue;
        }
        if repeated.last() != Some(&began) {
            repeated.push(began);
        }
        if twice == Twice::Last
            && let Some(last) = kept.last_mut()
        {
            *last = row;
        }
    }
    let first = *repeated.first()?;
    for column in values.iter_mut().chain([times]) {
        *column = kept.iter().map(|&row| column[row]).collect();
    }
    Some((repeated.len(), first))
}

/// Returns Pinwheel's columns with each `*` expanded; a plain name takes precedence over a pattern.
fn wanted(map: &Map, header: &Header) -> Result<Vec<Wanted>, ForeignError> {
    let mut list: Vec<Wanted> = Vec::new();
    let mut known: HashSet<String> = HashSet::new();
    let (patterns, plain): (Vec<_>, Vec<_>) =
        map.columns.iter().partition(|(name, _)| name.contains('*'));
    for (name, source) in plain.into_iter().chain(patterns) {
        let full = source.full();
        let unit = full.unit.as_ref();
        let unit = unit.map(|unit| units::factor(name, unit).unwrap_or(1.0));
        // One turn in the file's numbers: a factor beside a unit is a gear ratio, without a unit it is the unit.
        let turn = units::turn(name).map(|turn| turn / unit.unwrap_or(full.factor.abs()));
        let (turn, unwrap) = match full.unwrap {
            Unwrap::Turn(unwrap) => (turn, unwrap),
            Unwrap::After(period) => (Some(period), true),
        };
        let columns = full.columns();
        let terms = |places: Vec<usize>| {
            let each = places.into_iter().zip(&columns);
            let term = |(index, (_, weight)): (usize, &(ColumnRef, f64))| Term {
                index,
                weight: *weight,
                last: f64::NAN,
                step: f64::NAN,
            };
            each.map(term).collect()
        };
        let mut add = |name: String, from: Vec<usize>| {
            if known.insert(name.clone()) {
                list.push(Wanted {
                    name,
                    from: terms(from),
                    is_magnitude: !full.magnitude_of.is_empty(),
                    factor: full.factor * unit.unwrap_or(1.0),
                    offset: full.offset,
                    turn,
                    unwrap,
                });
            }
        };
        if !name.contains('*') {
            let from = columns.iter();
            let from = from.map(|(column, _)| header.place(name, column));
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
            let mut from = Vec::new();
            for (column, _) in &columns {
                let column = written(column);
                if number == 0 {
                    header.place(name, &column)?;
                }
                if let Some(place) = header.find(name, &column)? {
                    from.push(place);
                    continue;
                }
                let numbers = full.first..full.first + number;
                let mut patterns = columns.iter();
                if let Some(other) = patterns.find_map(|(p, _)| header.outside(p, &numbers)) {
                    return Err(ForeignError(format!(
                        "`{name}`: the file has no column `{column}`, but `{}`; set `first`, or map each by its own name",
                        short(other)
                    )));
                }
            }
            if from.len() < columns.len() {
                break;
            }
            add(name.replace('*', &number.to_string()), from);
        }
    }
    let mut uses = vec![0; header.names.len()];
    for wanted in &list {
        for &Term { index, .. } in &wanted.from {
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
