//! Time series from elsewhere: a CSV of Adams, RecurDyn or a test rig, by a map of its columns.
//!
//! [`Map`] is the file that says which column is what, in which unit and from when; [`read`] gives
//! the mapped columns on their own sample times with every row that could not be read named;
//! [`shift`] finds the shift in time at which they fit a run best; [`resample`] puts them onto the times of a run and says
//! what that costs.
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
