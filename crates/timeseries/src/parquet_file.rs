//! Reading and writing of Parquet: typed columns, every digit, a tenth of CSV's time to read back.
//!
//! One row group, no compression (codecs dominate the library's size), dictionary pages for repeated values. Numbers are
//! doubles, integers 64 bits, texts UTF-8; cells may be empty.

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
    /// Parquet file that cannot be written, or a file that is not Parquet.
    #[error("Parquet: {0}")]
    Parquet(#[from] parquet::errors::ParquetError),
    /// Parquet file with more rows than its reader allows.
    #[error("Parquet: {rows} rows, but there may be {most}")]
    Long {
        /// Stated number of rows.
        rows: i64,
        /// Largest permitted number of rows.
        most: usize,
    },
    /// Damaged Parquet file, on which the library fails.
    #[error("Parquet: the file is damaged; write it again")]
    Damaged,
    /// Parquet file without time series.
    #[error(transparent)]
    TimeSeries(#[from] TimeSeriesError),
    /// File that cannot be opened or created.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

impl Values {
    fn schema(&self, name: &str) -> Result<TypePtr, ParquetFault> {
        let (physical, logical) = match self {
            Self::Number(_) => (Physical::DOUBLE, None),
            Self::Integers(_) => (Physical::INT64, None),
            Self::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let column = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical);
        Ok(Arc::new(column.build()?))
    }
}

impl Table {
    /// Writes the columns that have a name as a Parquet file.
    ///
    /// # Errors
    /// Error of the library (columns of different lengths) or of the writer.
    pub fn write_parquet(&self, sink: impl Write + Send) -> Result<(), ParquetFault> {
        let fields = self.named();
        let fields = fields.map(|column| column.values.schema(&column.name));
        let schema = Type::group_type_builder("table")
            .with_fields(fields.collect::<Result<_, _>>()?)
            .build()?;
        // No library version, so that equal columns give equal bytes.
        let properties = WriterProperties::builder().set_created_by("pinwheel".to_owned());
        let mut writer =
            SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties.build()))?;
        let mut group = writer.next_row_group()?;
        for column in self.named() {
            match &column.values {
                Values::Number(list) => write_column::<DoubleType, _>(&mut group, list, |v| *v)?,
                Values::Integers(list) => write_column::<Int64Type, _>(&mut group, list, |v| *v)?,
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
/// The file cannot be created or written.
pub fn save_time_series(time_series: &TimeSeries, path: &Path) -> Result<(), ParquetFault> {
    Table::from(time_series).write_parquet(std::fs::File::create(path)?)
}

/// Reads a file of [`save_time_series`], or any Parquet file of doubles with a `time_s` column, of at most `most` rows. Empty
/// cells are NaN; columns of other types are ignored.
///
/// # Errors
/// Not a Parquet file, too many rows, no time or time that does not increase.
pub fn read_time_series(
    source: impl ChunkReader + 'static,
    most: usize,
) -> Result<TimeSeries, ParquetFault> {
    // The library panics on some damaged files; its state is dropped with the reader.
    let read = || doubles(source, most);
    let columns = catch_unwind(AssertUnwindSafe(read)).unwrap_or(Err(ParquetFault::Damaged))?;
    Ok(TimeSeries::of_columns(columns)?)
}

/// Reads the columns of doubles.
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
    // Repeated values need no space in the file, so its size does not bound its rows.
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
