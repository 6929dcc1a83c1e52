//! Time series of other sources: CSV files of Adams, RecurDyn or a test rig, read by a map of their columns.
//!
//! [`Map`] describes the columns: meaning, unit and time offset. [`read`] returns the mapped columns on their own sample times,
//! and lists the rows that it could not read. [`shift`] returns the time shift of the best fit to a run; [`resample`]
//! interpolates to the sample times of a run and estimates the error.
//!
//! ```
//! use pinwheel_timeseries::foreign::{Map, read};
//!
//! let map = r#"
//! [file]
//! separator = ";"
//! [time]
//! column = "TIME"
//! unit = "ms"
//! [columns]
//! input_torque_n_m = { column = "Motor torque", unit = "N mm", factor = -1.0 }
//! "#;
//! let map = Map::from_toml(map, "rig.toml")?;
//! let rows: String = (0..10).map(|k| format!("{k};-145{k}\n")).collect();
//! let rig = read(format!("TIME;Motor torque\n{rows}").as_bytes(), &map)?;
//! let torque = rig.time_series.channel("input_torque_n_m").ok_or("no such channel")?;
//! assert!((torque[1] - 1.451).abs() < 1e-12 && rig.time_series.time_s()[1] == 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod align;
mod cells;
mod error;
mod lines;
mod map;
mod read;
mod resample;

pub use align::{Shift, shift};
pub use error::{ForeignError, first_of};
pub use map::{
    BadRows, ColumnRef, ColumnUncertainty, FileFormat, Map, Method, Offset, Resampling, Source,
    StatedLimit, TimeColumn, Twice, Unwrap, Word, is_reserved,
};
pub use read::{Foreign, read};
pub use resample::{Resampled, resample};
