//! Courses: named channels over time, the one result type of every engine.
//!
//! A channel's name carries its unit as a suffix (`input_torque_n_m`); numbered
//! channels of one kind end in `_<index>` (`external_sleeve_force_n_3`) and form a
//! *group*. All values are SI and finite unless a run diverged.

mod csv_file;
mod error;
pub mod foreign;
mod run;
mod store;

pub use error::CoursesError;
pub use run::{Ending, EnergyAudit, RunStats, Track};
pub use store::{Channel, Courses, group_of};
