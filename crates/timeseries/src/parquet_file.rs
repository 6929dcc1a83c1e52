//! Parquet in and out: typed columns, every digit, a tenth of the time of CSV to read back.
//!
//! One row group, no compression (codecs are the heavy part of the library), dictionary pages where
//! values repeat. Numbers are doubles, whole numbers 64 bits, texts UTF-8; cells may be empty.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::Field;
use parquet::schema::types::{Type, TypePtr};

use crate::table::{Table, Values};
use crate::{TimeSeries, TimeSeriesError};

/// Faults of Parquet files.
#[derive(Debug, thiserror::Error)]
pub enum ParquetFault {
    /// It cannot be written, or is none.
    #[error("Parquet: {0}")]
    Parquet(#[from] parquet::errors::ParquetError),
    /// It holds more than its reader asked for.
    #[error("Parquet: {rows} rows, but there may be {most}")]
    Long {
        /// Rows that it says it has.
        rows: i64,
        /// Rows at most.
        most: usize,
    },
    /// It was one, and the library does not get through what it became.
    #[error("Parquet: the file is damaged; write it anew")]
    Damaged,
    /// It is one, but not of time series.
    #[error(transparent)]
    TimeSeries(#[from] TimeSeriesError),
    /// It cannot be opened or made.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

impl Values {
    fn schema(&self, name: &str) -> Result<TypePtr, ParquetFault> {
        let (physical, logical) = match self {
            Self::Number(_) => (Physical::DOUBLE, None),
            Self::Whole(_) => (Physical::INT64, None),
            Self::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let column = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical);
        Ok(Arc::new(column.build()?))
    }
}

impl Table {
    /// Writes a Parquet file of the columns that have a name.
    ///
    /// # Errors
    /// The library's: columns of different lengths, or the writer's own.
    pub fn write_parquet(&self, sink: impl Write + Send) -> Result<(), ParquetFault> {
        let fields = self.named();
        let fields = fields.map(|column| column.values.schema(&column.name));
        let schema = Type::group_type_builder("table")
            .with_fields(fields.collect::<Result<_, _>>()?)
            .build()?;
        // The same columns give the same bytes: no version of a library in the file.
        let properties = WriterProperties::builder().set_created_by("pinwheel".to_owned());
        let mut writer =
            SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties.build()))?;
        let mut group = writer.next_row_group()?;
        for column in self.named() {
            match &column.values {
                Values::Number(list) => write_column::<DoubleType, _>(&mut group, list, |v| *v)?,
                Values::Whole(list) => write_column::<Int64Type, _>(&mut group, list, |v| *v)?,
                Values::Text(list) => write_column::<ByteArrayType, _>(&mut group, list, |v| {
                    ByteArray::from(v.as_str())
                })?,
            }
        }
        group.close()?;
        writer.close()?;
        Ok(())
    }
}

fn write_column<T: DataType, V>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    values: &[Option<V>],
    convert: impl Fn(&V) -> T::T,
) -> Result<(), ParquetFault> {
    let Some(mut column) = group.next_column()? else {
        return Ok(());
    };
    let present: Vec<T::T> = values.iter().flatten().map(convert).collect();
    let levels: Vec<i16> = values.iter().map(|v| i16::from(v.is_some())).collect();
    column
        .typed::<T>()
        .write_batch(&present, Some(&levels), None)?;
    column.close()?;
    Ok(())
}

/// Writes time series as a Parquet file: `time_s` and all channels.
///
/// # Errors
/// The file cannot be made or written.
pub fn save_time_series(time_series: &TimeSeries, path: &Path) -> Result<(), ParquetFault> {
    Table::from(time_series).write_parquet(std::fs::File::create(path)?)
}

/// Reads what [`save_time_series`] wrote, or any Parquet file of doubles with a `time_s` column, of at most `most` rows; empty
/// cells are read as NaN, and columns that are no doubles are passed over.
///
/// # Errors
/// It is no Parquet file, is longer, has no time or time that does not increase.
pub fn read_time_series(
    source: impl ChunkReader + 'static,
    most: usize,
) -> Result<TimeSeries, ParquetFault> {
    // The library panics on some damaged files; its state goes with the reader.
    let read = || doubles(source, most);
    let columns = catch_unwind(AssertUnwindSafe(read)).unwrap_or(Err(ParquetFault::Damaged))?;
    Ok(TimeSeries::of_columns(columns)?)
}

/// The columns of doubles.
fn doubles(
    source: impl ChunkReader + 'static,
    most: usize,
) -> Result<Vec<(String, Vec<f64>)>, ParquetFault> {
    let is_double = |field: &Type| {
        field.is_primitive()
            && field.get_physical_type() == Physical::DOUBLE
            && field.get_basic_info().repetition() != Repetition::REPEATED
    };
    let reader = SerializedFileReader::new(source)?;
    let schema = reader.metadata().file_metadata().schema().clone();
    let fields = schema.get_fields().iter().filter(|field| is_double(field));
    let schema = Type::group_type_builder(schema.name())
        .with_fields(fields.cloned().collect())
        .build()?;
    // Repeated values take no room in the file: what it holds says nothing of how long it is.
    let rows = reader.metadata().file_metadata().num_rows();
    if rows > i64::try_from(most).unwrap_or(i64::MAX) {
        return Err(ParquetFault::Long { rows, most });
    }
    let columns = schema.get_fields().iter();
    let mut columns: Vec<(String, Vec<f64>)> = columns
        .map(|field| (field.name().to_owned(), Vec::new()))
        .collect();
    if columns.is_empty() {
        return Ok(columns);
    }
    for row in reader.get_row_iter(Some(schema))?.take(most) {
        for ((_, field), (_, values)) in row?.get_column_iter().zip(&mut columns) {
            values.push(match field {
                Field::Double(value) => *value,
                _ => f64::NAN,
            });
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_is_exact() {
        let mut time_series = TimeSeries::new(vec![0.0, 1e-4, 0.1 + 0.2]).unwrap();
        time_series
            .push("a_n", vec![1.0 / 3.0, -1e-300, f64::MAX])
            .unwrap();
        time_series.push("gear.b_m", vec![1.0, 1.0, -0.0]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("courses.parquet");
        save_time_series(&time_series, &path).unwrap();
        let load = |most| read_time_series(std::fs::File::open(&path).unwrap(), most);
        assert_eq!(load(usize::MAX).unwrap(), time_series);
        let short = load(2);
        assert!(matches!(
            short,
            Err(ParquetFault::Long { rows: 3, most: 2 })
        ));
        std::fs::write(&path, "time_s\n0\n").unwrap();
        assert!(matches!(load(usize::MAX), Err(ParquetFault::Parquet(_))));
    }

    #[test]
    fn cells_may_be_empty() {
        let table = Table::of(
            "",
            [(Some(0.1), None, "\u{e9}, \"x\""), (None, Some(-3), "")],
        )
        .number("n", "", |row| row.0)
        .whole("k", "", |row| row.1)
        .text("t", "", |row| row.2)
        .done();
        let mut bytes = Vec::new();
        table.write_parquet(&mut bytes).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let rows: Vec<String> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().to_string())
            .collect();
        assert_eq!(
            rows,
            [
                "{n: 0.1, k: null, t: \"\u{e9}, \"x\"\"}",
                "{n: null, k: -3, t: null}"
            ]
        );
        let mut uneven = table;
        uneven.columns[1].values = Values::Whole(vec![None]);
        assert!(uneven.write_parquet(Vec::new()).is_err());
    }
}
