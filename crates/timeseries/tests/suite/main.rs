//! Tests of time series, tables and foreign files.

mod align;
mod csv_file;
mod figures;
mod map;
mod norms;
#[cfg(feature = "parquet")]
mod parquet_file;
mod read;
mod resample;
mod sampling;
mod store;
mod table;
mod units;
