//! Courses from elsewhere: a CSV of Adams, RecurDyn or a test rig, by a map of its columns.
//!
//! [`Map`] is the file that says which column is what, in which unit and from when; [`read`] gives
//! the mapped columns on their own sample times with every row that could not be read named;
//! [`shift`] finds the shift in time at which they fit a run best; [`resample`] puts them onto the times of a run and says
//! what that costs.

mod align;
mod error;
mod map;
mod read;
mod resample;
mod units;

pub use align::{Shift, shift};
pub use error::{BadRow, ForeignError};
pub use map::{
    BadRows, ColumnRef, ColumnUncertainty, FileFormat, Map, Method, Offset, Resampling, Source,
    StatedLimit, TimeColumn, is_reserved,
};
pub use read::{Foreign, read};
pub use resample::{Resampled, resample};
