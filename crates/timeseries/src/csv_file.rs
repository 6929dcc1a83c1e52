//! Reading and writing of CSV: header row, `.` decimals, every digit of a value.

use std::io::{Read, Write};
use std::path::Path;

use crate::table::{Cell, write_rows};
use crate::{TimeSeries, TimeSeriesError, columns};

impl TimeSeries {
    /// Writes `time_s` and all channels; numbers read back bit for bit.
    ///
    /// # Errors
    /// Error of the writer.
    pub fn write_csv(&self, sink: impl Write) -> Result<(), TimeSeriesError> {
        let time = std::iter::once((columns::TIME, self.time_s()));
        let channels = self.channels().iter();
        let channels = channels.map(|channel| (channel.name.as_str(), channel.values.as_slice()));
        let (names, columns): (Vec<&str>, Vec<&[f64]>) = time.chain(channels).unzip();
        let cells = |row: usize| columns.iter().map(move |column| Cell::Number(column[row]));
        write_rows(sink, names.into_iter(), (0..self.len()).map(cells))
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

fn io(path: &Path) -> impl Fn(std::io::Error) -> TimeSeriesError {
    |source| TimeSeriesError::Io {
        path: path.to_owned(),
        source,
    }
}
