//! Reading and writing of CSV: header row, `.` decimals, every digit of a value.

use std::io::{Read, Write};
use std::path::Path;

use crate::table::Cell;
use crate::{TimeSeries, TimeSeriesError, columns};

impl TimeSeries {
    /// Writes `time_s` and all channels; numbers read back bit for bit.
    ///
    /// # Errors
    /// Error of the writer.
    pub fn write_csv(&self, sink: impl Write) -> Result<(), TimeSeriesError> {
        let channels = self.channels().iter();
        let channels = channels.map(|channel| (channel.name.as_str(), &channel.values[..]));
        let time = [(columns::TIME, self.time_s())];
        let (names, values): (Vec<_>, Vec<_>) = time.into_iter().chain(channels).unzip();
        write(sink, &names, self.len(), |k, row| {
            Cell::Number(values[k][row])
        })
    }

    /// Writes a CSV file; see [`TimeSeries::write_csv`].
    ///
    /// # Errors
    /// The file cannot be created or written.
    pub fn save_csv(&self, path: &Path) -> Result<(), TimeSeriesError> {
        self.write_csv(std::fs::File::create(path).map_err(io(path))?)
    }

    /// Reads a file of [`TimeSeries::write_csv`], or any CSV with a `time_s` column; columns without a name are left out.
    ///
    /// # Errors
    /// Malformed CSV, no time column, a cell without a number (the message names row and column), time that does not increase.
    pub fn read_csv(source: impl Read) -> Result<Self, TimeSeriesError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(source);
        let names: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
        if !names.iter().any(|name| name == columns::TIME) {
            return Err(TimeSeriesError::NoTime);
        }
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record)? {
            for (column, text) in record.iter().enumerate() {
                if names[column].is_empty() {
                    continue;
                }
                let value = text.parse().map_err(|_| TimeSeriesError::Cell {
                    row: columns[column].len() + 1,
                    column: names[column].clone(),
                    text: text.to_owned(),
                })?;
                columns[column].push(value);
            }
        }
        let named = names.into_iter().zip(columns);
        Self::of_columns(named.filter(|(name, _)| !name.is_empty()))
    }

    /// Reads a CSV file; see [`TimeSeries::read_csv`].
    ///
    /// # Errors
    /// The file cannot be opened, or its content is faulty.
    pub fn load_csv(path: &Path) -> Result<Self, TimeSeriesError> {
        let file = std::fs::File::open(path).map_err(io(path))?;
        Self::read_csv(std::io::BufReader::new(file))
    }
}

/// Number of bytes of CSV that are passed on at a time.
const BLOCK: usize = 1 << 16;

/// Writes CSV with a header of `names` and as many `rows`; `cell` gives the value in a column and row.
pub(crate) fn write<'a>(
    mut sink: impl Write,
    names: &[&'a str],
    rows: usize,
    cell: impl Fn(usize, usize) -> Cell<'a>,
) -> Result<(), TimeSeriesError> {
    let (mut text, mut digits) = (Vec::with_capacity(2 * BLOCK), zmij::Buffer::new());
    for row in 0..=rows {
        let begin = text.len();
        for (k, name) in names.iter().enumerate() {
            if k > 0 {
                text.push(b',');
            }
            let cell = match row.checked_sub(1) {
                Some(row) => cell(k, row),
                None => Cell::Text(name),
            };
            match cell {
                // A fifth of the numbers: pins without contact.
                Cell::Number(value) if value.to_bits() == 0 => text.push(b'0'),
                Cell::Number(value) => {
                    let number = digits.format(value);
                    let number = number.strip_suffix(".0").unwrap_or(number);
                    text.extend_from_slice(number.as_bytes());
                }
                Cell::Integer(value) => text.extend_from_slice(value.to_string().as_bytes()),
                Cell::Text(words) if words.contains([',', '"', '\n', '\r']) => {
                    let words = words.replace('"', "\"\"");
                    text.extend_from_slice(format!("\"{words}\"").as_bytes());
                }
                Cell::Text(words) => text.extend_from_slice(words.as_bytes()),
                Cell::Empty => {}
            }
        }
        // A row of one empty cell is no empty line.
        if text.len() == begin {
            text.extend_from_slice(b"\"\"");
        }
        text.push(b'\n');
        if text.len() > BLOCK || row == rows {
            sink.write_all(&text).map_err(csv::Error::from)?;
            text.clear();
        }
    }
    Ok(sink.flush().map_err(csv::Error::from)?)
}

fn io(path: &Path) -> impl Fn(std::io::Error) -> TimeSeriesError {
    |source| TimeSeriesError::Io {
        path: path.to_owned(),
        source,
    }
}
