//! Reading a foreign file: columns found, cells converted, bad rows named.

use std::collections::HashSet;
use std::io::Read;

use super::cells::{clock, number};
use super::error::{ForeignError, first_of, short};
use super::lines::{Header, Lines};
use super::map::{BadRows, ColumnRef, Map, Twice, Unwrap};
use crate::{TimeSeries, columns, group_of, units};

/// Bad rows kept with their reason; the others are counted as one.
const MOST_NAMED: usize = 1000;
/// Rows that must be left.
const FEWEST_ROWS: usize = 10;

/// Columns of ours that one of the file may feed: thousands would make a small file a large one in memory.
const MOST_USES: usize = 16;

/// Largest magnitude of a value in our units: squares and sums of such stay finite.
const LARGEST: f64 = 1e100;

/// Instants nearer to each other than this share of the mean spacing are one: at so steep a step nothing can be interpolated.
const ONE_INSTANT: f64 = 1e-6;

/// A magnitude of a force may go below 0 by this share of its largest value, as cells do by noise and drift.
const BELOW_ZERO: f64 = 0.05;

/// Content of a foreign file.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// The mapped columns on the file's own times, in our units.
    pub time_series: TimeSeries,
    /// Rows that were left out.
    pub bad: Vec<String>,
    /// Rows of data in the file.
    pub rows: usize,
    /// Instants that are written more than once, and the first of them, s.
    pub twice: Option<(usize, f64)>,
}

/// One of our columns and where its value comes from.
struct Wanted {
    name: String,
    /// The file's columns; several give a magnitude or a sum.
    from: Vec<Term>,
    is_magnitude: bool,
    factor: f64,
    offset: f64,
    /// A turn in the file's numbers, if it is an angle.
    turn: Option<f64>,
    unwrap: bool,
}

/// A column of the file, its number in a sum, and what it was in the last rows.
struct Term {
    index: usize,
    weight: f64,
    last: f64,
    step: f64,
}

impl Wanted {
    /// Returns its value in a row of which `cell` gives the numbers; `wraps` is called with the column where an angle begins anew.
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
    // NaN, too, is not within.
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(format!("`{}` is too large: {value:e}", short(name)))
}

/// Reads a file by its map.
///
/// # Errors
/// A column that is not there, or there twice; bad rows, unless the map skips them; too few rows that can be read; what is no
/// angle, force or time as it stands.
pub fn read<'a>(source: impl Read + 'a, map: &Map) -> Result<Foreign, ForeignError> {
    let mut lines = Lines::new(source, &map.file)?;
    let header = lines.header(&map.file)?;
    let time_column = header.place("time.column", &map.time.column)?;
    // The unit is known: the map was checked.
    let time_unit = units::factor("time_s", &map.time.unit).unwrap_or(1.0);
    let mut wanted = wanted(map, &header)?;
    let is_name = |column: &ColumnRef| matches!(column, ColumnRef::Name(_));
    let sources = map.columns.values().flat_map(|s| s.full().columns());
    // Between blanks no cell can be empty: with one too few, all that follow are another column's.
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
                    // It fell by most of a day: midnight has passed.
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
            "{} of {rows} rows are bad: {}; mend them, or write bad = \"skip\" under [rows] of the map to leave them out",
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

/// Keeps one row of each instant: how many were written more than once, and the first of them.
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

/// Our columns, `*` written out; a plain name wins over a pattern.
fn wanted(map: &Map, header: &Header) -> Result<Vec<Wanted>, ForeignError> {
    let mut list: Vec<Wanted> = Vec::new();
    let mut known: HashSet<String> = HashSet::new();
    let (patterns, plain): (Vec<_>, Vec<_>) =
        map.columns.iter().partition(|(name, _)| name.contains('*'));
    for (name, source) in plain.into_iter().chain(patterns) {
        let full = source.full();
        let unit = full.unit.as_ref();
        let unit = unit.map(|unit| units::factor(name, unit).unwrap_or(1.0));
        // A turn in the file's numbers: a factor beside a unit is a ratio of gears, without one it is the unit.
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

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 40;

    /// Rows of a time each 0.1 ms and further cells, after a header.
    fn rows(header: &str, row: impl Fn(usize) -> String) -> String {
        let rows: Vec<String> = (0..ROWS).map(row).collect();
        format!("{header}\n{}\n", rows.join("\n"))
    }

    fn time(k: usize) -> String {
        format!("{:.4}", 1e-4 * k as f64)
    }

    fn found(map: &str, text: impl AsRef<[u8]>) -> Result<Foreign, String> {
        let map = Map::from_toml(map, "m.toml").unwrap();
        read(text.as_ref(), &map).map_err(|error| error.to_string())
    }

    const TORQUE: &str = "[columns]\ninput_torque_n_m = \"T\"\n";
    const ANGLE: &str =
        "[columns]\noutput_angle_rad = { column = \"A\", unit = \"deg\", unwrap = true }\n";

    /// Each text says that the value of row k is k/8 at k/10000 s.
    #[test]
    fn regress_writers_of_all_kinds_are_read() {
        let value = |k: usize| k as f64 / 8.0;
        let comma = |x: f64| format!("{x:.3}").replace('.', ",");
        let german = "[file]\nseparator = \";\"\ndecimal = \",\"\n";
        let plain = rows("time_s,T", |k| format!("{},{}", time(k), value(k)));
        let wide = |little: bool, text: &str| -> Vec<u8> {
            let bytes = |unit: u16| {
                if little {
                    unit.to_le_bytes()
                } else {
                    unit.to_be_bytes()
                }
            };
            text.encode_utf16().flat_map(bytes).collect()
        };
        let marked = format!("\u{feff}{plain}");
        let texts: Vec<(String, Vec<u8>)> = vec![
            (TORQUE.to_owned(), plain.clone().into_bytes()),
            (TORQUE.to_owned(), marked.clone().into_bytes()),
            (TORQUE.to_owned(), wide(true, &marked)),
            (TORQUE.to_owned(), wide(false, &marked)),
            (TORQUE.to_owned(), wide(true, &plain.replace('\n', "\r\n"))),
            (
                format!("{german}{TORQUE}"),
                rows("time_s;T", |k| format!("{};{}", time(k).replace('.', ","), comma(value(k)))).into_bytes(),
            ),
            // Fortran.
            (
                format!("[file]\nseparator = \"space\"\n{TORQUE}"),
                rows(" time_s  T", |k| format!(" {k}.0D-04  {}d-3", 125 * k)).into_bytes(),
            ),
            (
                format!("[time]\ncolumn = \"when\"\noffset_s = -36000\n{TORQUE}"),
                rows("when,T", |k| format!("2024-03-05 10:00:00.{k:04},{}", value(k))).into_bytes(),
            ),
            (
                format!("[time]\ncolumn = \"when\"\noffset_s = -86399.998\n{TORQUE}"),
                rows("when,T", |k| match k {
                    0..20 => format!("05.03.2024 23:59:59.{:04},{}", 9980 + k, value(k)),
                    _ => format!("06.03.2024 00:00:00.{:04},{}", k - 20, value(k)),
                })
                .into_bytes(),
            ),
            (
                format!("[time]\ncolumn = \"when\"\n{TORQUE}"),
                rows("when,T", |k| format!("0:00:00.{k:04}Z,{}", value(k))).into_bytes(),
            ),
            // Thousands of millimetres.
            (
                "[file]\nseparator = \";\"\nthousands = \",\"\n[columns]\ninput_torque_n_m = { column = \"T\", unit = \"N mm\" }".to_owned(),
                rows("time_s;T", |k| {
                    let [whole, part] = [125 * k / 1000, 125 * k % 1000];
                    format!("{};{whole},{part:03}.0", time(k))
                }).into_bytes(),
            ),
            (
                format!("{german}thousands = \".\"\n[time]\nunit = \"us\"\n{TORQUE}"),
                rows("time_s;T", |k| match k {
                    0..10 => format!("{}00;{}", k, comma(value(k))),
                    _ => format!("{}.{}00;{}", k / 10, k % 10, comma(value(k))),
                }).into_bytes(),
            ),
            // An angle that falls, a sum, and a name of both: by number.
            (
                format!("[time]\ncolumn = \"phi\"\nfactor = -1e-3\n{TORQUE}"),
                rows("phi,T", |k| format!("{},{}", -0.1 * k as f64, value(k))).into_bytes(),
            ),
            (
                "[columns]\ninput_torque_n_m = { sum_of = { A = 1.0, B = -0.5 } }".to_owned(),
                rows("time_s,A,B", |k| format!("{},{},{k}", time(k), value(k) + 0.5 * k as f64)).into_bytes(),
            ),
            (
                "[columns]\ninput_torque_n_m = 3".to_owned(),
                rows("time_s,T,T,", |k| format!("{},7,{},", time(k), value(k))).into_bytes(),
            ),
        ];
        for (map, text) in texts {
            let series = found(&map, &text).unwrap_or_else(|error| panic!("{map}: {error}"));
            let series = series.time_series;
            let values = series.channel("input_torque_n_m").unwrap();
            assert_eq!(values.len(), ROWS, "{map}");
            for (k, (t, v)) in series.time_s().iter().zip(values).enumerate() {
                assert!((t - 1e-4 * k as f64).abs() < 1e-10, "{map}: {t}");
                assert!((v - value(k)).abs() < 1e-9, "{map}: {v}");
            }
        }
    }

    #[test]
    fn regress_angles_are_unwrapped() {
        let angle = |k: usize| 40.0 - 25.0 * k as f64;
        for (unit, turn) in [
            ("unit = \"deg\"", 360.0),
            ("factor = 0.0174532925199433", 360.0),
            ("unit = \"rev\"", 1.0),
        ] {
            let text = rows("time_s,A", |k| {
                format!("{},{}", time(k), (angle(k) / 360.0 * turn).rem_euclid(turn))
            });
            for unwrap in ["true".to_owned(), turn.to_string()] {
                let map = format!(
                    "[columns]\noutput_angle_rad = {{ column = \"A\", {unit}, unwrap = {unwrap} }}"
                );
                let series = found(&map, &text).unwrap().time_series;
                for (k, value) in series.channels()[0].values.iter().enumerate() {
                    assert!(
                        (value.to_degrees() - angle(k)).abs() < 1e-6,
                        "{map} {k}: {value}"
                    );
                }
            }
            let map = format!("[columns]\noutput_angle_rad = {{ column = \"A\", {unit} }}");
            let error = found(&map, &text).unwrap_err();
            assert!(
                error.contains("line 4: column `A` goes from 0.0") || error.contains("line 4"),
                "{error}"
            );
            assert!(
                error.ends_with("write unwrap = true for `output_angle_rad` in the map"),
                "{error}"
            );
        }
        // An angle of a ratio, between -180 and 180, each of a sum by itself.
        let half = |x: f64| (x + 180.0).rem_euclid(360.0) - 180.0;
        let text = rows("time_s,A,B", |k| {
            format!(
                "{},{},{}",
                time(k),
                half(-8.0 * k as f64),
                half(120.0 * k as f64)
            )
        });
        let map = "[columns]\ntransmission_error_arcmin = { sum_of = { A = 1.0, B = 0.0666666666666667 }, unit = \"deg\", unwrap = true }";
        let series = found(map, &text).unwrap().time_series;
        assert!(series.channels()[0].values.iter().all(|v| v.abs() < 1e-6));
        // A slow record of a fast shaft jumps too, always the same way.
        let fast = rows("time_s,A", |k| format!("{},{}", time(k), 400 * k));
        assert!(found(&ANGLE.replace(", unwrap = true", ""), fast).is_ok());
    }

    /// Before and after an event, at one instant or 1e-12 s apart.
    #[test]
    fn regress_an_instant_written_twice_has_the_value_after() {
        for apart in [0.0, 1e-12] {
            let text = rows("time_s,T", |k| {
                let t = 1e-4 * (k / 2) as f64 + apart * (k % 2) as f64;
                format!("{t:e},{}", k % 2)
            });
            for (rows, value) in [
                ("", 1.0),
                ("[rows]\ntwice = \"last\"\n", 1.0),
                ("[rows]\ntwice = \"first\"\n", 0.0),
            ] {
                let read = found(&format!("{TORQUE}{rows}"), &text).unwrap();
                assert_eq!(read.twice, Some((ROWS / 2, 0.0)));
                assert_eq!((read.time_series.len(), read.bad.len()), (ROWS / 2, 0));
                assert!(
                    read.time_series.channels()[0]
                        .values
                        .iter()
                        .all(|v| *v == value)
                );
            }
            let error = found(&format!("{TORQUE}[rows]\ntwice = \"refuse\""), &text).unwrap_err();
            assert!(
                error.contains("20 instants are written more than once, the first 0 s"),
                "{error}"
            );
        }
    }

    #[test]
    fn bad_input_is_refused_by_what_it_is() {
        let forces = |columns: &[usize]| {
            let names: Vec<String> = columns.iter().map(|k| format!("F_{k}")).collect();
            rows(&format!("time_s,{}", names.join(",")), |k| {
                format!("{}{}", time(k), ",3".repeat(columns.len()))
            })
        };
        let pattern = |first: usize| {
            format!(
                "[columns]\n\"external_sleeve_force_n_*\" = {{ column = \"F_*\", first = {first} }}"
            )
        };
        let german = format!("[file]\nseparator = \";\"\ndecimal = \",\"\n{TORQUE}");
        let semicolons = format!("[file]\nseparator = \";\"\n{TORQUE}");
        let blanks = format!("[file]\nseparator = \"space\"\n{TORQUE}");
        let force = "[columns]\nexternal_sleeve_force_n_0 = \"T\"".to_owned();
        let of = |header: &str, value: &str| rows(header, |k| format!("{}{value}", time(k)));
        for (map, text, part) in [
            (
                TORQUE.to_owned(),
                of("time_s,T,T", ",1,2"),
                "the columns 2 and 3 are both called `T`; write the number",
            ),
            (pattern(1), forces(&[1, 2, 4]), "no column `F_3`, but `F_4`"),
            (
                pattern(1),
                forces(&[0, 1, 2]),
                "no column `F_3`, but `F_0`; set `first`",
            ),
            (
                TORQUE.to_owned(),
                of("time_s,T", ",1,5"),
                "line 2: 3 cells, but the header has 2",
            ),
            (
                blanks,
                of("% time_s T", " 1"),
                "line 2: 2 cells, but the header has 3",
            ),
            (
                german.clone(),
                rows("time_s;T", |k| format!("0,{k:03};1.234")),
                "thousands = \".\" or decimal = \".\"",
            ),
            (
                semicolons,
                of("time_s;T", ";1,234"),
                "decimal = \",\" or thousands = \",\"",
            ),
            (
                german.replace("decimal = \",\"", "decimal = \",\"\nthousands = \".\""),
                rows("time_s;T", |k| format!("0,{k:03};1.2345,6")),
                "has marks of thousands elsewhere",
            ),
            (
                force.clone(),
                rows("time_s,T", |k| format!("{},{}", time(k), [-5, 9][k % 2])),
                "`external_sleeve_force_n_0` goes down to -5 N, but is the magnitude",
            ),
            (
                TORQUE.to_owned(),
                rows("time_s,T", |k| format!("{},1", time(ROWS - k))),
                "time falls in 39 of 40 rows; sort them",
            ),
            (
                TORQUE.to_owned(),
                rows("time_s,T", |k| format!("10:00:00.{k:03} PM,1")),
                "no clock time as it is read",
            ),
            (
                format!("[time]\nunit = \"ms\"\n{TORQUE}"),
                rows("time_s,T", |k| format!("10:00:00.{k:03},1")),
                "a clock time: leave time.unit out",
            ),
        ] {
            let error = found(&map, &text).unwrap_err();
            assert!(
                error.contains(part) && !error.contains('\n'),
                "{part}: {error}"
            );
        }
        // Noise of a cell about nothing is none.
        let noise = rows("time_s,T", |k| {
            format!("{},{}", time(k), [-0.1, 9.0][k % 2])
        });
        assert!(found(&force, noise).is_ok());
    }
}
