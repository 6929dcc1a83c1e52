//! Time series: named channels over time, the result type of every engine.
//!
//! ```text
//!  time_s | input_torque_n_m | output_torque_n_m | output_angle_rad | external_sleeve_force_n_0 .. | channels asked for
//!  -------+------------------+-------------------+------------------+------------------------------+-------------------
//!  0      | ...              |                   |                  | a group: one column a pin |
//! ```
//!
//! ```
//! use pinwheel_timeseries::{TimeSeries, columns};
//!
//! let mut time_series = TimeSeries::new(vec![0.0, 1e-4, 2e-4])?;
//! time_series.push(columns::INPUT_TORQUE, vec![1.44, 1.45, 1.46])?;
//! assert_eq!(time_series.channel("input_torque_n_m").map(|torque| torque[2]), Some(1.46));
//! # Ok::<(), pinwheel_timeseries::TimeSeriesError>(())
//! ```
//!
//! Other results: a [`Table`](table::Table); ending, cost and energy of a run ([`Ending`], [`RunStats`], [`EnergyAudit`]);
//! [`foreign`] data by a map of their columns.
//!
//! A channel's name carries its unit as a suffix (`input_torque_n_m`, see [`columns`]); numbered
//! channels of one kind end in `_<index>` (`external_sleeve_force_n_3`) and form a
//! *group*. All values are SI and finite unless a run diverged.

pub mod columns;
pub mod convergence;
mod csv_file;
mod digits;
mod error;
pub mod figure;
pub mod foreign;
pub mod fourier;
pub mod ladder;
pub mod norms;
#[cfg(feature = "parquet")]
mod parquet_file;
mod run;
pub mod sampling;
mod store;
pub mod table;
mod units;

pub use error::TimeSeriesError;
#[cfg(feature = "parquet")]
pub use parquet_file::{ParquetFault, read_time_series, save_time_series};
pub use run::{
    ABOVE_ONE, CREATED, Ending, EnergyAudit, NO_LOSS, RecordedUncertainty, RunStats, SharedModel,
    efficiency, mean_powers,
};
pub use store::{Channel, TimeSeries, group_of};
pub use units::stem_and_unit;

/// Private items that the tests of this crate reach; no part of the interface.
#[doc(hidden)]
pub mod internals {
    pub use crate::sampling::{EVEN, cubic, divided};
    pub use crate::units::{factor, turn};
}
